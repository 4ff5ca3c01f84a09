"""The table setting x dimension: how well each sensor setting measures each dimension, by its best gauge."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..drawing import drawing
from ..part import Dimension
from ..visibility import REASONS
from .validity import WARNINGS

if TYPE_CHECKING:
    import xarray as xr
    from plotly.graph_objects import Figure

__all__ = ["COLUMNS", "as_dataset"]

COLUMNS = (
    "visible",
    "reason",
    "image_length_px",
    "angle_rad",
    "relative_tolerance",
    "sigma_displacement_px",
    "sigma_quantization_px",
    "probability",
    "expected_accuracy",
    "accepted",
)
"""Columns of the table, beside ``setting`` and ``dimension``."""


@cache
def _give_picture() -> None:
    """``table.viewgauge.plot()``: datasets get what tables can do, once."""
    import xarray as xr

    class TableAccessor:
        """What a table setting x dimension can do beside being a dataset."""

        def __init__(self, table: xr.Dataset) -> None:
            self._table = table

        def plot(self, *, dark: bool = False) -> Figure:
            """A map of probabilities, settings down and dimensions across, as a Plotly figure."""
            return drawing().table_figure(self._table, dark=dark)

    xr.register_dataset_accessor("viewgauge")(TableAccessor)  # type: ignore[no-untyped-call]


def as_dataset(
    columns: Mapping[str, NDArray[np.generic]],
    setting_ids: Sequence[str],
    dimensions: Sequence[Dimension],
    allowed_error_mm: NDArray[np.float64],
    attrs: Mapping[str, str | float],
) -> xr.Dataset:
    """A dataset over (setting, dimension) of columns ``(n, d)``; reasons and warnings are given by their index."""
    import xarray as xr  # slow to import

    _give_picture()
    names = {"reason": REASONS, "validity": ("", *WARNINGS)}
    texts = {k: np.array(v, dtype=object)[columns[k].astype(int)] for k, v in names.items() if k in columns}
    return xr.Dataset(
        {name: (("setting", "dimension"), values) for name, values in ({**columns, **texts}).items()},
        coords={
            "setting": ("setting", list(setting_ids)),
            "dimension": ("dimension", [dimension.id for dimension in dimensions]),
            "nominal_mm": ("dimension", [dimension.nominal_mm for dimension in dimensions]),
            "allowed_error_mm": ("dimension", allowed_error_mm),
        },
        attrs=dict(attrs),
    )
