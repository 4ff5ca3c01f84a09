"""Tables over (viewpoint, characteristic), written chunk by chunk: CSV, Parquet or Zarr, by the file's suffix."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .table_layout import Column, TableLayout

__all__ = ["Column", "TableLayout", "TableStore", "open_table", "require_table_suffix"]

_SUFFIXES = (".csv", ".parquet", ".zarr")


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


def require_table_suffix(path: str | PathLike[str]) -> None:
    """Raise InputError unless the file's suffix names a known format, before any work is done for it."""
    if Path(path).suffix.lower() not in _SUFFIXES:
        raise InputError("this kind of table is not known", file=path, expected=f"a suffix of {', '.join(_SUFFIXES)}")


def open_table(path: str | PathLike[str], layout: TableLayout, fingerprint: str | None = None) -> TableStore:
    """A table to be written to ``path``.

    A Zarr table that is given the fingerprint of an interrupted one goes on with it, and has a ``writer()`` for other
    processes (:class:`~viewgauge.formats.tables.table_zarr.ZarrTable`). CSV and Parquet are written from the start each
    time.

    Parameters
    ----------
    fingerprint
        All that the content depends on.

    Raises
    ------
    InputError
        For an unknown suffix, a missing library, or a place that cannot be written.
    """
    require_table_suffix(path)
    if Path(path).suffix.lower() == ".zarr":
        from .table_zarr import ZarrTable

        return ZarrTable(path, layout, fingerprint)
    from .table_rows import RowTable

    return RowTable(path, layout)
