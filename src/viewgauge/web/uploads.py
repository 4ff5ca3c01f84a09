"""Files from a browser: few, small, of known kinds, under plain names, in a folder of their own."""

from __future__ import annotations

import re
from pathlib import Path, PurePosixPath, PureWindowsPath

import viser
from viser._messages import FileTransferPart, FileTransferStartUpload

from ..exceptions import InputError

__all__ = ["INSPECTION_SUFFIXES", "MOST_BYTES", "OTHER_SUFFIXES", "limit_uploads", "stored"]

MOST_BYTES = 64 * 2**20
"""The largest size of a file."""

INSPECTION_SUFFIXES = (".yaml", ".yml")
OTHER_SUFFIXES = (".stp", ".step", ".p21", ".stpz", ".stl", ".ply", ".obj", ".csv", ".yaml", ".yml")
"""Parts, viewpoints, covariances, calibrations."""

_MOST_FILES = 20
_MOST_TEXT_BYTES = 2**20
_AT_ONCE = 2


def limit_uploads(client: viser.ClientHandle) -> None:
    """Drop what is too large as soon as that is known; viser itself takes all that is sent into memory."""
    gui, connection = client.gui, client._websock_connection
    coming = gui._current_file_upload_states

    def started(_: int, message: FileTransferStartUpload) -> None:
        if message.size_bytes > MOST_BYTES or len(coming) > _AT_ONCE:
            coming.pop(message.transfer_uuid, None)
            what = f"{_plain_name(message.filename)} is larger than {MOST_BYTES // 2**20} MB"
            if message.size_bytes <= MOST_BYTES:
                what = "only one file can be sent at a time"
            client.add_notification("Not taken", what, color="red")

    def came(_: int, message: FileTransferPart) -> None:
        state = coming.get(message.transfer_uuid)
        if state is not None and state["transferred_bytes"] > MOST_BYTES:
            coming.pop(message.transfer_uuid, None)  # it said that it would be smaller

    connection.register_handler(FileTransferStartUpload, started)
    connection.register_handler(FileTransferPart, came)


def stored(folder: Path, name: str, content: bytes, suffixes: tuple[str, ...]) -> Path:
    """Write a file that was sent into a folder, under its plain name.

    Raises
    ------
    InputError
        If its kind is not one of the suffixes, or it or the folder is too full.
    """
    plain = _plain_name(name)
    suffix = Path(plain).suffix.lower()
    if suffix not in suffixes:
        raise InputError(
            "this kind of file is not taken", key=plain, got=suffix or "no suffix", expected=" ".join(suffixes)
        )
    most = _MOST_TEXT_BYTES if suffix in INSPECTION_SUFFIXES else MOST_BYTES
    if len(content) > most:
        raise InputError(
            "the file is too large", key=plain, got=f"{len(content):,} bytes", expected=f"at most {most:,}"
        )
    path = folder / plain
    if not path.exists() and sum(1 for _ in folder.iterdir()) >= _MOST_FILES:
        raise InputError("too many files were sent", expected=f"at most {_MOST_FILES}", hint="load the page again")
    path.unlink(missing_ok=True)
    path.write_bytes(content)
    return path


def _plain_name(name: str) -> str:
    """The last part of a path of any system, of harmless letters; never hidden, never empty."""
    last = PurePosixPath(PureWindowsPath(name).as_posix()).name
    return re.sub(r"[^\w.\- ]", "_", last).lstrip(". ")[-100:] or "file"
