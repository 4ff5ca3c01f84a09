"""What is implausible in given viewpoints: they stand inside the part, or look away from it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ...findings import Finding
from ...part import Mesh
from ...sensors import Camera
from .usual_range import some_of

__all__ = ["inside_part", "viewpoint_findings"]

_MOST_CORNERS = 20_000_000  # viewpoints times triangles looked at
_MARGIN = 1.2  # how much larger than the image a part is looked for
_FARTHEST = 30  # diagonals of the part, from which it is seen in practice

Poses = NDArray[np.float64]


def viewpoint_findings(
    ids: Sequence[str], T_part_camera: Poses, mesh: Mesh, camera: Camera, points: NDArray[np.float64]
) -> Iterator[Finding]:
    """Every finding of given viewpoints.

    Parameters
    ----------
    ids, T_part_camera
        n names and poses ``(n, 4, 4)`` mm.
    points
        ``(m, 3)`` mm, part frame: of all measurands.
    """
    if not len(T_part_camera) or not len(points):
        return
    inside = inside_part(T_part_camera[:, :3, 3], mesh)
    sees = _sees(T_part_camera, camera, points)
    for name, chosen, found, refused in (
        ("viewpoint_inside_part", inside, "the camera is inside the part", True),
        ("viewpoint_looks_away", ~sees & ~inside, "no point of any characteristic is in the image", False),
    ):
        by_cause: dict[str, list[str]] = {}
        for k in np.flatnonzero(chosen):
            by_cause.setdefault(_cause(T_part_camera[k], mesh, camera, points), []).append(ids[int(k)])
        for cause, names in by_cause.items():
            if name == "viewpoint_looks_away" and not cause and len(names) < len(ids):
                continue  # candidates that happen to look beside the part do no harm
            yield Finding(name, f"{found} at {some_of(names)}", cause=cause, where="viewpoints", refused=refused)


def inside_part(centres: NDArray[np.float64], mesh: Mesh) -> NDArray[np.bool_]:
    """Which of n points ``(n, 3)`` mm are inside a closed mesh: where its triangles fill more than half the sphere.

    References
    ----------
    van Oosterom and Strackee, *IEEE Trans. Biomed. Eng.* 30 (1983) 125-126, (8).
    """
    low, high = mesh.bounds
    inside = ((centres > low) & (centres < high)).all(axis=1)
    some = np.flatnonzero(inside)[: max(_MOST_CORNERS // max(len(mesh.triangles), 1), 1)]
    for k in some:
        a, b, c = (mesh.vertices[mesh.triangles[:, j]] - centres[k] for j in range(3))
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c))
        rest = (
            la * lb * lc
            + np.einsum("ij,ij->i", a, b) * lc
            + np.einsum("ij,ij->i", a, c) * lb
            + np.einsum("ij,ij->i", b, c) * la
        )
        inside[k] = abs(2 * np.arctan2(volume, rest).sum()) > 2 * np.pi
    inside[np.setdiff1d(np.flatnonzero(inside), some)] = False
    return np.asarray(inside)


def _sees(T_part_camera: Poses, camera: Camera, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which viewpoints have any point in front of the camera and in its image, whatever hides it."""
    seen = np.zeros(len(T_part_camera), dtype=bool)
    limit = _MARGIN * np.array(camera.resolution) / 2 * np.array(camera.pixel_pitch_mm) / camera.focal_length_mm
    if camera.lens is not None:  # which shows more than a pinhole, or all that is in front
        limit *= 1.5 if camera.lens.model == "radial-tangential" else np.inf
    for k, T in enumerate(T_part_camera):
        local = (points - T[:3, 3]) @ T[:3, :3]
        front = local[:, 2] > 0
        with np.errstate(divide="ignore", invalid="ignore"):
            tangents = np.abs(local[:, :2] / local[:, 2:])
        seen[k] = bool((front & (tangents <= limit).all(axis=1)).any())
    return seen


def _cause(T: Poses, mesh: Mesh, camera: Camera, points: NDArray[np.float64]) -> str:
    """Under which other reading a viewpoint would see the part from outside; empty where under none."""
    for cause, read in _READINGS:
        other = read(T)
        if (
            not inside_part(other[None, :3, 3], mesh)[0]
            and _sees(other[None], camera, points)[0]
            and _usual_distance(other, mesh)
        ):
            return cause
    return ""


def _usual_distance(T: Poses, mesh: Mesh) -> bool:
    """Whether a camera stands at a usual distance: outside the part's box, and not where the part is a dot."""
    low, high = mesh.bounds
    beside = np.maximum(np.maximum(low - T[:3, 3], T[:3, 3] - high), 0)
    return bool(0 < np.linalg.norm(beside) < _FARTHEST * np.linalg.norm(high - low))


def _scaled(factor: float) -> Callable[[Poses], Poses]:
    def read(T: Poses) -> Poses:
        other = T.copy()
        other[:3, 3] *= factor
        return other

    return read


def _turned(turn: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Callable[[Poses], Poses]:
    def read(T: Poses) -> Poses:
        other = T.copy()
        other[:3, :3] = turn(T[:3, :3])
        return other

    return read


def _other_order(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rotation of a quaternion whose scalar comes last, where it was read as the first."""
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    return np.asarray(Rotation.from_quat([w, x, y, z]).as_matrix())  # SciPy takes the scalar last


_READINGS: tuple[tuple[str, Callable[[Poses], Poses]], ...] = (
    ("positions are in m", _scaled(1000.0)),
    ("positions are in cm", _scaled(10.0)),
    ("positions are in inches", _scaled(25.4)),
    ("the quaternion's scalar comes last (x y z w read as w x y z)", _turned(_other_order)),
    ("the pose is inverted: that of the part in the camera's frame", lambda T: np.asarray(np.linalg.inv(T))),
    (
        "the camera's axes are those of OpenGL: y up and z backwards",
        _turned(lambda rotation: rotation @ np.diag([1.0, -1.0, -1.0])),
    ),
    ("the rotation is transposed", _turned(lambda rotation: rotation.T)),
)
