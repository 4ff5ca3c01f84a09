"""One process at a time in a folder: a lock that ends with the process that holds it, however that ends."""

from __future__ import annotations

import errno
import os
import socket
from pathlib import Path
from typing import TYPE_CHECKING

from ...exceptions import InputError

if TYPE_CHECKING:
    from filelock import BaseFileLock

__all__ = ["LOCK_FILES", "lock_folder"]

_LOCK, _HOLDER = "lock", "holder"
LOCK_FILES = frozenset({_LOCK, _HOLDER})
"""Names of the files in a locked folder that belong to the lock."""

_PATIENCE_S = 0.1  # for a folder that whoever has just finished is taking away
_NO_LOCKS = {errno.ENOLCK, errno.ENOTSUP, errno.EOPNOTSUPP}  # what a file system without locks answers


def lock_folder(folder: Path, target: str | os.PathLike[str]) -> BaseFileLock:
    """Lock a folder, which is made where it is absent, until ``release()`` is called or the process ends.

    The files of the lock are left behind and mean nothing by themselves. On a file system that has no locks nothing is
    locked.

    Parameters
    ----------
    target
        What the folder is for, named in the message.

    Raises
    ------
    InputError
        If another process, or this one by another lock, holds the lock; it names that process and its host.
    OSError
        If the folder cannot be made or written to.
    """
    from filelock import FileLock, Timeout

    lock = FileLock(folder / _LOCK)
    while not lock.is_locked:
        folder.mkdir(exist_ok=True)
        try:
            lock.acquire(timeout=_PATIENCE_S, poll_interval=_PATIENCE_S / 5)
            (folder / _HOLDER).write_text(f"process {os.getpid()} on {socket.gethostname()}\n", encoding="utf-8")
        except Timeout:
            raise InputError(
                "another process is writing this",
                file=target,
                got=_holder(folder),
                hint="wait until it has ended, or end it and start again: what it did is kept",
            ) from None
        except OSError as error:
            lock.release()
            if error.errno in _NO_LOCKS:
                break
            if not isinstance(error, FileNotFoundError):  # the process that has just finished took the folder away
                raise
    return lock


def _holder(folder: Path) -> str:
    try:
        return (folder / _HOLDER).read_text(encoding="utf-8", errors="replace").strip() or "unknown"
    except OSError:
        return "unknown"
