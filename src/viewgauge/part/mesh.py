"""The triangle mesh that hides what lies behind it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Mesh"]


@dataclass(frozen=True)
class Mesh:
    """Triangles, counter-clockwise seen from outside.

    Parameters
    ----------
    vertices
        ``(n, 3)`` mm, part frame.
    triangles
        ``(m, 3)`` vertex indices.
    chord_error_mm
        Largest distance between the mesh and the true surface, mm (0 for a mesh that is the part).
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    chord_error_mm: float = 0.0

    @property
    def normals(self) -> NDArray[np.float64]:
        """Outward unit normals of the triangles, ``(m, 3)``; zero for a degenerate triangle."""
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        cross = np.cross(b - a, c - a)
        length = np.linalg.norm(cross, axis=1, keepdims=True)
        return np.asarray(np.divide(cross, length, out=np.zeros_like(cross), where=length > 0))

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner, ``(2, 3)`` mm."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])
