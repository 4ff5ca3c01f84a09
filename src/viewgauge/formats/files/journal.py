"""What a long job has done, chunk by chunk, so that it goes on from there when it is started again."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import uuid
import zipfile
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .atomic import writing_in
from .lock import LOCK_FILES, lock_folder

__all__ = ["ChunkJournal", "read_entry", "record_entry"]

_JOB, _ENTRIES = "job.json", "done"


class ChunkJournal:
    """A folder with one small file of arrays (``.npz``) for each chunk that is done.

    It belongs to one job, which its fingerprint identifies: what another job has left is discarded when it is opened.
    It is locked against other processes until it is closed, which keeps it, or discarded. All files of a job lie below
    a folder that is named after its fingerprint, so that a late worker of another job can do no harm here.

    Parameters
    ----------
    folder
        Made where it is absent; the one above it must be there.
    fingerprint
        All that the results depend on, such as the hash of inputs, options, chunk size and version.
    target
        What the job is to make, named in messages; by default the folder.

    Raises
    ------
    InputError
        If another process is at work on it, or the place cannot be written to.
    """

    def __init__(
        self, folder: str | os.PathLike[str], fingerprint: str, *, target: str | os.PathLike[str] | None = None
    ) -> None:
        self.folder, self.fingerprint = Path(folder), fingerprint
        self._target = folder if target is None else target
        with writing_in(self._target):
            self._lock = lock_folder(self.folder, self._target)
            try:
                if not (self.job / _JOB).exists():
                    self.restart()
            except BaseException:
                self._lock.release()
                raise

    @property
    def job(self) -> Path:
        """The folder of this job, for what else it keeps until it is finished."""
        return self.folder / hashlib.sha256(self.fingerprint.encode()).hexdigest()[:16]

    def restart(self) -> None:
        """Discard what is in the folder, of this job and of others, and begin anew."""
        for path in self.folder.iterdir():
            if path.name not in LOCK_FILES:
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        self.job.mkdir()
        (self.job / _ENTRIES).mkdir()
        (self.job / _JOB).write_text(json.dumps({"fingerprint": self.fingerprint}), encoding="utf-8")

    def done(self) -> dict[int, Path]:
        """The entry of each chunk that is done, in order; one that cannot be read (torn) counts as not done."""
        paths = {int(path.stem): path for path in (self.job / _ENTRIES).glob("*.npz") if path.stem.isdigit()}
        return {chunk: paths[chunk] for chunk in sorted(paths) if _readable(paths[chunk])}

    def record(self, chunk: int, **arrays: ArrayLike) -> None:
        """Note that a chunk is done, with its arrays; raises InputError where they cannot be written."""
        with writing_in(self._target):
            record_entry(self.job, chunk, **arrays)

    def close(self) -> None:
        """Let other processes in; what was recorded is kept."""
        self._lock.release()

    def discard(self) -> None:
        """Take the journal away: the job is finished, or given up."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def record_entry(job: Path, chunk: int, **arrays: ArrayLike) -> None:
    """Record in the journal of a job's folder (:attr:`ChunkJournal.job`), also from another process."""
    given = {name: np.asarray(array) for name, array in arrays.items()}
    if any(array.dtype.hasobject for array in given.values()):
        raise ValueError("an entry holds numbers and text, no objects")
    place = job / _ENTRIES
    temporary = place / f".{uuid.uuid4().hex}"
    try:
        with temporary.open("wb") as stream:
            np.savez(stream, **given)  # type: ignore[arg-type]
        os.replace(temporary, place / f"{chunk:08d}.npz")
    finally:
        temporary.unlink(missing_ok=True)


def read_entry(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of an entry."""
    with np.load(path, allow_pickle=False) as entry:
        return {name: entry[name] for name in entry.files}


def _readable(path: Path) -> bool:
    try:
        read_entry(path)
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, KeyError):
        return False
    return True
