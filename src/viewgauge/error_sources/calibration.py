"""What is not known of the camera's calibration: focal lengths, principal point, distortion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..geometry import Lens, PoseError
from ..geometry.lens import distort_each
from ..sensors import Camera
from .base import Component, DrawnView, ErrorSource, LinearTerms, SourceKind

__all__ = ["Calibration", "covariance_factor"]

_PINHOLE = Lens("radial-tangential", (0.0, 0.0, 0.0, 0.0))


class Calibration(ErrorSource):
    """The true intrinsics differ from the nominal ones by an error that all acquisitions share."""

    name = "calibration"
    kind = SourceKind.COMMON
    components = (Component("calibration", "calibration", "calibration"),)
    groups = ("camera",)

    def size(self, camera: Camera, pose_error: PoseError) -> float:  # noqa: ARG002
        """1, or 0 where the calibration is taken for exact: its parameters have different units."""
        return float(camera.intrinsics_covariance is not None)

    def scaled(self, camera: Camera, pose_error: PoseError, factor: float) -> tuple[Camera, PoseError]:
        """Standard deviations of all intrinsics multiplied; with 0 the calibration is exact."""
        if camera.intrinsics_covariance is None:
            return camera, pose_error
        rows = (np.array(camera.intrinsics_covariance) * factor**2).tolist()
        covariance = tuple(tuple(row) for row in rows) if factor > 0 else None
        return replace(camera, intrinsics_covariance=covariance), pose_error

    def standard_uncertainty(self, camera: Camera, pose_error: PoseError) -> NDArray[np.float64]:
        """``(1,)``: 1 or 0, as of its :meth:`size`."""
        return np.array([self.size(camera, pose_error)])

    def sensitivity(self, terms: LinearTerms, camera: Camera) -> NDArray[np.float64]:  # noqa: ARG002
        """``(..., 1)`` mm: one standard deviation of the effect of all intrinsics together."""
        if self.name not in terms.gradient:
            return np.zeros((*terms.pose.shape[:-1], 1))
        g, covariance = terms.gradient[self.name], terms.covariance[self.name]
        variance = np.einsum("...p,pq,...q->...", g, covariance, g)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))[..., None]

    def draw_width(self, camera: Camera) -> int:
        """One for each intrinsic parameter."""
        return 0 if camera.intrinsics_covariance is None else len(camera.intrinsics_covariance)

    def displaced(self, px: NDArray[np.float64], drawn: NDArray[np.float64], view: DrawnView) -> NDArray[np.float64]:  # noqa: ARG002
        """``px`` as they are: :meth:`shown` has put them where a camera of drawn intrinsics shows them."""
        return px

    def shown(
        self, images: NDArray[np.float64], drawn: NDArray[np.float64] | None, camera: Camera
    ) -> NDArray[np.float64]:
        """``(n, 2, 2)`` px in which a camera of drawn intrinsics shows ideal images ``(n, 2, 2)`` mm; None: the nominal
        ones.
        """
        lens = camera.lens or _PINHOLE
        n, pitch = len(images), np.asarray(camera.pixel_pitch_mm)
        focal = np.broadcast_to(camera.principal_distance_mm / pitch, (n, 2))  # px
        centre = np.broadcast_to(np.asarray(camera.principal_point), (n, 2))
        parameters = np.tile(lens.parameters, (n, 1))
        if drawn is not None:
            deviations = drawn @ covariance_factor(np.array(camera.intrinsics_covariance)).T
            focal, centre = focal + deviations[:, :2], centre + deviations[:, 2:4]
            parameters[:, 1 : 1 + deviations.shape[1] - 4] += deviations[:, 4:]
        px = np.empty_like(images)
        for end in range(2):
            px[:, end] = focal * distort_each(parameters, images[:, end] / camera.principal_distance_mm) + centre
        return px


def covariance_factor(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(n, n)``: what unit normals are multiplied by to have a covariance, whatever the units of each."""
    deviation = np.sqrt(covariance.diagonal())
    scale = np.where(deviation > 0, deviation, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(deviation[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))
