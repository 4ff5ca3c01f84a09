"""A measurand that the user gives by its two points, on a triangle mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...exceptions import InputError
from ..measurands import LengthBetweenPoints
from ..mesh import Mesh

__all__ = ["distance_to_triangles", "measurand_on_mesh", "missing_edge"]

_TOUCHING_CHORDS, _TOUCHING_RELATIVE = 2.0, 1e-6  # of the chord error, of the diagonal
_OUTSIDE_CHORDS, _OUTSIDE_RELATIVE = 5.0, 1e-3
_SAME_NORMAL = np.cos(np.deg2rad(1.0))


def measurand_on_mesh(
    mesh: Mesh, start: ArrayLike, end: ArrayLike, *, tolerance_mm: float | None = None
) -> LengthBetweenPoints:
    """The length between two points of a part; the adjoining faces are the triangles that touch each point.

    Where no triangle touches a point that is still near the surface, the nearest triangles count.

    Parameters
    ----------
    start, end
        ``(3,)`` mm, part frame.
    tolerance_mm
        Distance within which a triangle touches a point, mm; by default twice the mesh's chord error, at least
        1e-6 of the part's diagonal.

    Raises
    ------
    InputError
        If a point is not three finite numbers, if both are the same, or if one is farther from the surface than
        five chord errors and a thousandth of the part's diagonal.
    """
    diagonal = float(np.linalg.norm(np.ptp(mesh.bounds, axis=0)))
    if tolerance_mm is None:
        tolerance_mm = max(_TOUCHING_CHORDS * mesh.chord_error_mm, _TOUCHING_RELATIVE * diagonal)
    limit = max(_OUTSIDE_CHORDS * mesh.chord_error_mm, _OUTSIDE_RELATIVE * diagonal, tolerance_mm)
    points = [_finite_point(name, point) for name, point in (("start", start), ("end", end))]
    if np.linalg.norm(points[1] - points[0]) <= _TOUCHING_RELATIVE * diagonal:
        raise InputError(
            "the measurand has no length: its two points are the same",
            key="end",
            got=_coordinates(points[1]),
            expected="two different points of the part",
        )
    normals = [
        _touching_normals(mesh, name, point, tolerance_mm, limit)
        for name, point in zip(("start", "end"), points, strict=True)
    ]
    return LengthBetweenPoints(points[0], points[1], normals[0], normals[1], "given by its two points")


def missing_edge(measurand: LengthBetweenPoints) -> str:
    """Why an end of a measurand lies on no edge that an image shows; empty where both do.

    An edge is where faces of different directions meet. Within a flat face there is none, and neither is there at the
    border of an open surface: what borders on it is not known, such as the next cell of a printed board, or the walls
    that a scan left out.
    """
    ends = (("start", measurand.start, measurand.start_normals), ("end", measurand.end, measurand.end_normals))
    flat = [f"its {name} {_coordinates(point)}" for name, point, normals in ends if len(normals) < 2]
    if not flat:
        return ""
    verb = "lies" if len(flat) == 1 else "lie"
    where = "within a flat face, or on the border of an open surface"
    return f"there is no edge that an image shows: {' and '.join(flat)} {verb} {where}"


def distance_to_triangles(mesh: Mesh, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance, mm, from a point ``(3,)`` to each triangle, ``(m,)``; infinite for degenerate triangles.

    The distance to a triangle is that to its plane where the point projects into it, and that to the nearest of
    its three sides elsewhere.
    """
    corners = mesh.vertices[mesh.triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    normals = mesh.normals
    offset = point - corners
    inward = np.cross(normals[:, None, :], sides)
    inside = (np.einsum("mkj,mkj->mk", offset, inward) >= 0).all(axis=1)
    to_plane = np.abs(np.einsum("mj,mj->m", offset[:, 0], normals))
    squared = np.maximum(np.einsum("mkj,mkj->mk", sides, sides), np.finfo(float).tiny)
    t = np.clip(np.einsum("mkj,mkj->mk", offset, sides) / squared, 0.0, 1.0)
    to_sides = np.linalg.norm(offset - t[..., None] * sides, axis=2).min(axis=1)
    return np.where(normals.any(axis=1), np.where(inside, to_plane, to_sides), np.inf)


def _finite_point(name: str, given: ArrayLike) -> NDArray[np.float64]:
    try:
        point = np.array(given, dtype=float)
    except (TypeError, ValueError):
        point = np.full(3, np.nan)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise InputError(
            "a measurand's point must be three finite numbers", key=name, got=given, expected="[x, y, z] mm"
        )
    return point


def _touching_normals(
    mesh: Mesh, name: str, point: NDArray[np.float64], tolerance_mm: float, limit_mm: float
) -> NDArray[np.float64]:
    """Distinct outward normals ``(k, 3)`` of the triangles that touch a point."""
    apart = distance_to_triangles(mesh, point)
    nearest = float(apart.min())
    if not nearest <= limit_mm:
        raise InputError(
            f"characteristic outside the part: its {name} is {nearest:.4g} mm from the surface",
            key=name,
            got=_coordinates(point),
            expected=f"a point of the part's surface, within {limit_mm:.3g} mm",
            hint="coordinates are in the part's frame; check the unit of the part's file",
        )
    touching = mesh.normals[apart <= nearest + tolerance_mm]
    distinct: list[NDArray[np.float64]] = []
    for normal in touching:
        if all(float(normal @ other) < _SAME_NORMAL for other in distinct):
            distinct.append(normal)
    return np.array(distinct)


def _coordinates(point: NDArray[np.float64]) -> str:
    return "[" + ", ".join(f"{value:.6g}" for value in point) + "] mm"
