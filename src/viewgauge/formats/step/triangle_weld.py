"""Triangles of separate faces joined along the edges that the faces share."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["Weld", "signed_volume"]


class Weld:
    """Collects the triangles of faces; vertices with the same key are one vertex.

    Keys name topology (the k-th point of an edge), so no distance has to be guessed at which vertices merge.
    """

    def __init__(self) -> None:
        self._known: dict[Hashable, int] = {}
        self._vertices: list[tuple[float, float, float]] = []
        self._triangles: list[NDArray[np.int64]] = []

    def add(self, vertices: NDArray[np.float64], triangles: NDArray[np.int64], keys: Sequence[Hashable | None]) -> None:
        """Add a face.

        Parameters
        ----------
        vertices
            ``(n, 3)`` mm.
        triangles
            ``(m, 3)`` indices into ``vertices``.
        keys
            One a vertex; None where the vertex lies inside the face and is shared with nothing.
        """
        index = np.empty(len(vertices), dtype=np.int64)
        for k, (point, key) in enumerate(zip(vertices.tolist(), keys, strict=True)):
            number = len(self._vertices) if key is None else self._known.setdefault(key, len(self._vertices))
            if number == len(self._vertices):
                self._vertices.append(tuple(point))
            index[k] = number
        self._triangles.append(index[triangles])

    def triangles(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Vertices ``(n, 3)`` and triangles ``(m, 3)``, without those that have collapsed."""
        vertices = np.array(self._vertices, dtype=np.float64).reshape(-1, 3)
        triangles = np.concatenate([np.empty((0, 3), dtype=np.int64), *self._triangles])
        a, b, c = triangles.T
        return vertices, triangles[(a != b) & (b != c) & (c != a)]


def signed_volume(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> float:
    """Enclosed volume, mm^3: sum of a . (b x c) / 6; negative where the triangles face inwards."""
    a, b, c = (vertices[triangles[:, k]] - vertices.mean(axis=0) for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)
