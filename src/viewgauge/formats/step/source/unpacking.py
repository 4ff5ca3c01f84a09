"""The bytes of a STEP file, unpacked where it is compressed."""

from __future__ import annotations

import gzip
import io
import zipfile
import zlib
from pathlib import Path

from ....exceptions import PartFileError

__all__ = ["PACKED", "read_unpacked"]

_GZIP, _ZIP = b"\x1f\x8b", b"PK\x03\x04"
PACKED = (_GZIP, _ZIP)
"""How the content of a compressed file begins, whatever its name."""

_LIMIT_BYTES = 2**30  # of text: a few kilobytes may claim to be terabytes
_STEP_SUFFIXES = (".stp", ".step", ".p21", ".txt")


def read_unpacked(path: Path) -> tuple[bytes, bool]:
    """The content of a file, and whether it had to be unpacked (gzip, or a ZIP archive with one STEP file in it).

    Raises
    ------
    PartFileError
        If a compressed file is damaged, holds no STEP file or several, or unpacks to more than 1 GiB.
    """
    with path.open("rb") as stream:
        content = stream.read()
    if not content.startswith(PACKED):
        return content, False
    try:
        unpacked = _gzip(content) if content.startswith(_GZIP) else _zip(content)
    except (OSError, EOFError, zlib.error, zipfile.BadZipFile, RuntimeError, NotImplementedError) as error:
        raise PartFileError(
            "the compressed file cannot be unpacked", got=str(error), hint="compress it again, or give the plain file"
        ) from error
    if len(unpacked) > _LIMIT_BYTES:
        raise PartFileError(
            "the compressed file holds more than 1 GiB of text", hint="unpack it, and simplify the part"
        )
    return unpacked, True


def _gzip(content: bytes) -> bytes:
    with gzip.GzipFile(fileobj=io.BytesIO(content)) as stream:
        return stream.read(_LIMIT_BYTES + 1)


def _zip(content: bytes) -> bytes:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        names = [name for name in archive.namelist() if name.lower().endswith(_STEP_SUFFIXES)]
        if len(names) != 1:
            raise PartFileError(
                "the archive does not hold one STEP file",
                got=", ".join(names[:10]) or "none",
                expected="one file .stp, .step or .p21 in it",
                hint="unpack it, and give the file that is meant",
            )
        with archive.open(names[0]) as stream:
            return stream.read(_LIMIT_BYTES + 1)
