"""One process at a time on a folder: a lock that the system takes from a process that dies."""

from __future__ import annotations

import os
import socket
from pathlib import Path

from ...exceptions import InputError

try:
    import fcntl
except ImportError:  # not a POSIX system: there, nothing keeps two jobs apart
    fcntl = None  # type: ignore[assignment]

__all__ = ["FolderLock"]


class FolderLock:
    """Holds the file ``lock`` in a folder, which is made where it is absent.

    The lock is the system's (``flock``) and ends with the process, however that ends; the file is left behind and
    means nothing by itself. It names process and host, for the message to whoever comes second. On a file system
    that has no locks there is none.

    Raises
    ------
    InputError
        If another process holds it; named after ``target``, what the folder is for.
    """

    def __init__(self, folder: Path, target: str | os.PathLike[str]) -> None:
        self._file = -1
        while self._file < 0:
            folder.mkdir(exist_ok=True)
            self._take(folder / "lock", target)

    def _take(self, path: Path, target: str | os.PathLike[str]) -> None:
        """Hold the lock, or nothing where the file was taken away meanwhile."""
        try:
            file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        except FileNotFoundError:  # its folder was taken away by who has just finished
            return
        try:
            if fcntl:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.read(file, 200).decode("utf-8", "replace").strip() or "unknown"
            os.close(file)
            raise InputError(
                "another process is writing this",
                file=target,
                got=holder,
                hint="wait until it has ended, or end it and start again: what it did is kept",
            ) from None
        except OSError:  # no locks on this file system
            pass
        if not path.exists() or not os.path.samestat(os.fstat(file), path.stat()):
            os.close(file)
            return
        os.truncate(file, 0)
        os.write(file, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
        self._file = file

    def release(self) -> None:
        """Let others in; may be called again."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
