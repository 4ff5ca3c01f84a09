"""Displacement error of a segment's image length: joint, or independent as in the paper (eq. 15-17)."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError
from .independent.independent_total import IndependentTotalError
from .independent.point_displacement import PointDisplacement
from .law import Law
from .total import TotalError

__all__ = ["IndependentDisplacement", "JointDisplacement", "SegmentDisplacement"]


class SegmentDisplacement(Law):
    """Law of a segment's image length error by displacement, mm; made by :meth:`joint` or :meth:`independent`.

    The error is that of the end points along the nominal image direction gamma (eq. 16)::

        eps_d = cos(gamma) (eps_u2 - eps_u1) + sin(gamma) (eps_v2 - eps_v1)

    Attributes
    ----------
    length_mm, angle_rad
        Nominal image length, mm, and direction gamma from +u, rad.
    start, end
        Laws of the two end points.
    """

    def __init__(self, start: PointDisplacement, end: PointDisplacement) -> None:
        self.start, self.end = start, end
        images = (p.focal_length_mm[..., None] * p.point_mm[..., :2] / p.point_mm[..., 2:] for p in (start, end))
        first, last = images
        delta = last - first
        self.length_mm = np.asarray(np.hypot(delta[..., 0], delta[..., 1]))
        self.angle_rad = np.asarray(np.arctan2(delta[..., 1], delta[..., 0]))

    @staticmethod
    def joint(
        start_mm: ArrayLike, end_mm: ArrayLike, focal_length_mm: ArrayLike, covariance: ArrayLike
    ) -> JointDisplacement:
        """Both ends move with the same pose error: normal with sigma² = J Sigma J^T (theory section 5).

        Parameters
        ----------
        start_mm, end_mm
            ``(..., 3)`` mm, camera frame, in front of the camera.
        focal_length_mm, covariance
            As in :class:`PointDisplacement`.
        """
        return JointDisplacement(*_ends(start_mm, end_mm, focal_length_mm, covariance))

    @staticmethod
    def independent(
        start_mm: ArrayLike, end_mm: ArrayLike, focal_length_mm: ArrayLike, covariance: ArrayLike
    ) -> IndependentDisplacement:
        """The four end-point errors taken as independent ratios of normals (eq. 15-17); arguments as :meth:`joint`.

        The paper's model: it overstates the spread by a factor of 13 to 25 in ordinary set-ups.
        """
        return IndependentDisplacement(*_ends(start_mm, end_mm, focal_length_mm, covariance))

    @abstractmethod
    def plus_quantization(self, pixel_pitch_mm: ArrayLike) -> TotalError | IndependentTotalError:
        """Law of the total error (eq. 18, 19) with a quantization step of one number, or ``(..., 2)``, mm."""


class JointDisplacement(SegmentDisplacement):
    """Normal law of the length error where both ends share the pose error."""

    def __init__(self, start: PointDisplacement, end: PointDisplacement) -> None:
        super().__init__(start, end)
        direction = np.stack([np.cos(self.angle_rad), np.sin(self.angle_rad)], axis=-1)
        J = np.einsum("...k,...kp->...p", direction, end.jacobian - start.jacobian)
        variance = np.einsum("...p,...pq,...q->...", J, start.covariance, J)
        self.sigma_mm = np.sqrt(np.maximum(variance, 0.0))
        self._law = TotalError(self.sigma_mm, 0.0, 0.0)

    def plus_quantization(self, pixel_pitch_mm: ArrayLike) -> TotalError:
        """Law of the total error (eq. 18, 19), in closed form."""
        return TotalError(self.sigma_mm, pixel_pitch_mm, self.angle_rad)

    def pdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """Density at x."""
        return self._law.pdf(x)

    def cdf(self, x: ArrayLike) -> NDArray[np.float64]:
        """P(error <= x)."""
        return self._law.cdf(x)

    def mean(self) -> NDArray[np.float64]:
        """Zero."""
        return self._law.mean()

    def var(self) -> NDArray[np.float64]:
        """J Sigma J^T."""
        return self._law.var()

    def support(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The whole line, or 0 where the length does not vary."""
        return self._law.support()

    def rvs(
        self, size: int | tuple[int, ...] | None = None, random_state: np.random.Generator | int | None = None
    ) -> NDArray[np.float64]:
        """Normal draws."""
        return self._law.rvs(size, random_state)

    def _quantile_bracket(self, q: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        return self._law._quantile_bracket(q)


class IndependentDisplacement(IndependentTotalError, SegmentDisplacement):  # noqa: N818 # a law, not an exception
    """The paper's law of the length error: four independent ratios of normals (eq. 15-17), without quantization."""

    def __init__(self, start: PointDisplacement, end: PointDisplacement) -> None:
        SegmentDisplacement.__init__(self, start, end)
        c, s = np.cos(self.angle_rad), np.sin(self.angle_rad)
        IndependentTotalError.__init__(self, (start.u, start.v, end.u, end.v), (-c, -s, c, s), 0.0, self.angle_rad)

    def plus_quantization(self, pixel_pitch_mm: ArrayLike) -> IndependentTotalError:
        """Law of the total error (eq. 18, 19)."""
        return IndependentTotalError(self.ratios, self.weights, pixel_pitch_mm, self.angle_rad)


def _ends(
    start_mm: ArrayLike, end_mm: ArrayLike, focal_length_mm: ArrayLike, covariance: ArrayLike
) -> tuple[PointDisplacement, PointDisplacement]:
    start, end = (PointDisplacement(p, focal_length_mm, covariance) for p in (start_mm, end_mm))
    if (start.point_mm[..., 2] < 0).any() or (end.point_mm[..., 2] < 0).any():
        raise InputError("a segment with an end behind the camera has no image", got=[start_mm, end_mm])
    return start, end
