"""The full camera model to a stated precision, by randomised quasi-Monte Carlo.

The uniforms behind the errors are R independently scrambled Sobol sequences in place of random numbers: each
scramble's mean is an unbiased estimate, far less spread than that of as many random draws, and the R means, being
independent, tell how far they spread (Owen, *Ann. Statist.* 25 (1997) 1541; L'Ecuyer and Lemieux 2002). The sequences
are doubled until the interval is as narrow as asked.

Ten numbers make one draw: six of the pose error and four of quantization. Only differences of the four enter, one
along u and one along v, and the difference of two uniforms is one triangular number: eight numbers are drawn,
less those without variance. The normals are turned by an orthogonal matrix, which changes no law, so that the first of
them is the direction in which the image length changes most: the success of a draw is then almost a function of the
three best spread coordinates of the sequence.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri, stdtrit

from ..exceptions import InputError
from ..geometry import PoseError
from ..sensors import Camera
from .camera_draws import CameraDraws, drawn_view
from .full_camera import (
    Estimate,
    camera_length_errors,
    displacements,
    exact_length_errors,
    nominal_length,
    require_points,
)

__all__ = ["FullModelEstimates", "Sampling", "estimate_success_probabilities"]

SCRAMBLES = 16
_FIRST_POINTS = 256  # of each scramble
_POINTS_PER_BLOCK = 512  # of each scramble: blocks that stay in the processor's cache
_SOBOL_BITS = 30
_FEW = 50  # rarer outcomes than this over all scrambles: their spread is not to be trusted


@dataclass(frozen=True)
class Sampling:
    """How many draws are made for a segment.

    Parameters
    ----------
    precision
        Largest half-width of the confidence intervals.
    confidence
        Of the intervals.
    max_draws
        Most draws for one segment; the interval tells what they attained.
    seed
        Of the scrambles.

    Raises
    ------
    InputError
        If one is out of its range.
    """

    precision: float = 1e-3
    confidence: float = 0.99
    max_draws: int = 2**22
    seed: int = 0

    def __post_init__(self) -> None:
        require_precision(self.precision)
        if not 0 < self.confidence < 1:
            raise InputError("must lie between 0 and 1", key="confidence", got=self.confidence)
        least = SCRAMBLES * _FIRST_POINTS
        if self.max_draws < least:
            raise InputError("too few", key="max_draws", got=self.max_draws, expected=f"at least {least}")


@dataclass(frozen=True)
class FullModelEstimates:
    """Probabilities of n segments with the full camera model, and their confidence intervals.

    Attributes
    ----------
    probability, low, high
        ``(n,)``. Where ``draws`` has reached its limit, the interval may be wider than asked.
    expected_accuracy
        ``(n,)``: E max(1 - |error| / L, 0); 0 for a segment without image length.
    draws
        ``(n,)``: camera evaluations made.
    """

    probability: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    expected_accuracy: NDArray[np.float64]
    draws: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.probability)

    def __getitem__(self, k: int) -> Estimate:
        return Estimate(float(self.probability[k]), float(self.low[k]), float(self.high[k]), int(self.draws[k]))

    @property
    def half_width(self) -> NDArray[np.float64]:
        """``(n,)``: the attained precision, the larger of the interval's two sides."""
        return np.maximum(self.probability - self.low, self.high - self.probability)


def estimate_success_probabilities(
    start: ArrayLike,
    end: ArrayLike,
    camera: Camera,
    error: PoseError,
    relative_tolerance: ArrayLike,
    sampling: Sampling | None = None,
    rim_axis: ArrayLike | None = None,
) -> FullModelEstimates:
    """Pr{|measured - nominal| <= T L} of n segments, each with as many draws as the precision needs.

    All segments see the same draws; the result of one does not depend on which others there are.

    Parameters
    ----------
    start, end
        ``(n, 3)`` mm, camera frame, in front of the camera.
    relative_tolerance
        T, one or ``(n,)``.
    sampling
        How many draws are made; by default :class:`Sampling` as it is.
    rim_axis
        ``(n, 3)``, camera frame: axes of whole rims of which segments are diameters; zeros for the others.

    Raises
    ------
    InputError
        For a point that cannot be imaged, or an argument out of its range.
    """
    points = require_points(start, end).reshape(-1, 2, 3)
    tolerance = np.broadcast_to(np.asarray(relative_tolerance, dtype=float), len(points))
    if not (np.isfinite(tolerance) & (tolerance >= 0)).all():
        raise InputError("must be finite and not negative", key="relative_tolerance", got=relative_tolerance)
    sampling = sampling or Sampling()
    axes = np.zeros((len(points), 3)) if rim_axis is None else np.broadcast_to(rim_axis, (len(points), 3))
    segments = [
        _Segment(ends, float(t), camera, error, axis) for ends, t, axis in zip(points, tolerance, axes, strict=True)
    ]
    rank, width = twist_axes(error).shape[1], _camera_width(camera)
    if rank == 0 and width == 0:
        return _without_error(segments)
    _refine(segments, rank, width, sampling)
    return FullModelEstimates(
        np.array([s.probability for s in segments]),
        np.array([s.low for s in segments]),
        np.array([s.high for s in segments]),
        np.array([s.expected_accuracy for s in segments]),
        np.array([s.draws for s in segments], dtype=np.int64),
    )


def _refine(segments: list[_Segment], rank: int, width: int, sampling: Sampling) -> None:
    """Draw for each segment until its interval is as narrow as the precision, or the limit is reached."""
    active = segments
    for points_each, normals, of_camera in _draws(rank, width, sampling.max_draws // SCRAMBLES, sampling.seed):
        for segment in active:
            segment.add(normals, of_camera)
        if points_each & (points_each - 1) == 0:  # a full power of two: the sequences are balanced
            for segment in active:
                segment.conclude(sampling.confidence)
            active = [s for s in active if max(s.probability - s.low, s.high - s.probability) > sampling.precision]
        if not active:
            break


def require_precision(precision: float) -> None:
    """Raise InputError unless a half-width of an interval of probabilities can be so large."""
    if not 0 < precision < 0.5:
        raise InputError("must lie between 0 and 0.5", key="precision", got=precision)


def twist_axes(error: PoseError) -> NDArray[np.float64]:
    """The factor of the covariance without the directions that have no variance: ``(6, rank)``, mm and rad."""
    factor = error.factor
    deviations = np.sqrt(error.covariance.diagonal())
    share = np.divide(factor, deviations[:, None], out=np.zeros_like(factor), where=deviations[:, None] > 0)
    return factor[:, np.abs(share).max(axis=0) > 1e-7]  # the root of what eigenvalues are rounded to


def _camera_width(camera: Camera) -> int:
    """How many numbers make a draw of the camera's errors: of a plain camera two, the differences of quantization."""
    return 2 * (max(camera.quantization_step_mm) > 0) if camera.is_plain else CameraDraws.width(camera)


def _draws(
    rank: int, camera_width: int, limit: int, seed: int
) -> Iterator[tuple[int, NDArray[np.float64], NDArray[np.float64]]]:
    """Points of each scramble so far, and of the next, scramble by scramble, normals and the camera's uniforms."""
    from scipy.stats import qmc  # late: slow to import, and the first-order prediction does without

    width = rank + camera_width
    engines = [
        qmc.Sobol(width, scramble=True, bits=_SOBOL_BITS, seed=np.random.default_rng((seed, r)))
        for r in range(SCRAMBLES)
    ]
    # the camera's errors come after the steepest direction and before the others, which matter least
    split = np.arange(width)
    of_camera = split[min(1, rank) :][:camera_width]
    of_pose = np.setdiff1d(split, of_camera)
    done, end = 0, 2 ** (limit.bit_length() - 1)
    while done < end:
        count = min(max(done, _FIRST_POINTS), _POINTS_PER_BLOCK, end - done)
        # the middle of each cell: never 0, where a normal would be infinite
        uniform = np.concatenate([engine.random(count) for engine in engines]) + 0.5 ** (_SOBOL_BITS + 1)
        yield done + count, ndtri(uniform[:, of_pose]), uniform[:, of_camera]
        done += count


def _without_error(segments: list[_Segment]) -> FullModelEstimates:
    one = np.ones(len(segments))
    accuracy = np.array([float(s.length_mm > 0) for s in segments])
    return FullModelEstimates(one, one, one, accuracy, np.zeros(len(segments), dtype=np.int64))


class _Segment:
    """What the draws so far say about one segment."""

    def __init__(
        self,
        points: NDArray[np.float64],
        tolerance: float,
        camera: Camera,
        error: PoseError,
        rim_axis: NDArray[np.float64],
    ) -> None:
        self.points, self.camera, self.error = points, camera, error
        self.length_mm = nominal_length(points, camera)
        self.allowed_mm = tolerance * self.length_mm
        self.axes = _steepest_first(points, camera, error)
        self.view = None if camera.is_plain else drawn_view(points, camera, rim_axis)
        self.right = np.zeros(SCRAMBLES)
        self.relative = 0.0
        self.draws = 0
        self.probability, self.low, self.high = 0.5, 0.0, 1.0

    def add(self, normals: NDArray[np.float64], of_camera: NDArray[np.float64]) -> None:
        """Count the successes of ``(n, rank)`` normals and the camera's uniforms ``(n, width)``."""
        errors = np.abs(self._errors(normals @ self.axes.T, of_camera))
        errors[np.isnan(errors)] = np.inf
        self.right += (errors <= self.allowed_mm).reshape(SCRAMBLES, -1).sum(axis=1)
        self.relative += float(np.maximum(self.length_mm - errors, 0.0).sum())
        self.draws += len(errors)

    def _errors(self, twist: NDArray[np.float64], of_camera: NDArray[np.float64]) -> NDArray[np.float64]:
        if self.view is None:
            steps = _triangular(of_camera) if of_camera.size else np.zeros((len(twist), 2))
            return exact_length_errors(self.points, self.camera, self.error, twist, steps)
        draws = CameraDraws.of(self.camera, of_camera)
        return camera_length_errors(self.view, self.error, displacements(twist), draws)

    @property
    def expected_accuracy(self) -> float:
        """E max(1 - |error| / L, 0)."""
        return self.relative / (self.draws * self.length_mm) if self.length_mm > 0 else 0.0

    def conclude(self, confidence: float) -> None:
        """Probability and interval: of Student's t over the scrambles, and not narrower than what may lie unseen.

        The t-interval is blind to a set that no scramble has met: near p = 0 and 1 all means are equal. A set of
        measure delta is missed by n draws with probability (1 - delta)^n at most, were they independent, and by
        equally spread ones less often; so delta < -ln(tail) / n, the rule of three, is added to both sides. Where
        the rarer outcome was met fewer than 50 times its counts are too few for t, and the exact binomial interval
        (that of n independent draws, wider than the truth) is included.
        """
        tail = (1 - confidence) / 2
        means = self.right * SCRAMBLES / self.draws
        successes = int(self.right.sum())
        self.probability = successes / self.draws
        spread = float(stdtrit(SCRAMBLES - 1, 1 - tail) * means.std(ddof=1) / np.sqrt(SCRAMBLES))
        half = spread - np.log(tail) / self.draws
        self.low, self.high = max(0.0, self.probability - half), min(1.0, self.probability + half)
        if min(successes, self.draws - successes) < _FEW:
            binomial = Estimate.of(successes, self.draws, confidence)
            self.low, self.high = min(self.low, binomial.low), max(self.high, binomial.high)


def _triangular(uniform: NDArray[np.float64]) -> NDArray[np.float64]:
    """Difference of two uniforms of unit width, by the inverse of its cdf."""
    return np.where(uniform < 0.5, np.sqrt(2 * uniform) - 1, 1 - np.sqrt(2 - 2 * uniform))


def _steepest_first(points: NDArray[np.float64], camera: Camera, error: PoseError) -> NDArray[np.float64]:
    """The axes of the pose error turned so that the length changes along the first, and there only, at first order.

    Any orthogonal turn gives the same law; this one (a Householder reflection) is found from differences of the
    full camera model itself over a tenth of a standard deviation.
    """
    axes = twist_axes(error)
    rank = axes.shape[1]
    steps = np.concatenate([0.1 * axes.T, -0.1 * axes.T])
    errors = exact_length_errors(points, camera, error, steps, np.zeros((2 * rank, 2)))
    gradient = errors[:rank] - errors[rank:]
    size = np.linalg.norm(gradient)
    if not np.isfinite(size) or size == 0:
        return axes
    mirror = gradient / size
    mirror[0] += np.copysign(1.0, mirror[0])
    return np.asarray(axes - np.outer(axes @ mirror, mirror) * (2 / (mirror @ mirror)))
