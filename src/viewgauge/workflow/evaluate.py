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
from ..simulation import estimate_success_probability, simulate_length_errors
from .inspection import ExplicitSettings, Inspection
from .progress import Progress, Silent

__all__ = ["Method", "best_of_each", "evaluate", "success_probability"]

Method = Literal["joint", "independent", "monte-carlo"]

DEFAULT_DRAWS = 100_000
_DRAWS_PER_BLOCK = 250_000  # bounds the memory of a block to about 100 MB


def evaluate(
    inspection: Inspection,
    settings: ExplicitSettings | str | PathLike[str] | ArrayLike | None = None,
    *,
    method: Method = "joint",
    draws: int = DEFAULT_DRAWS,
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
        exact camera by ``draws`` draws for each visible pair).

    Returns
    -------
    Dataset over (setting, dimension) with the columns ``visible, reason, image_length_px, angle_rad,
    relative_tolerance, sigma_displacement_px, sigma_quantization_px, probability, expected_accuracy, accepted``
    and ``gauge``, the index of the best gauge.
    """
    progress = progress or Silent()
    chosen = _settings(inspection, settings)
    dimensions, _ = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    if method not in ("joint", "independent", "monte-carlo"):
        raise InputError("unknown method", key="method", got=method, expected="joint, independent or monte-carlo")
    _require_draws(draws)
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
        table = _simulated(table, chosen.T_part_camera, dimensions, inspection, draws, progress)
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


def _require_draws(draws: int) -> None:
    if draws < 1:
        raise InputError("the number of draws must be at least 1", key="draws", got=draws)


def _simulated(
    table: xr.Dataset,
    T_part_camera: NDArray[np.float64],
    dimensions: tuple[Dimension, ...],
    inspection: Inspection,
    draws: int,
    progress: Progress,
) -> xr.Dataset:
    """The table with probability and expected accuracy of visible pairs drawn with the exact camera."""
    probability, accuracy = (table[name].values.copy() for name in ("probability", "expected_accuracy"))
    pairs = np.argwhere(table["visible"].values)
    camera = inspection.camera
    with progress.stage(f"Drawing {draws} times for {len(pairs)} pairs", len(pairs)) as advance:
        for pair, (k, j) in enumerate(pairs):
            gauge = dimensions[j].gauges[int(table["gauge"].values[k, j])]
            ends = transform(invert(T_part_camera[k]), np.stack([gauge.start, gauge.end]))
            # every pair has its own stream, so that a value does not depend on which other pairs there are
            rng = np.random.default_rng((inspection.seed, pair))
            length = float(np.linalg.norm(np.diff(camera.project(ends), axis=0)))
            allowed = table["relative_tolerance"].values[k, j] * length
            right, relative = 0, 0.0
            for done in range(0, draws, _DRAWS_PER_BLOCK):
                count = min(_DRAWS_PER_BLOCK, draws - done)
                errors = np.abs(simulate_length_errors(ends[0], ends[1], camera, inspection.head, count, rng))
                errors[np.isnan(errors)] = np.inf
                right += int((errors <= allowed).sum())
                relative += float(np.maximum(length - errors, 0.0).sum())
            probability[k, j] = right / draws
            accuracy[k, j] = relative / (draws * length) if length > 0 else 0.0
            advance(1)
    accepted = table["visible"].values & (probability >= inspection.requirement.probability)
    over = ("setting", "dimension")
    table = table.assign(probability=(over, probability), expected_accuracy=(over, accuracy), accepted=(over, accepted))
    return table.assign_attrs(method="monte-carlo", draws=draws)


def success_probability(
    start: ArrayLike,
    end: ArrayLike,
    camera: Camera,
    error: PoseError,
    relative_tolerance: ArrayLike,
    method: Method = "joint",
    *,
    draws: int = DEFAULT_DRAWS,
    rng: np.random.Generator | int | None = 0,
) -> NDArray[np.float64]:
    """Pr{|measured - nominal image length| <= T L} of segments (paper, eq. 20); arguments broadcast.

    Parameters
    ----------
    start, end
        ``(..., 3)`` mm, camera frame. A segment with an end behind the camera has probability 0.
    relative_tolerance
        T = 1 - required accuracy.
    method
        "joint", "independent", or "monte-carlo" (the exact camera, ``draws`` draws for each segment).
    """
    if method != "monte-carlo":
        return first_order_probability(start, end, camera, error, relative_tolerance, method)
    _require_draws(draws)
    generator = np.random.default_rng(rng)
    tolerance = np.asarray(relative_tolerance, dtype=float)
    start, end = np.broadcast_arrays(np.asarray(start, dtype=float), np.asarray(end, dtype=float))
    shape = np.broadcast_shapes(start.shape[:-1], tolerance.shape)
    starts, ends = (np.broadcast_to(p, (*shape, 3)).reshape(-1, 3) for p in (start, end))
    result = np.zeros(len(starts))
    for k, (p, q, t) in enumerate(zip(starts, ends, np.broadcast_to(tolerance, shape).ravel(), strict=True)):
        if p[2] > 0 and q[2] > 0:
            result[k] = estimate_success_probability(p, q, camera, error, t, draws=draws, rng=generator).probability
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
        }
    return best
