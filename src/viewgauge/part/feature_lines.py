"""The part's edges as polylines, for pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .brep import Brep
from .mesh import Mesh

__all__ = ["brep_feature_lines", "mesh_feature_lines"]


def brep_feature_lines(brep: Brep) -> tuple[NDArray[np.float64], ...]:
    """Polylines ``(n, 3)`` mm of the edges that show as a crease: no seams, no tangent faces."""
    return tuple(edge.points for edge in brep.edges if not (edge.seam or edge.smooth))


def mesh_feature_lines(mesh: Mesh, angle_deg: float = 20.0) -> tuple[NDArray[np.float64], ...]:
    """Segments ``(2, 3)`` mm where triangles meet at more than an angle, or where the mesh ends.

    Triangles are neighbours where their corners have the same coordinates, whether or not they share vertices
    (an STL file repeats them).

    Parameters
    ----------
    angle_deg
        Smallest angle between the normals of adjoining triangles that counts as an edge, degrees.
    """
    normals = mesh.normals
    proper = normals.any(axis=1)
    places, same = np.unique(mesh.vertices + 0.0, axis=0, return_inverse=True)
    corners = same.reshape(-1)[mesh.triangles[proper]]
    sides = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    ends, side, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(side.reshape(-1), kind="stable")
    owners = np.repeat(normals[proper], 3, axis=0)[order]
    starts = np.cumsum(count) - count
    cosines = np.sum(owners * np.repeat(owners[starts], count, axis=0), axis=1)
    flattest = np.minimum.reduceat(cosines, starts) if len(starts) else np.zeros(0)
    return tuple(places[ends[(flattest < np.cos(np.deg2rad(angle_deg))) | (count == 1)]])
