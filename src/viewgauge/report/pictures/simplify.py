"""A coarser mesh for the picture.

Vertices are merged cell by cell, which reaches any limit and moves no vertex farther than a cell's diagonal. Collapsing
edges by quadric error metrics (fast-simplification 0.2) was tried: on the long thin triangles of tessellated CAD faces
it missed a sixth of the triangles by a quarter, and a housing's round bosses became spikes 2 % of its size away.
"""

from __future__ import annotations

import numpy as np

from ...part.mesh import Mesh

__all__ = ["picture_mesh"]


def _merged(mesh: Mesh, cell_mm: float) -> Mesh:
    """The mesh with all vertices of one grid cell moved to their mean; collapsed triangles are dropped."""
    cells = np.floor((mesh.vertices - mesh.bounds[0]) / cell_mm).astype(np.int64)
    _, owner, count = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    owner = owner.reshape(-1)
    means = np.stack([np.bincount(owner, mesh.vertices[:, k]) for k in range(3)], axis=1) / count[:, None]
    triangles = owner[mesh.triangles]
    a, b, c = triangles.T
    return Mesh(means, triangles[(a != b) & (b != c) & (c != a)], mesh.chord_error_mm + cell_mm)


def picture_mesh(mesh: Mesh, limit: int) -> Mesh:
    """The mesh itself, or one of at most ``limit`` triangles by vertex clustering.

    References
    ----------
    Rossignac and Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993.
    """
    coarse = mesh
    cell_mm = float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0])) / 1000 if len(mesh.triangles) else 0.0
    while len(coarse.triangles) > limit:
        coarse = _merged(mesh, cell_mm)
        cell_mm *= 1.3
    return coarse
