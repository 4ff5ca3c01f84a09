"""The text of a STEP file, and a file with the same content that the CAD kernel can read."""

from __future__ import annotations

import codecs
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ....exceptions import PartFileError
from .record_numbers import renumbered
from .step_sections import one_data_section
from .unpacking import read_unpacked

__all__ = ["StepSource", "read_source"]

_START, _END = "ISO-10303-21", "END-ISO-10303-21"


@dataclass(frozen=True)
class StepSource:
    """A STEP file's text, and where the kernel reads it.

    Parameters
    ----------
    text
        All of it, decoded, record numbers as in the file.
    kernel_path
        The file itself where the kernel can read it as it is, else a copy in the form that the kernel reads.
    kernel_numbers
        Number of each record in the kernel's copy; empty where they are the file's own.
    notes
        What was done to the text, one sentence each, where the user should know.
    """

    text: str
    kernel_path: Path
    kernel_numbers: Mapping[int, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def read_source(path: Path, folder: Path) -> StepSource:
    """Read a STEP file's text, and make the kernel's copy in a folder where it needs one.

    It needs one where the file is compressed, begins with a byte order mark, is UTF-16, has record numbers above
    2^31 - 1, several data sections, or the sections of edition 3 of ISO 10303-21 (anchors, references, signatures).

    Raises
    ------
    PartFileError
        If the file cannot be unpacked, is no complete STEP file, or has a record number that is no number.
    """
    content, unpacked = read_unpacked(path)
    text, encoding, marked = _decoded(content)
    if not text.lstrip().startswith(_START):
        raise PartFileError("this is not a STEP file", got=repr(text[:40]), expected=f"text that starts with {_START}")
    if _END not in text:
        raise PartFileError(
            "the file is truncated",
            got=repr(text[-40:]),
            expected=f"a file that ends with {_END};",
            hint="copy it again",
        )
    plain = one_data_section(text)
    plain, numbers = renumbered(plain)
    if not unpacked and not marked and plain is text:
        return StepSource(text, path)
    copy = folder / "kernel.step"
    copy.write_bytes(plain.encode(encoding, "replace"))
    return StepSource(text, copy, numbers)


def _decoded(content: bytes) -> tuple[str, str, bool]:
    """The text, the encoding for the kernel's copy, and whether the kernel needs one because of the encoding."""
    for mark, encoding in ((codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be")):
        if content.startswith(mark):
            return content[len(mark) :].decode(encoding, "replace"), "utf-8", True
    marked = content.startswith(codecs.BOM_UTF8)
    content = content.removeprefix(codecs.BOM_UTF8)
    try:
        return content.decode("utf-8"), "utf-8", marked
    except UnicodeDecodeError:  # before UTF-8, writers used the code page of their machine: mostly Western European
        return content.decode("latin-1"), "latin-1", marked
