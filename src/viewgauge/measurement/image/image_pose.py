"""The pose from which an image was taken, by the edges of all measurands that are seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ...geometry import PoseError, invert, point_jacobian, transform
from ...sensors import Camera
from .edges import EdgeFinder
from .expected_edges import ExpectedMeasurand, image_directions

__all__ = ["AGREE_PX", "FURTHER_PX", "ImagePose", "find_image_pose", "reach_px"]

AGREE_PX, FURTHER_PX = 1.5, 2.0
"""How far from where the image's pose has them edges may be that agree, and how much further they are looked for."""

_FEWEST_EDGES, _FEWEST_AGREE = 6, 0.4
_SCALES = (80.0, 40.0, 20.0, 10.0, 5.0, 3.0, 3.0, 3.0, 3.0, 3.0)
_SIGMAS = 4.0  # of the displacement of an end that an edge is looked for within


@dataclass(frozen=True)
class ImagePose:
    """The pose from which an image was taken, about as well as its edges tell.

    Parameters
    ----------
    reach_px
        How far off edges may still be.
    covariance
        ``(6, 6)`` of the pose, as a displacement of the scene in the camera frame, mm and rad.
    """

    T_part_camera: NDArray[np.float64]
    reach_px: float
    covariance: NDArray[np.float64]


def find_image_pose(
    finder: EdgeFinder,
    measurands: Sequence[ExpectedMeasurand],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
) -> ImagePose | None:
    """The pose from which an image was taken, by all edges at the ends of measurands; None where they do not agree.

    It is the pose error of the greatest posterior density for the normal law of the pose error and edges that are off
    by their noise or are others altogether (Cauchy). Of a part that shows too few edges to tell whether they agree, it
    is the pose by those that are found, looked for once more from there.
    """
    if not measurands:
        return None
    points = [transform(invert(T_part_camera), point) for measurand in measurands for point in measurand.points]
    reaches = [reach_px(point, camera, error.camera_covariance) for point in points]
    found = _edges_near(finder, measurands, T_part_camera, camera, error, reaches)
    looked_for = sum(
        len(image_directions(point, T_part_camera[:3, :3].T, normals, camera))
        for point, normals in zip(points, [n for measurand in measurands for n in measurand.normals], strict=True)
    )
    to_camera = error.adjoint @ error.factor
    if looked_for >= 2 * _FEWEST_EDGES:
        if len(found.offset) < _FEWEST_EDGES:
            return None
        twist, posterior = _pose_of(found, error)
        left = np.abs(found.offset - found.rows @ twist)
        agree = left < AGREE_PX
        if agree.sum() < max(_FEWEST_EDGES, _FEWEST_AGREE * len(left)):
            return None
        reach = float(3 * np.median(left[agree]) + FURTHER_PX)
    else:
        twist, posterior = _pose_of(found, error)
        spread = to_camera @ posterior @ to_camera.T
        nearer = [reach_px(point, camera, spread) for point in points]
        again = _edges_near(finder, measurands, _moved(T_part_camera, twist, error), camera, error, nearer)
        twist, posterior = _pose_of(replace(again, offset=again.offset + again.rows @ twist), error)
        spread = to_camera @ posterior @ to_camera.T
        reach = max(reach_px(point, camera, spread) for point in points)
    return ImagePose(_moved(T_part_camera, twist, error), reach, to_camera @ posterior @ to_camera.T)


@dataclass(frozen=True)
class _Found:
    """n edges: how far off they are, px ``(n,)``, with variance, and by how much for each unit of pose ``(n, 6)``."""

    offset: NDArray[np.float64]
    variance: NDArray[np.float64]
    rows: NDArray[np.float64]


def _edges_near(
    finder: EdgeFinder,
    measurands: Sequence[ExpectedMeasurand],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    error: PoseError,
    reaches: Sequence[float],
) -> _Found:
    """Edges at the ends of measurands, looked for within the reach of each end of where a pose has them."""
    T_camera_part = invert(T_part_camera)
    offsets, variances, rows = [], [], []
    ends = [(measurand, k) for measurand in measurands for k in range(2)]
    for (measurand, k), reach in zip(ends, reaches, strict=True):
        point = transform(T_camera_part, measurand.points[k])
        place = camera.to_pixels(camera.project(point))
        J = _point_jacobian_px(point, camera) @ error.adjoint
        for along in measurand.directions(k, T_camera_part, camera):
            for span in along.spans:
                edge = finder.edge(place, along.unit, span, reach, measurand.bent)
                if edge is not None:
                    middle = (span[0] + span[-1]) / 2
                    a, b, c = edge.coefficients
                    offsets.append(a + b * middle + c * middle**2)
                    variances.append(edge.variance_at(place + middle * along.unit))
                    rows.append(edge.across @ J)
                    if along.through:
                        break
    return _Found(np.array(offsets), np.array(variances), np.array(rows).reshape(-1, 6))


def _pose_of(found: _Found, error: PoseError) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The pose error ``(6,)``, pose error frame, and its covariance ``(6, 6)`` in units of the pose error's factor."""
    A, y, variance, factor = found.rows, found.offset, found.variance, error.factor
    scaled, twist = A @ factor, np.zeros(6)
    posterior: NDArray[np.float64] = np.eye(6, dtype=np.float64)
    for scale in _SCALES:  # of standard deviations, from which on an edge counts as another
        weight = 1 / (variance * (1 + (y - A @ twist) ** 2 / (scale**2 * variance)))
        posterior = np.asarray(np.linalg.inv(scaled.T @ (weight[:, None] * scaled) + np.eye(6)))
        twist = factor @ (posterior @ (scaled.T @ (weight * y)))
    return twist, posterior


def _moved(T_part_camera: NDArray[np.float64], twist: NDArray[np.float64], error: PoseError) -> NDArray[np.float64]:
    """``T_part_camera`` of a camera that stands off by a pose error."""
    displacement = np.eye(4)
    displacement[:3, :3], displacement[:3, 3] = Rotation.from_rotvec(twist[3:]).as_matrix(), twist[:3]
    assert error.T_camera_frame is not None  # set by PoseError
    seen = error.T_camera_frame @ displacement @ invert(error.T_camera_frame) @ invert(T_part_camera)
    return np.asarray(invert(seen))


def _point_jacobian_px(point: NDArray[np.float64], camera: Camera) -> NDArray[np.float64]:
    """``(2, 6)`` px of a displacement of a point in the camera frame."""
    return np.asarray(
        camera.pixel_jacobian(camera.project(point)) @ point_jacobian(point, camera.principal_distance_mm)
    )


def reach_px(point: NDArray[np.float64], camera: Camera, covariance: NDArray[np.float64]) -> float:
    """How far an end may be from where it is expected, for a covariance ``(6, 6)`` of the pose, camera frame."""
    J = _point_jacobian_px(point, camera)
    spread = J @ covariance @ J.T
    return float(_SIGMAS * np.sqrt(np.linalg.eigvalsh(spread)[-1]) + FURTHER_PX)
