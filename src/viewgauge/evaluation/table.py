"""The table setting x dimension: how well each sensor setting measures each dimension, by its best gauge."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..errors import SpatialQuantization
from ..geometry import Camera, PoseError, invert, transform
from ..part import Dimension, Mesh
from ..part.gauge_table import GaugeTable
from ..visibility import REASONS, ObservationLimits, Occluder, observe
from .requirement import Requirement
from .segment import FirstOrderMethod, SegmentImage, image_segment
from .validity import WARNINGS, validity

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

_PAIRS_PER_CHUNK = 200_000  # bounds memory to a few hundred bytes times this


@dataclass(frozen=True)
class _Chunk:
    """Values of c settings x g gauges; lengths and sigmas in px, NaN where not defined."""

    reason: NDArray[np.int8]
    length_px: NDArray[np.float64]
    angle_rad: NDArray[np.float64]
    sigma_displacement_px: NDArray[np.float64]
    sigma_quantization_px: NDArray[np.float64]
    probability: NDArray[np.float64]
    expected_accuracy: NDArray[np.float64]


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
    gauges = GaugeTable.of(dimensions)
    allowed = np.array([_allowed_error(requirement, dimension) for dimension in dimensions])
    tolerance = allowed[gauges.dimension] / gauges.length_mm
    occluder = Occluder(mesh)
    limits = limits or ObservationLimits()
    step = max(1, _PAIRS_PER_CHUNK // max(len(gauges), 1))
    chunks = []
    for first in range(0, len(T_part_camera), step):
        poses = T_part_camera[first : first + step]
        values = _evaluate_gauges(poses, gauges, tolerance, camera, error, occluder, limits, method)
        chunk = _best_gauges(values, gauges, tolerance)
        chunk["validity"] = _validity(poses, chunk, gauges, camera, error)
        chunks.append(chunk)
        if progress:
            progress(len(poses))
    columns = {
        name: np.concatenate([chunk[name] for chunk in chunks]) if chunks else np.zeros((0, len(dimensions)))
        for name in ("reason", *COLUMNS[2:9], "gauge", "validity")
    }
    reason = np.array(REASONS, dtype=object)[columns.pop("reason").astype(int)]
    columns["validity"] = np.array(["", *WARNINGS], dtype=object)[columns["validity"].astype(int)]
    data = {"visible": reason == "", "reason": reason, **columns}
    data["accepted"] = data["visible"] & (data["probability"] >= requirement.probability)
    return xr.Dataset(
        {name: (("setting", "dimension"), data[name]) for name in (*COLUMNS, "gauge", "validity")},
        coords={
            "setting": ("setting", list(setting_ids)),
            "dimension": ("dimension", [dimension.id for dimension in dimensions]),
            "nominal_mm": ("dimension", [dimension.nominal_mm for dimension in dimensions]),
            "allowed_error_mm": ("dimension", allowed),
        },
        attrs={"method": method, "required_probability": requirement.probability},
    )


def _allowed_error(requirement: Requirement, dimension: Dimension) -> float:
    allowed = requirement.allowed_error_mm(dimension.nominal_mm, dimension.tolerance_mm)
    if allowed is None:
        raise ValueError(f"dimension {dimension.id} has no tolerance, which the requirement needs")
    return allowed


def _evaluate_gauges(
    T_part_camera: NDArray[np.float64],
    gauges: GaugeTable,
    tolerance: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
    occluder: Occluder,
    limits: ObservationLimits,
    method: FirstOrderMethod,
) -> _Chunk:
    observation = observe(T_part_camera, gauges, camera, occluder, limits)
    setting, gauge = np.nonzero(observation.visible)
    points = observation.points_camera[setting, gauge]
    image = image_segment(points[:, 0], points[:, 1], camera, error, method)
    quantization = SpatialQuantization(camera.quantization_step_mm, image.angle_rad)
    direction = np.stack([np.cos(image.angle_rad), np.sin(image.angle_rad)], axis=-1)
    per_mm = np.linalg.norm(direction / np.asarray(camera.pixel_pitch_mm), axis=-1)  # px per mm along the segment

    def spread(values: NDArray[np.float64], elsewhere: float) -> NDArray[np.float64]:
        full = np.full(observation.reason.shape, elsewhere)
        full[setting, gauge] = values
        return full

    return _Chunk(
        reason=observation.reason,
        length_px=observation.length_px,
        angle_rad=_angles(observation.points_camera, camera),
        sigma_displacement_px=spread(image.sigma_displacement_mm * per_mm, np.nan),
        sigma_quantization_px=spread(quantization.std() * per_mm, np.nan),
        probability=spread(image.success_probability(camera, tolerance[gauge]), 0.0),
        expected_accuracy=spread(_expected_accuracy(image, image.mean_absolute_error(camera)), 0.0),
    )


def _expected_accuracy(image: SegmentImage, mean_absolute_mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """1 - E|error| / L (eq. 20), not below 0; 0 for a segment seen end-on, which has no length to be measured."""
    length = image.length_mm
    relative = np.divide(mean_absolute_mm, length, out=np.ones_like(length), where=length > 0)
    return np.asarray(np.maximum(1 - relative, 0.0))


def _angles(points_camera: NDArray[np.float64], camera: Camera) -> NDArray[np.float64]:
    """Direction gamma of the image of ``(..., 2, 3)`` mm points from +u, rad; NaN where there is none."""
    image = camera.project(points_camera)
    delta = image[..., 1, :] - image[..., 0, :]
    return np.asarray(np.arctan2(delta[..., 1], delta[..., 0]))


def _best_gauges(values: _Chunk, gauges: GaugeTable, tolerance: NDArray[np.float64]) -> dict[str, NDArray[np.generic]]:
    """For each setting and dimension the values of its best gauge."""
    # visible gauges rank by probability (then by expected accuracy), others below them by how far they got
    last = len(REASONS) - 1
    rank = np.where(
        values.reason == last,
        2.0 + values.probability + 1e-9 * values.expected_accuracy,
        values.reason / len(REASONS),
    )
    count = len(gauges.first)
    best = np.zeros((len(rank), count), dtype=np.int64)
    ends = np.append(gauges.first, len(gauges))[1:]
    for dimension, (first, end) in enumerate(zip(gauges.first, ends, strict=True)):
        best[:, dimension] = first + np.argmax(rank[:, first:end], axis=1)

    def take(array: NDArray[np.generic]) -> NDArray[np.generic]:
        return np.asarray(np.take_along_axis(array, best, axis=1))

    return {
        "reason": take(values.reason),
        "image_length_px": take(values.length_px),
        "angle_rad": take(values.angle_rad),
        "relative_tolerance": tolerance[best],
        "sigma_displacement_px": take(values.sigma_displacement_px),
        "sigma_quantization_px": take(values.sigma_quantization_px),
        "probability": take(values.probability),
        "expected_accuracy": take(values.expected_accuracy),
        "gauge": best - gauges.first,
    }


def _validity(
    T_part_camera: NDArray[np.float64],
    chunk: dict[str, NDArray[np.generic]],
    gauges: GaugeTable,
    camera: Camera,
    error: PoseError,
) -> NDArray[np.int8]:
    """For each setting and dimension 0, or one more than the index of the warning that its visible gauge gives."""
    codes = np.zeros(chunk["reason"].shape, dtype=np.int8)
    setting, dimension = np.nonzero(chunk["reason"] == len(REASONS) - 1)
    gauge = gauges.first[dimension] + np.asarray(chunk["gauge"][setting, dimension], dtype=np.int64)
    points = transform(invert(T_part_camera[setting])[:, None], gauges.points[gauge].reshape(-1, 2, 3))
    tolerance = np.asarray(chunk["relative_tolerance"][setting, dimension], dtype=float)
    names = validity(points[:, 0], points[:, 1], camera, error, tolerance)
    for code, name in enumerate(WARNINGS, start=1):
        codes[setting[names == name], dimension[names == name]] = code
    return codes
