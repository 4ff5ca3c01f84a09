"""Write a table that is in memory: a dataset over (viewpoint, characteristic)."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .table_store import Column, TableLayout, open_table, require_table_suffix

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["require_table_suffix", "write_table"]

_PAIRS_PER_CHUNK = 500_000


def write_table(table: xr.Dataset, path: str | PathLike[str], columns: Sequence[str]) -> None:
    """Write a dataset over (viewpoint, characteristic), one row a pair (CSV, Parquet) or as it is (Zarr).

    Parameters
    ----------
    columns
        Variables to write, in order, after ``viewpoint`` and ``characteristic``.

    Raises
    ------
    InputError
        For an unknown suffix, a missing library, or a place that cannot be written.
    """
    require_table_suffix(path)
    described = {str(name): _column(str(name), table[name].values, str(name) in columns) for name in table.data_vars}
    order = [*columns, *(name for name in described if name not in columns)]
    layout = TableLayout(
        [str(name) for name in table["viewpoint"].values],
        [str(name) for name in table["characteristic"].values],
        tuple(described[name][0] for name in order),
        max(1, _PAIRS_PER_CHUNK // max(table.sizes["characteristic"], 1)),
        {str(name): table[name].values for name in table.coords if name not in ("viewpoint", "characteristic")},
        {str(name): value for name, value in table.attrs.items()},
    )
    with open_table(path, layout) as store:
        for chunk in range(layout.chunks):
            viewpoints = layout.viewpoints(chunk)
            store.write(viewpoints.start, {name: values[viewpoints] for name, (_, values) in described.items()})


def _column(name: str, values: NDArray[np.generic], in_rows: bool) -> tuple[Column, NDArray[np.generic]]:
    """A variable's description and its values, texts as indices."""
    if values.dtype.kind in "OU":
        names, codes = np.unique(values.astype(str), return_inverse=True)
        return Column(name, "name", tuple(names.tolist()), in_rows), codes.reshape(values.shape)
    kinds = {"f": "real", "b": "flag", "i": "whole", "u": "whole"}
    return Column(name, kinds[values.dtype.kind], in_rows=in_rows), values  # type: ignore[arg-type] # one of its kinds
