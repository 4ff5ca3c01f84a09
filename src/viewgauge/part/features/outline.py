"""The part's visible edges and the surface normals at points of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..brep import Brep, Edge
from ..measurands import LengthBetweenPoints
from .coincidence import position_tolerance_mm

__all__ = ["Outline", "distinct_directions"]

_SAME_DIRECTION = 1 - 1e-6  # cosine: normals closer than 1.4 mrad are one


def distinct_directions(normals: NDArray[np.float64], cosine: float = _SAME_DIRECTION) -> NDArray[np.float64]:
    """The unit vectors ``(n, 3)`` without repetition, ``(k, 3)``, in the order of their first appearance."""
    kept: list[NDArray[np.float64]] = []
    for normal in normals:
        if normal.any() and all(float(normal @ other) < cosine for other in kept):
            kept.append(normal)
    return np.array(kept).reshape(-1, 3)


@dataclass(frozen=True)
class Outline:
    """A B-rep with what the measurand algorithms ask of its edges."""

    brep: Brep

    @cached_property
    def tolerance_mm(self) -> float:
        """Position tolerance of the part, mm."""
        return position_tolerance_mm(self.brep)

    def is_visible(self, edge: int) -> bool:
        """Whether the edge shows as a crease: no seam, no tangent faces."""
        return not (self.brep.edges[edge].seam or self.brep.edges[edge].smooth)

    def visible_edges(self, face: int) -> tuple[int, ...]:
        """Indices of the face's visible edges, each once."""
        return tuple(edge for edge in dict.fromkeys(self.brep.faces[face].edges) if self.is_visible(edge))

    def normals_at(self, edge: int, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Outward unit normals ``(k, 3)`` of the faces adjoining the edge, at a point ``(3,)`` of it.

        At an end of the edge, also those of the other faces that meet there.
        """
        ordered = [edge, *(other for other in self.edges_ending_at(point) if other != edge)]
        return distinct_directions(np.concatenate([_interpolated_normals(self.brep.edges[i], point) for i in ordered]))

    def is_concave(self, edge: int) -> bool:
        """Whether the edge is an inner corner: one of its faces lies in front of the plane of the other.

        False also where the faces lie on both sides of each other's planes, or neither is flat.
        """
        faces = self.brep.edges[edge].faces
        return any(self._in_front(faces[1 - k], faces[k]) for k in range(len(faces)) if len(faces) == 2)

    def _in_front(self, face: int, flat: int) -> bool:
        """Whether a face lies wholly in front of the plane of another."""
        plane = self.brep.faces[flat]
        if plane.kind != "plane" or face == flat:
            return False
        heights = [(self.brep.edges[edge].points - plane.origin) @ plane.axis for edge in self.brep.faces[face].edges]
        lowest, highest = min(h.min() for h in heights), max(h.max() for h in heights)
        return bool(lowest >= -self.tolerance_mm and highest > self.tolerance_mm)

    def edges_ending_at(self, point: NDArray[np.float64]) -> list[int]:
        """Indices of the open edges that have an end at the point ``(3,)`` mm."""
        end_points, owner = self._ends
        return sorted({int(owner[i]) for i in end_points.query_ball_point(point, self.tolerance_mm)})

    def measurand(
        self, start_edge: int, start: NDArray[np.float64], end_edge: int, end: NDArray[np.float64]
    ) -> LengthBetweenPoints:
        """The length between a point of one edge and a point of another (or the same)."""
        source = f"edge {start_edge}" if start_edge == end_edge else f"edges {start_edge} and {end_edge}"
        normals = (self.normals_at(start_edge, start), self.normals_at(end_edge, end))
        return LengthBetweenPoints(start, end, normals[0], normals[1], source)

    def overlapping(
        self, first: tuple[int, ...], second: tuple[int, ...], shift: NDArray[np.float64]
    ) -> list[tuple[int, int]]:
        """Pairs of edges whose boxes overlap, coming from the first set and, moved by ``-shift``, from the second.

        A quick test before looking at the curves themselves: a box misses a curve's bulge by the chord error.
        """
        a, b = self._boxes[list(first)], self._boxes[list(second)] - shift
        margin = self.tolerance_mm + self.brep.mesh.chord_error_mm
        meet = (a[:, None, 0] <= b[None, :, 1] + margin) & (b[None, :, 0] <= a[:, None, 1] + margin)
        rows, columns = np.nonzero(meet.all(axis=2))
        return [(first[i], second[j]) for i, j in zip(rows.tolist(), columns.tolist(), strict=True)]

    @cached_property
    def _boxes(self) -> NDArray[np.float64]:
        """Lowest and highest corner of each edge's points, ``(n, 2, 3)`` mm."""
        return np.array([(edge.points.min(axis=0), edge.points.max(axis=0)) for edge in self.brep.edges])

    @cached_property
    def _ends(self) -> tuple[cKDTree, NDArray[np.int64]]:
        """End points of the open edges, and the edge of each."""
        open_edges = [i for i, edge in enumerate(self.brep.edges) if not edge.closed]
        ends = np.array([self.brep.edges[i].points[[0, -1]] for i in open_edges]).reshape(-1, 3)
        return cKDTree(ends), np.repeat(np.array(open_edges, dtype=np.int64), 2)


def _interpolated_normals(edge: Edge, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normals ``(len(faces), 3)`` at the place of the edge's polyline that is nearest to the point."""
    start, along = edge.points[:-1], np.diff(edge.points, axis=0)
    squared = np.maximum(np.einsum("ij,ij->i", along, along), np.finfo(float).tiny)
    t = np.clip(np.einsum("ij,ij->i", point - start, along) / squared, 0.0, 1.0)
    nearest = int(np.argmin(np.linalg.norm(start + t[:, None] * along - point, axis=1)))
    normals = (1 - t[nearest]) * edge.normals[nearest] + t[nearest] * edge.normals[nearest + 1]
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.where(length > 0, length, 1.0))
