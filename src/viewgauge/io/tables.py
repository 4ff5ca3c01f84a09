"""Write the table setting x dimension: CSV, Parquet or Zarr, by the file's suffix."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import xarray as xr

from ..exceptions import InputError
from .atomic import atomic_path

__all__ = ["require_table_suffix", "write_table"]

_SUFFIXES = (".csv", ".parquet", ".zarr")


def require_table_suffix(path: str | PathLike[str]) -> None:
    """Raise InputError unless the file's suffix names a known format, before any work is done for it."""
    if Path(path).suffix.lower() not in _SUFFIXES:
        raise InputError("this kind of table is not known", file=path, expected=f"a suffix of {', '.join(_SUFFIXES)}")


def write_table(table: xr.Dataset, path: str | PathLike[str], columns: Sequence[str]) -> None:
    """Write a dataset over (setting, dimension), one row a pair (CSV, Parquet) or as it is (Zarr).

    Parameters
    ----------
    columns
        Variables to write, in order, after ``setting`` and ``dimension``.

    Raises
    ------
    InputError
        For an unknown suffix, a missing library, or a place that cannot be written.
    """
    require_table_suffix(path)
    suffix = Path(path).suffix.lower()
    with atomic_path(path) as temporary:
        if suffix == ".zarr":
            _write_zarr(table, temporary)
            return
        rows = table[list(columns)].to_dataframe(dim_order=["setting", "dimension"]).reset_index()
        rows = rows[["setting", "dimension", *columns]]
        if suffix == ".csv":
            rows.to_csv(temporary, index=False, lineterminator="\n")
            return
        try:
            rows.to_parquet(temporary, index=False)
        except ImportError as error:
            raise _missing(path, "pyarrow") from error


def _write_zarr(table: xr.Dataset, path: Path) -> None:
    try:
        import zarr  # noqa: F401 - only to know whether it is there
    except ImportError as error:
        raise _missing(path, "zarr") from error
    # format 2: format 3 has no settled way to store text, and warns of it
    texts = {name: table[name].astype(str) for name in ("reason", "validity") if name in table}
    table.assign(texts).to_zarr(path, mode="w", consolidated=False, zarr_format=2)


def _missing(path: str | PathLike[str], library: str) -> InputError:
    return InputError(
        f"writing this kind of table needs {library}, which is not installed",
        file=path,
        hint='pip install "viewgauge[tables]", or write CSV',
    )
