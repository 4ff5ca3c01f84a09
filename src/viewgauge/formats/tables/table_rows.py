"""The table as rows, one a pair of viewpoint and characteristic: CSV and Parquet, written chunk by chunk in order.

Chunks may come in any order. One that is early waits on the disk beside the table, so memory holds one chunk.
"""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ..files.atomic import atomic_path
from .table_layout import Column, TableLayout

__all__ = ["RowTable", "csv_rows"]

_Values = Mapping[str, NDArray[np.generic]]


_Sink = Callable[[int, _Values], None]


class RowTable:
    """A CSV or Parquet file under construction: complete at ``path`` when its block ends well, else absent.

    Parameters
    ----------
    path
        Ends in ``.csv`` or ``.parquet``, in any case.
    layout
        What the table consists of.

    Raises
    ------
    InputError
        If the place cannot be written to or pyarrow, which Parquet needs, is not installed.
    """

    done: Mapping[int, Mapping[str, Any]] = {}  # an unfinished file is not kept

    def __init__(self, path: str | os.PathLike[str], layout: TableLayout) -> None:
        self._layout = layout
        self._next = 0
        self._early: dict[int, Path] = {}
        sink = _parquet if Path(path).suffix.lower() == ".parquet" else _csv
        with ExitStack() as stack:
            temporary = stack.enter_context(atomic_path(path))
            beside = None if temporary.exists() else temporary.parent  # a device has no place beside it
            self._aside = Path(stack.enter_context(TemporaryDirectory(prefix=".viewgauge-", dir=beside)))
            self._sink = stack.enter_context(sink(temporary, path, layout))
            self._stack = stack.pop_all()

    def write(self, first_viewpoint: int, values: _Values, summary: Mapping[str, Any] | None = None) -> None:  # noqa: ARG002 - nothing is kept
        """Write the chunk of viewpoints that begins with ``first_viewpoint``; for each column its array ``(m, D)``."""
        chunk = self._layout.chunk_of(first_viewpoint)
        if chunk < self._next or chunk in self._early:
            raise ValueError(f"chunk {chunk} was written before")
        checked = self._layout.checked(chunk, values)
        if chunk > self._next:
            self._early[chunk] = self._aside / f"{chunk}.npz"
            np.savez(self._early[chunk], **checked)  # type: ignore[arg-type] # names of columns, not of options
            return
        self._sink(chunk, checked)
        self._next += 1
        while self._next in self._early:
            path = self._early.pop(self._next)
            with np.load(path, allow_pickle=False) as stored:
                self._sink(self._next, stored)
            path.unlink()
            self._next += 1

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None and self._next < self._layout.chunks:
            incomplete = ValueError(f"chunk {self._next} is missing")
            self._stack.__exit__(ValueError, incomplete, None)
            raise incomplete
        self._stack.__exit__(kind, error, trace)


@contextmanager
def _csv(temporary: Path, path: str | os.PathLike[str], layout: TableLayout) -> Iterator[_Sink]:  # noqa: ARG001 - as _parquet
    with temporary.open("wb") as stream:
        header = ["viewpoint", "characteristic", *(column.name for column in layout.row_columns)]
        stream.write(b",".join(_quoted(header)) + b"\n")

        def sink(chunk: int, values: _Values) -> None:
            stream.write(csv_rows(layout, chunk, values))

        yield sink


def csv_rows(layout: TableLayout, chunk: int, values: _Values) -> bytes:
    """The lines of a chunk; numbers with the fewest digits that tell them from others, NaN as an empty cell."""
    from .row_text import row_lines  # its compiler is not loaded for Parquet

    ids = layout.viewpoint_ids[layout.viewpoints(chunk)]
    columns = [_cells(column, np.asarray(values[column.name]).ravel()) for column in layout.row_columns]
    return row_lines(_quoted(ids), _quoted(layout.characteristic_ids), columns)


def _cells(column: Column, values: NDArray[Any]) -> NDArray[np.float64] | tuple[NDArray[np.integer], Sequence[bytes]]:
    if column.kind == "real":
        return values
    if column.kind == "whole":
        numbers, index = np.unique(values, return_inverse=True)
        return index, [str(number).encode() for number in numbers.tolist()]
    return values, _quoted(column.names) if column.kind == "name" else [b"False", b"True"]


def _quoted(texts: Sequence[str]) -> list[bytes]:
    """Texts as cells of CSV: in quotes where they need them."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="")
    cells = []
    for text in texts:
        if text:  # alone in its row, an empty one would be put in quotes
            writer.writerow([text])
        cells.append(buffer.getvalue().encode())
        buffer.seek(0)
        buffer.truncate()
    return cells


@contextmanager
def _parquet(temporary: Path, path: str | os.PathLike[str], layout: TableLayout) -> Iterator[_Sink]:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError as error:
        raise InputError(
            "writing this kind of table needs pyarrow, which is not installed",
            file=path,
            hint='pip install "viewgauge[tables]", or write CSV',
        ) from error
    types = {"real": pa.float64(), "flag": pa.bool_(), "whole": pa.int64(), "name": pa.string()}
    columns = layout.row_columns
    schema = pa.schema(
        [("viewpoint", pa.string()), ("characteristic", pa.string()), *((c.name, types[c.kind]) for c in columns)]
    )

    def chosen(names: Sequence[str], index: NDArray[np.int64]) -> Any:
        return pa.array(names, pa.string()).take(pa.array(index))

    with pq.ParquetWriter(temporary, schema) as writer:

        def sink(chunk: int, values: _Values) -> None:
            ids = layout.viewpoint_ids[layout.viewpoints(chunk)]
            pairs = np.indices((len(ids), len(layout.characteristic_ids))).reshape(2, -1)
            arrays = [chosen(ids, pairs[0]), chosen(layout.characteristic_ids, pairs[1])]
            for column in columns:
                flat = np.asarray(values[column.name]).ravel()
                if column.kind == "name":
                    arrays.append(chosen(column.names, flat.astype(np.int64)))
                else:
                    arrays.append(pa.array(flat, types[column.kind], from_pandas=True))  # NaN is null
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))

        yield sink
