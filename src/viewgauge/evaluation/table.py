"""The table viewpoint x characteristic: how well each viewpoint measures each characteristic, by its best measurand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..drawing import drawing
from ..part import Characteristic
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
"""Columns of the table, beside ``viewpoint`` and ``characteristic``."""


@cache
def _give_picture() -> None:
    """``table.viewgauge.plot()``: datasets get what tables can do, once."""
    import xarray as xr

    class TableAccessor:
        """What a table viewpoint x characteristic can do beside being a dataset."""

        def __init__(self, table: xr.Dataset) -> None:
            self._table = table

        def plot(self, *, dark: bool = False) -> Figure:
            """A map of probabilities, viewpoints down and characteristics across, as a Plotly figure."""
            return drawing().table_figure(self._table, dark=dark)

    xr.register_dataset_accessor("viewgauge")(TableAccessor)  # type: ignore[no-untyped-call]


def as_dataset(
    columns: Mapping[str, NDArray[np.generic]],
    viewpoint_ids: Sequence[str],
    characteristics: Sequence[Characteristic],
    allowed_error_mm: NDArray[np.float64],
    attrs: Mapping[str, str | float],
) -> xr.Dataset:
    """A dataset over (viewpoint, characteristic) of columns ``(n, d)``; reasons and warnings are given by their
    index.
    """
    import xarray as xr  # slow to import

    _give_picture()
    names = {"reason": REASONS, "validity": ("", *WARNINGS)}
    texts = {k: np.array(v, dtype=object)[columns[k].astype(int)] for k, v in names.items() if k in columns}
    return xr.Dataset(
        {name: (("viewpoint", "characteristic"), values) for name, values in ({**columns, **texts}).items()},
        coords={
            "viewpoint": ("viewpoint", list(viewpoint_ids)),
            "characteristic": ("characteristic", [characteristic.id for characteristic in characteristics]),
            "nominal_mm": ("characteristic", [characteristic.nominal_mm for characteristic in characteristics]),
            "allowed_error_mm": ("characteristic", allowed_error_mm),
        },
        attrs=dict(attrs),
    )
