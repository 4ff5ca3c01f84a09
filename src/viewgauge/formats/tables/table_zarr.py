"""The table as a Zarr store that is built chunk by chunk, by several processes, and goes on where it was stopped.

It is built in a journal's folder beside its place, ``.NAME.partial``, and moved there when it is complete. A chunk of
viewpoints is one file for each column; its entry in the journal is made when all are written. Chunks are compressed
without regard to what else runs, so the bytes do not tell how they came about. The format is Zarr's 2 (format 3 has
no settled way to store text) with the conventions of xarray.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import socket
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ..files.atomic import move_into_place, writing_in
from ..files.journal import ChunkJournal, read_entry, record_entry
from .table_layout import TableLayout

__all__ = ["ZarrFormat", "ZarrRegionWriter", "ZarrTable"]

_OURS = re.compile(r"\.zarray|\.zattrs|\.zgroup|\d+(\.\d+)*")  # all other files are of writers that were killed
_IDS_PER_CHUNK = 2**16


@dataclass(frozen=True)
class ZarrRegionWriter:
    """Writes chunks of a table, in any process that sees its folder; several at once, each its own chunk."""

    job: Path
    layout: TableLayout
    target: Path

    def write(
        self, first_viewpoint: int, values: Mapping[str, NDArray[np.generic]], summary: Mapping[str, Any] | None = None
    ) -> None:
        """Write a chunk and record that it is done, with a summary of plain data; see :meth:`ZarrTable.write`.

        Raises
        ------
        InputError
            If the place cannot be written to, or is not there on this machine.
        """
        if not (self.job / "table").is_dir():
            raise InputError(
                f"the table's folder {self.job} is not there on {socket.gethostname()}, which is to write a part of it",
                file=self.target,
                hint="write it to a folder that all workers share by the same path, or write CSV or Parquet, which "
                "workers do not write",
            )
        with writing_in(self.target):
            self._write(first_viewpoint, values, summary)

    def _write(
        self, first_viewpoint: int, values: Mapping[str, NDArray[np.generic]], summary: Mapping[str, Any] | None
    ) -> None:
        import zarr

        chunk = self.layout.chunk_of(first_viewpoint)
        checked = self.layout.checked(chunk, values)
        group = zarr.open_group(self.job / "table", mode="r+", zarr_format=2)
        with zarr.config.set({"array.write_empty_chunks": True}):  # the same files whatever the user's configuration
            for column in self.layout.columns:
                array = checked[column.name]
                if column.kind == "name":
                    array = np.array(column.names, dtype=column.dtype)[array.astype(np.int64)]
                group[column.name][self.layout.viewpoints(chunk)] = array
        digests = json.dumps(_digests(self.job / "table", self.layout, chunk))
        record_entry(self.job, chunk, summary=json.dumps(dict(summary or {})), digests=digests)


class ZarrTable:
    """A table under construction: complete at ``path`` when its block ends well, else kept to go on with.

    Parameters
    ----------
    path
        A folder, replaced if it is there.
    layout
        What the table consists of.
    fingerprint
        Text that changes with anything that the content depends on. With the same text, what an earlier process has
        written is :attr:`done`. None: nothing is kept, neither from earlier nor for later.

    Raises
    ------
    InputError
        If Zarr is not installed, the place cannot be written to, or another process is writing the same table.
    """

    def __init__(self, path: str | os.PathLike[str], layout: TableLayout, fingerprint: str | None = None) -> None:
        try:
            import zarr  # noqa: F401 - only to know whether it is there
        except ImportError as error:
            raise InputError(
                "writing this kind of table needs zarr, which is not installed",
                file=path,
                hint='pip install "viewgauge[tables]", or write CSV',
            ) from error
        self._path, self._layout, self._keep = Path(os.path.realpath(path)), layout, fingerprint is not None
        if self._path.exists() and not self._path.is_dir():
            raise InputError("a folder cannot be written where a file is", file=path, hint="give another path")
        self._journal = ChunkJournal(partial_path(path), fingerprint or "", target=path)
        try:
            with writing_in(path):
                self._begin()
        except BaseException:
            self._journal.close()
            raise

    def _begin(self) -> None:
        """Make the table without its chunks, unless it is there and is to be kept."""
        table = self._journal.job / "table"
        made = table.with_name("begun")
        if not self._keep or not table.exists():
            self._journal.restart()
            _make(made, self._layout)
            made.rename(table)
        else:  # a power cut may have left files empty: all but the chunks is made anew
            shutil.rmtree(made, ignore_errors=True)
            _make(made, self._layout)
            _mend(table, made)
        self.done: dict[int, dict[str, Any]] = {}
        for chunk, entry in self._journal.done().items():
            summary = _summary(table, self._layout, chunk, entry)
            if summary is None:
                entry.unlink()
            else:
                self.done[chunk] = summary
        """Summaries of the chunks that are done, by chunk, as they were when the table was opened."""

    def writer(self) -> ZarrRegionWriter:
        """A writer of chunks for other processes; it is small, for it has no ids of viewpoints."""
        unnamed = range(len(self._layout.viewpoint_ids))
        layout = replace(self._layout, viewpoint_ids=unnamed)  # type: ignore[arg-type] # never read
        return ZarrRegionWriter(self._journal.job, layout, self._path)

    def write(
        self, first_viewpoint: int, values: Mapping[str, NDArray[np.generic]], summary: Mapping[str, Any] | None = None
    ) -> None:
        """Write the chunk of viewpoints that begins with ``first_viewpoint``.

        Parameters
        ----------
        values
            For each column its array ``(m, D)``.
        summary
            Plain data, given back in :attr:`done` when the table is opened again.
        """
        self.writer().write(first_viewpoint, values, summary)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        finished = False
        try:
            if kind is None:
                self._finish()
                finished = True
        finally:
            if finished or not self._keep:
                self._journal.discard()
            else:
                self._journal.close()

    def _finish(self) -> None:
        missing = set(range(self._layout.chunks)) - set(self._journal.done())
        if missing:
            raise ValueError(f"{len(missing)} chunks are missing, such as chunk {min(missing)}")
        table = self._journal.job / "table"
        for folder, _, names in os.walk(table):
            for name in names:
                if not _OURS.fullmatch(name):
                    Path(folder, name).unlink()
        move_into_place(table, self._path)


class ZarrFormat:
    """Zarr: a folder of arrays, built by several processes, which goes on with an interrupted table; needs zarr."""

    suffixes = (".zarr",)

    def open(self, path: str | os.PathLike[str], layout: TableLayout, fingerprint: str | None) -> ZarrTable:
        """The table under construction; raises InputError where it cannot be written."""
        return ZarrTable(path, layout, fingerprint)


def _mend(table: Path, made: Path) -> None:
    """Put each file of a table without chunks in the place of the one of a table that was begun; ``made`` goes."""
    for folder, _, names in os.walk(made):
        place = table / Path(folder).relative_to(made)
        place.mkdir(exist_ok=True)
        for name in names:
            os.replace(Path(folder, name), place / name)
    shutil.rmtree(made)


def _digests(table: Path, layout: TableLayout, chunk: int) -> dict[str, str]:
    """A digest of the file of each column of a chunk that has one: a table without characteristics has none."""
    files = {column.name: table / column.name / f"{chunk}.0" for column in layout.columns}
    return {
        name: hashlib.blake2b(file.read_bytes(), digest_size=16).hexdigest()
        for name, file in files.items()
        if file.exists()
    }


def _summary(table: Path, layout: TableLayout, chunk: int, entry: Path) -> dict[str, Any] | None:
    """The summary of a chunk that is done; None where the entry or a file of the chunk is not as it was written."""
    try:
        noted = read_entry(entry)
        summary, digests = json.loads(str(noted["summary"])), json.loads(str(noted["digests"]))
        whole = chunk < layout.chunks and digests == _digests(table, layout, chunk)
    except (KeyError, ValueError, OSError):
        return None
    return summary if whole and isinstance(summary, dict) else None


def partial_path(path: str | os.PathLike[str]) -> Path:
    """Where a table is built that is to be at ``path``."""
    target = Path(os.path.realpath(path))
    return target.with_name(f".{target.name}.partial")


def _make(path: Path, layout: TableLayout) -> None:
    import zarr

    group = zarr.create_group(path, zarr_format=2, attributes=dict(layout.attrs))
    viewpoints, characteristics = layout.viewpoint_ids, layout.characteristic_ids
    _fill(group, "viewpoint", _Texts(viewpoints), ["viewpoint"])
    _fill(group, "characteristic", _Texts(characteristics), ["characteristic"])
    for name, values in layout.coordinates.items():
        _fill(group, name, np.asarray(values, dtype=float), ["characteristic"])
    attributes = {"coordinates": " ".join(sorted(layout.coordinates))} if layout.coordinates else {}
    for column in layout.columns:
        _create(
            group,
            column.name,
            (len(viewpoints), len(characteristics)),
            (layout.chunk_viewpoints, max(len(characteristics), 1)),
            column.dtype,
            {**attributes, "_ARRAY_DIMENSIONS": ["viewpoint", "characteristic"]},
        )


class _Texts:
    """Texts as an array of fixed width of which only slices are made: there may be more than memory holds."""

    def __init__(self, texts: Sequence[str]) -> None:
        self._texts = texts
        width = max((len(text) for k in range(0, len(texts), _IDS_PER_CHUNK) for text in self._some(k)), default=1)
        self.dtype, self.shape = np.dtype(f"<U{max(width, 1)}"), (len(texts),)

    def _some(self, first: int) -> Sequence[str]:
        return self._texts[first : first + _IDS_PER_CHUNK]

    def __len__(self) -> int:
        return len(self._texts)

    def __getitem__(self, some: slice) -> NDArray[np.str_]:
        return np.array(self._texts[some], dtype=self.dtype)


def _fill(group: Any, name: str, values: _Texts | NDArray[np.float64], over: list[str]) -> None:
    chunk = (min(max(len(values), 1), _IDS_PER_CHUNK),)
    _create(group, name, values.shape, chunk, values.dtype, {"_ARRAY_DIMENSIONS": over})
    for first in range(0, len(values), _IDS_PER_CHUNK):
        some = slice(first, min(first + _IDS_PER_CHUNK, len(values)))
        group[name][some] = values[some]


def _create(
    group: Any,
    name: str,
    shape: tuple[int, ...],
    chunks: tuple[int, ...],
    dtype: np.dtype[np.generic],
    attributes: dict[str, Any],
) -> None:
    from numcodecs import Shuffle, Zstd

    # not Blosc, which as a rule lets its threads decide the order of bytes
    group.create_array(
        name,
        shape=shape,
        chunks=tuple(min(chunk, max(length, 1)) for chunk, length in zip(chunks, shape, strict=True)),
        dtype=dtype,
        filters=[Shuffle(dtype.itemsize)] if dtype.kind == "f" else None,
        compressors=Zstd(level=1),
        fill_value=np.nan if dtype.kind == "f" else None,
        attributes=attributes,
    )
