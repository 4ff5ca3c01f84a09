"""The table setting x dimension: how well each sensor setting measures each dimension, by its best gauge."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..geometry import Camera, PoseError
from ..part import Dimension, Mesh
from ..visibility import REASONS, ObservationLimits
from .evaluator import Evaluator
from .requirement import Requirement
from .segment import FirstOrderMethod
from .validity import WARNINGS

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["COLUMNS", "as_dataset", "evaluate_settings"]

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


def evaluate_settings(
    T_part_camera: NDArray[np.float64],
    setting_ids: Sequence[str],
    dimensions: Sequence[Dimension],
    mesh: Mesh,
    camera: Camera,
    error: PoseError,
    requirement: Requirement,
    limits: ObservationLimits | None = None,
    method: FirstOrderMethod = "joint",
    progress: Callable[[int], None] | None = None,
) -> xr.Dataset:
    """Evaluate every dimension from every setting.

    Parameters
    ----------
    T_part_camera
        ``(n, 4, 4)`` mm.
    setting_ids
        Names of the n settings.
    dimensions
        Each with at least one gauge and an allowed error under the requirement.
    mesh
        The part's surface, which hides.
    progress
        Called with the number of settings done since the last call.

    Returns
    -------
    A dataset over (setting, dimension) with the variables of :data:`COLUMNS`, ``gauge`` (index of the best gauge
    of the dimension: the surest visible one, else the one that fails at the latest condition) and ``validity``
    (why the first-order probability is doubtful, :func:`~viewgauge.evaluation.validity`; "" where it is not, or
    nothing is visible), and with the coordinates ``nominal_mm`` and ``allowed_error_mm`` of the dimensions. A pair
    that is not visible has probability and expected accuracy 0. Probabilities refer to |measured - nominal| <=
    allowed error.
    """
    evaluator = Evaluator(dimensions, mesh, camera, error, requirement, limits, method)
    values = evaluator.table(T_part_camera, progress)
    columns = {name: getattr(values, name) for name in (*COLUMNS, "gauge", "validity") if name != "accepted"}
    columns["accepted"] = values.visible & (values.probability >= requirement.probability)
    attrs: dict[str, str | float] = {"method": method, "required_probability": requirement.probability}
    return as_dataset(columns, setting_ids, dimensions, evaluator.allowed_error_mm, attrs)


def as_dataset(
    columns: Mapping[str, NDArray[np.generic]],
    setting_ids: Sequence[str],
    dimensions: Sequence[Dimension],
    allowed_error_mm: NDArray[np.float64],
    attrs: Mapping[str, str | float],
) -> xr.Dataset:
    """A dataset over (setting, dimension) of columns ``(n, d)``; reasons and warnings are given by their index."""
    import xarray as xr  # slow to import

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
