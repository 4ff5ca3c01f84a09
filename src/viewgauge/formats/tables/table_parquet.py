"""Tables as Parquet."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .table_layout import TableLayout
from .table_rows import RowTable, Sink, Values

__all__ = ["ParquetFormat"]


class ParquetFormat:
    """Parquet: one row a pair of viewpoint and characteristic, written from the start each time; needs pyarrow."""

    suffixes = (".parquet",)

    def open(self, path: str | os.PathLike[str], layout: TableLayout, fingerprint: str | None) -> RowTable:  # noqa: ARG002 - nothing is kept
        """The table under construction; raises InputError where it cannot be written."""
        return RowTable(path, layout, _parquet)


@contextmanager
def _parquet(temporary: Path, path: str | os.PathLike[str], layout: TableLayout) -> Iterator[Sink]:
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

        def sink(chunk: int, values: Values) -> None:
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
