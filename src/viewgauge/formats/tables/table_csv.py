"""Tables as CSV."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..files.spreadsheet_text import to_cell
from .table_layout import Column, TableLayout
from .table_rows import RowTable, Sink, Values

__all__ = ["CsvFormat", "csv_rows"]


class CsvFormat:
    """CSV: one row a pair of viewpoint and characteristic, written from the start each time."""

    suffixes = (".csv",)

    def open(self, path: str | os.PathLike[str], layout: TableLayout, fingerprint: str | None) -> RowTable:  # noqa: ARG002 - nothing is kept
        """The table under construction; raises InputError where it cannot be written."""
        return RowTable(path, layout, _csv)


@contextmanager
def _csv(temporary: Path, path: str | os.PathLike[str], layout: TableLayout) -> Iterator[Sink]:  # noqa: ARG001 - as _parquet
    with temporary.open("wb") as stream:
        header = ["viewpoint", "characteristic", *(column.name for column in layout.row_columns)]
        stream.write(b",".join(_quoted(header)) + b"\n")

        def sink(chunk: int, values: Values) -> None:
            stream.write(csv_rows(layout, chunk, values))

        yield sink


def csv_rows(layout: TableLayout, chunk: int, values: Values) -> bytes:
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
            writer.writerow([to_cell(text)])
        cells.append(buffer.getvalue().encode())
        buffer.seek(0)
        buffer.truncate()
    return cells
