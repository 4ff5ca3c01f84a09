"""Evaluate given settings: the table setting x dimension."""

from __future__ import annotations

from os import PathLike
from typing import Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ..evaluation import evaluate_settings
from ..evaluation import success_probability as first_order_probability
from ..exceptions import InputError
from ..geometry import Camera, PoseError, invert, require_poses, transform
from ..io.settings import read_settings
from ..part import Dimension
from ..planning import without_allowed_error
from ..simulation import ExactEstimates, estimate_success_probabilities, require_precision
from .inspection import ExplicitSettings, Inspection
from .progress import Progress, Silent

__all__ = ["DEFAULT_PRECISION", "Method", "best_of_each", "evaluate", "simulate_pairs", "success_probability"]

Method = Literal["joint", "independent", "monte-carlo"]

DEFAULT_PRECISION = 1e-3
CONFIDENCE = 0.99  # of the intervals of "monte-carlo"
_PAIRS_PER_CHUNK = 500  # between two signs of progress


def evaluate(
    inspection: Inspection,
    settings: ExplicitSettings | str | PathLike[str] | ArrayLike | None = None,
    *,
    method: Method = "joint",
    precision: float = DEFAULT_PRECISION,
    progress: Progress | None = None,
) -> xr.Dataset:
    """The table setting x dimension.

    Parameters
    ----------
    settings
        A settings file (CSV), poses ``T_part_camera`` ``(n, 4, 4)`` mm, or None for those that the inspection
        file names.
    method
        "joint" (both ends share the pose error, the default), "independent" (the paper's), or "monte-carlo" (the
        exact camera by randomised quasi-Monte Carlo, for each visible pair).
    precision
        With "monte-carlo": half-width of the 99 % confidence interval of each probability.

    Returns
    -------
    Dataset over (setting, dimension) with the columns ``visible, reason, image_length_px, angle_rad,
    relative_tolerance, sigma_displacement_px, sigma_quantization_px, probability, expected_accuracy, accepted``
    and ``gauge``, the index of the best gauge, and ``validity``, what makes the first-order probability doubtful;
    with "monte-carlo" also the confidence interval ``probability_low, probability_high``.
    """
    progress = progress or Silent()
    chosen = _settings(inspection, settings)
    dimensions, _ = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    if method not in ("joint", "independent", "monte-carlo"):
        raise InputError("unknown method", key="method", got=method, expected="joint, independent or monte-carlo")
    require_precision(precision)
    with progress.stage(f"Evaluating {len(chosen.ids)} settings", len(chosen.ids)) as advance:
        table = evaluate_settings(
            chosen.T_part_camera,
            chosen.ids,
            dimensions,
            inspection.part.mesh,
            inspection.camera,
            inspection.head,
            inspection.requirement,
            inspection.limits,
            "joint" if method == "monte-carlo" else method,
            advance,
        )
    if method == "monte-carlo":
        table = _simulated(table, chosen.T_part_camera, dimensions, inspection, precision, progress)
    return table


def _settings(
    inspection: Inspection, settings: ExplicitSettings | str | PathLike[str] | ArrayLike | None
) -> ExplicitSettings:
    if settings is None:
        if inspection.settings is None:
            raise InputError(
                "no settings to evaluate", hint="give a settings file (CSV), or name one in candidates.settings"
            )
        return inspection.settings
    if isinstance(settings, ExplicitSettings):
        return settings
    if isinstance(settings, str | PathLike):
        return ExplicitSettings(*read_settings(settings))
    poses = require_poses(settings, "settings").reshape(-1, 4, 4)
    if not len(poses):
        raise InputError("no settings to evaluate", key="settings", got="no pose", expected="at least one")
    return ExplicitSettings(tuple(f"S{k}" for k in range(1, len(poses) + 1)), poses)


def simulate_pairs(
    table: xr.Dataset,
    pairs: NDArray[np.int64],
    T_part_camera: NDArray[np.float64],
    dimensions: tuple[Dimension, ...],
    inspection: Inspection,
    precision: float,
) -> ExactEstimates:
    """The exact camera's word on visible pairs ``(n, 2)`` of a table: indices of setting and dimension."""
    setting, dimension = pairs.T
    gauges = [dimensions[j].gauges[table["gauge"].values[k, j]] for k, j in pairs]
    ends = np.array([(gauge.start, gauge.end) for gauge in gauges])
    points = transform(invert(T_part_camera[setting])[:, None], ends)
    return estimate_success_probabilities(
        points[:, 0],
        points[:, 1],
        inspection.camera,
        inspection.head,
        table["relative_tolerance"].values[setting, dimension],
        precision=precision,
        confidence=CONFIDENCE,
        seed=inspection.seed,
    )


def _simulated(
    table: xr.Dataset,
    T_part_camera: NDArray[np.float64],
    dimensions: tuple[Dimension, ...],
    inspection: Inspection,
    precision: float,
    progress: Progress,
) -> xr.Dataset:
    """The table with probability, its interval, and expected accuracy of visible pairs by the exact camera."""
    over = ("setting", "dimension")
    probability, accuracy = (table[name].values.copy() for name in ("probability", "expected_accuracy"))
    low, high = probability * 0, probability * 0
    pairs = np.argwhere(table["visible"].values)
    with progress.stage(f"Simulating {len(pairs)} pairs to {precision:g}", len(pairs)) as advance:
        for first in range(0, len(pairs), _PAIRS_PER_CHUNK):
            chunk = pairs[first : first + _PAIRS_PER_CHUNK]
            estimates = simulate_pairs(table, chunk, T_part_camera, dimensions, inspection, precision)
            at = tuple(chunk.T)
            probability[at], accuracy[at] = estimates.probability, estimates.expected_accuracy
            low[at], high[at] = estimates.low, estimates.high
            advance(len(chunk))
    accepted = table["visible"].values & (probability >= inspection.requirement.probability)
    table = table.assign(probability=(over, probability), expected_accuracy=(over, accuracy), accepted=(over, accepted))
    table = table.assign(probability_low=(over, low), probability_high=(over, high))
    return table.assign_attrs(method="monte-carlo", precision=precision, confidence=CONFIDENCE)


def success_probability(
    start: ArrayLike,
    end: ArrayLike,
    camera: Camera,
    error: PoseError,
    relative_tolerance: ArrayLike,
    method: Method = "joint",
    *,
    precision: float = DEFAULT_PRECISION,
    seed: int = 0,
) -> NDArray[np.float64]:
    """Pr{|measured - nominal image length| <= T L} of segments (paper, eq. 20); arguments broadcast.

    Parameters
    ----------
    start, end
        ``(..., 3)`` mm, camera frame. A segment with an end behind the camera has probability 0.
    relative_tolerance
        T = 1 - required accuracy.
    method
        "joint", "independent", or "monte-carlo" (the exact camera).
    precision, seed
        With "monte-carlo": half-width of the 99 % confidence interval, and the seed of the draws.
    """
    if method != "monte-carlo":
        return first_order_probability(start, end, camera, error, relative_tolerance, method)
    require_precision(precision)
    tolerance = np.asarray(relative_tolerance, dtype=float)
    start, end = np.broadcast_arrays(np.asarray(start, dtype=float), np.asarray(end, dtype=float))
    shape = np.broadcast_shapes(start.shape[:-1], tolerance.shape)
    starts, ends = (np.broadcast_to(p, (*shape, 3)).reshape(-1, 3) for p in (start, end))
    seen = (starts[:, 2] > 0) & (ends[:, 2] > 0)
    result = np.zeros(len(starts))
    result[seen] = estimate_success_probabilities(
        starts[seen],
        ends[seen],
        camera,
        error,
        np.broadcast_to(tolerance, shape).ravel()[seen],
        precision=precision,
        confidence=CONFIDENCE,
        seed=seed,
    ).probability
    return result.reshape(shape)


def best_of_each(table: xr.Dataset) -> dict[str, dict[str, object]]:
    """For each dimension its surest setting, as plain data: setting, visible, reason, probability, accepted."""
    best: dict[str, dict[str, object]] = {}
    for j, name in enumerate(table["dimension"].values):
        column = table.isel(dimension=j)
        seen = np.where(column["visible"].values, column["probability"].values, -1.0)
        row = column.isel(setting=int(np.argmax(seen)))
        best[str(name)] = {
            "setting": str(row["setting"].item()),
            "visible": bool(row["visible"]),
            "reason": str(row["reason"].item()),
            "probability": float(row["probability"]),
            "expected_accuracy": float(row["expected_accuracy"]),
            "accepted": bool(row["accepted"]),
            "validity": str(row["validity"].item()),
        }
    return best
