"""The probability with which segments are measured accurately enough, by each of the methods."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..evaluation import success_probability as first_order_probability
from ..execution.chunks import CONFIDENCE, DEFAULT_PRECISION
from ..geometry import PoseError
from ..sensors import Camera

__all__ = ["Method", "success_probability"]

Method = Literal["joint", "independent", "monte-carlo"]
"""Both ends share the pose error; the paper's independent ends; the full camera model by Monte Carlo."""


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
        "joint", "independent", or "monte-carlo" (the full camera model).
    precision, seed
        With "monte-carlo": half-width of the 99 % confidence interval, and the seed of the draws.
    """
    if method != "monte-carlo":
        return first_order_probability(start, end, camera, error, relative_tolerance, method)
    from ..simulation import Sampling, estimate_success_probabilities, require_precision

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
        sampling=Sampling(precision=precision, confidence=CONFIDENCE, seed=seed),
    ).probability
    return result.reshape(shape)
