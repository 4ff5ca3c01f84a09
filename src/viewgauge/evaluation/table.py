"""The table setting x dimension: how well each sensor setting measures each dimension, by its best gauge."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..geometry import Camera, PoseError
from ..part import Dimension, Mesh
from ..visibility import REASONS, ObservationLimits
from .evaluator import Evaluator, TableBlock
from .requirement import Requirement
from .segment import FirstOrderMethod
from .validity import WARNINGS

__all__ = ["COLUMNS", "evaluate_settings"]

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
    return as_dataset(evaluator.table(T_part_camera, progress), setting_ids, dimensions, evaluator, requirement, method)


def as_dataset(
    values: TableBlock,
    setting_ids: Sequence[str],
    dimensions: Sequence[Dimension],
    evaluator: Evaluator,
    requirement: Requirement,
    method: FirstOrderMethod,
) -> xr.Dataset:
    """The table as :func:`evaluate_settings` gives it."""
    data = {name: getattr(values, name) for name in (*COLUMNS[2:9], "gauge")}
    data["visible"] = values.visible
    data["reason"] = np.array(REASONS, dtype=object)[values.reason]
    data["validity"] = np.array(["", *WARNINGS], dtype=object)[values.validity]
    data["accepted"] = data["visible"] & (values.probability >= requirement.probability)
    return xr.Dataset(
        {name: (("setting", "dimension"), data[name]) for name in (*COLUMNS, "gauge", "validity")},
        coords={
            "setting": ("setting", list(setting_ids)),
            "dimension": ("dimension", [dimension.id for dimension in dimensions]),
            "nominal_mm": ("dimension", [dimension.nominal_mm for dimension in dimensions]),
            "allowed_error_mm": ("dimension", evaluator.allowed_error_mm),
        },
        attrs={"method": method, "required_probability": requirement.probability},
    )
