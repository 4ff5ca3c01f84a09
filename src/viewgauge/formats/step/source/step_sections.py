"""The sections of a STEP file: those of edition 3 of ISO 10303-21 are taken out for the CAD kernel.

Edition 3 adds an ANCHOR section (names for records), a REFERENCE section (records of other files), SIGNATURE sections
behind the end of the file, and several DATA sections.
"""

from __future__ import annotations

import re

__all__ = ["one_data_section", "referenced_files"]

_QUICK = re.compile(r"\b(?:ANCHOR|REFERENCE|SIGNATURE)\s*;|\bDATA\s*\(|\bDATA\s*;(?s:.*?)\bDATA\s*;")
_MARK = re.compile(
    r"'[^']*+(?:'|\Z)|/\*(?s:.*?)(?:\*/|\Z)"
    r"|(?<![\w=-])(?P<name>HEADER|ANCHOR|REFERENCE|DATA|SIGNATURE|ENDSEC|END-ISO-10303-21)\b"
    r"\s*(?:\((?:[^';]|'[^']*+')*\)\s*)?;"
)
_URI = re.compile(r"[#@]\w+\s*=\s*<([^<>]*)>")


def one_data_section(text: str) -> str:
    """The text with the header and all records in one DATA section; the text itself where it has no other."""
    if _QUICK.search(text) is None:
        return text
    sections = _sections(text)
    data = [content for name, content in sections if name == "DATA"]
    if len(data) == 1 and all(name in ("HEADER", "DATA") for name, _ in sections) and "DATA;" in text:
        return text  # the words stand in a string
    header = "".join(content for name, content in sections if name == "HEADER")
    return f"ISO-10303-21;\nHEADER;{header}ENDSEC;\nDATA;{''.join(data)}ENDSEC;\nEND-ISO-10303-21;\n"


def referenced_files(text: str) -> list[str]:
    """Names of the files that the REFERENCE section takes records from."""
    if "REFERENCE" not in text:
        return []
    uris = [uri for name, content in _sections(text) if name == "REFERENCE" for uri in _URI.findall(content)]
    return list(dict.fromkeys(name for uri in uris if (name := uri.partition("#")[0].strip())))


def _sections(text: str) -> list[tuple[str, str]]:
    """Name and content of each section, in order."""
    found: list[tuple[str, str]] = []
    name, start = "", 0
    for mark in _MARK.finditer(text):
        word = mark["name"]
        if word is None:
            continue
        if word in ("ENDSEC", "END-ISO-10303-21"):
            if name:
                found.append((name, text[start : mark.start()]))
            name = ""
        elif not name:
            name, start = word, mark.end()
    return found
