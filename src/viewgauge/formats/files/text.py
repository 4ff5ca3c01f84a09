"""Reading a small text file whole, with an error message for everything that can be wrong with it."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from ...exceptions import InputError

__all__ = ["read_text", "unusable_character"]


def unusable_character(text: str) -> str | None:
    """What makes a text unusable: a character that no file can hold; None where there is none."""
    if "\0" in text:
        return "the character 0"
    if any("\ud800" <= character <= "\udfff" for character in text):
        return "half of a surrogate pair"
    return None


_MOST_BYTES = 4 << 30


def read_text(path: str | os.PathLike[str], error_type: type[InputError], most_bytes: int = _MOST_BYTES) -> str:
    """Text of a UTF-8 file (a byte order mark is dropped).

    Raises
    ------
    InputError
        An error of ``error_type``: the file is missing, a folder, a pipe or device, too large, not readable, or not
        UTF-8 text.
    """
    try:
        about = os.stat(path)
        if not stat.S_ISREG(about.st_mode) and not stat.S_ISDIR(about.st_mode):
            raise error_type(
                "this is a pipe or a device, not a file", file=path, hint="write its content to a file first"
            )
        if about.st_size > most_bytes:
            got = f"{about.st_size / 2**20:.0f} MB"
            raise error_type("the file is too large", file=path, got=got, expected=f"at most {most_bytes >> 20} MB")
        content = Path(path).read_bytes()
    except FileNotFoundError as error:
        raise error_type("the file does not exist", file=path, hint="check the path") from error
    except IsADirectoryError as error:
        raise error_type("this is a folder, not a file", file=path, hint="give the path of the file") from error
    except InputError:
        raise
    except OSError as error:
        raise error_type(f"the file cannot be read: {error.strerror or error}", file=path) from error
    except ValueError as error:  # a NUL character in the path
        raise error_type(f"not a path: {error}", file=path) from error
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise error_type(
            "the file is not UTF-8 text",
            file=path,
            line=line,
            got=f"byte 0x{content[error.start]:02x}",
            hint="save it as UTF-8; binary files cannot be read here",
        ) from error
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise error_type("the file is binary, not text", file=path, line=line, expected="UTF-8 text")
    return text
