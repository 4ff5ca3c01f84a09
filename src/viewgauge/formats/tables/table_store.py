"""Tables over (viewpoint, characteristic), written chunk by chunk: CSV, Parquet or Zarr, by the file's suffix.

A further format is a class like :class:`TableFormat` in a file of its own, and its place in ``TABLE_FORMATS``, or
``TABLE_FORMATS.register(...)`` from outside.
"""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ..files.registry import SuffixRegistry
from .table_csv import CsvFormat
from .table_layout import Column, TableLayout
from .table_parquet import ParquetFormat
from .table_zarr import ZarrFormat

__all__ = [
    "TABLE_FORMATS",
    "Column",
    "TableFormat",
    "TableLayout",
    "TableStore",
    "open_table",
    "require_table_suffix",
]


class TableStore(Protocol):
    """A table under construction, used as a context manager: complete at its place when the block ends well.

    If the block fails, what stood there before is left as it was. A block that ends before all chunks are written is
    an error of the program (ValueError).
    """

    @property
    def done(self) -> Mapping[int, Mapping[str, Any]]:
        """Summaries of the chunks that an earlier process has written, which need not be written again."""
        ...

    def write(
        self, first_viewpoint: int, values: Mapping[str, NDArray[np.generic]], summary: Mapping[str, Any] | None = None
    ) -> None:
        """Write the chunk of viewpoints that begins with ``first_viewpoint``, in any order, each once.

        Parameters
        ----------
        values
            For each column of the layout its array ``(m, D)``.
        summary
            Plain data (JSON) that is given back in :attr:`done`.
        """
        ...

    def __enter__(self) -> Self: ...

    def __exit__(self, *_: Any) -> None: ...


class TableFormat(Protocol):
    """Writes one kind of table."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """In lower case, with their point."""
        ...

    def open(self, path: str | PathLike[str], layout: TableLayout, fingerprint: str | None) -> TableStore:
        """The table under construction; raises InputError where it cannot be written."""
        ...


TABLE_FORMATS: SuffixRegistry[TableFormat] = SuffixRegistry(CsvFormat(), ParquetFormat(), ZarrFormat())


def require_table_suffix(path: str | PathLike[str]) -> None:
    """Raise InputError unless the file's suffix names a known format, before any work is done for it."""
    _table_format(path)


def open_table(path: str | PathLike[str], layout: TableLayout, fingerprint: str | None = None) -> TableStore:
    """A table to be written to ``path``.

    A Zarr table that is given the fingerprint of an interrupted one goes on with it, and has a ``writer()`` for other
    processes (:class:`~viewgauge.formats.tables.table_zarr.ZarrTable`). CSV and Parquet are written from the start each
    time.

    Parameters
    ----------
    fingerprint
        Text that changes with anything that the content depends on; None to keep nothing.

    Raises
    ------
    InputError
        For an unknown suffix, a missing library, or a place that cannot be written.
    """
    return _table_format(path).open(path, layout, fingerprint)


def _table_format(path: str | PathLike[str]) -> TableFormat:
    found = TABLE_FORMATS.of(Path(path))
    if found is None:
        expected = f"a suffix of {', '.join(TABLE_FORMATS.suffixes)}"
        raise InputError("this kind of table is not known", file=path, expected=expected)
    return found
