"""Solids made of axis-parallel boxes, and an oracle in exact rational arithmetic of what they hide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import numpy as np

from viewgauge.part import Mesh

Box = tuple[tuple[int, int, int], tuple[int, int, int]]


@dataclass(frozen=True)
class BoxSolid:
    """A union of boxes with whole-number corners whose interiors overlap wherever the boxes join.

    Then its interior is the union of the open boxes, which is all that the oracle needs.
    """

    boxes: tuple[Box, ...]

    def occupied(self, cell: Sequence[int]) -> bool:
        """Whether the unit cell with this lowest corner is material."""
        return any(all(lo[k] <= cell[k] < hi[k] for k in range(3)) for lo, hi in self.boxes)

    def mesh(self, scale: float = 1.0, shift: Sequence[float] = (0.0, 0.0, 0.0)) -> Mesh:
        """Two triangles for every side of a cell between material and air, vertices shared."""
        size = max(max(hi) for _, hi in self.boxes)
        corners: dict[tuple[int, ...], int] = {}
        triangles = []
        for cell in product(range(size), repeat=3):
            if not self.occupied(cell):
                continue
            for axis, side in product(range(3), (0, 1)):
                beyond = list(cell)
                beyond[axis] += 2 * side - 1
                if self.occupied(beyond):
                    continue
                u, v = ((axis + 1) % 3, (axis + 2) % 3) if side else ((axis + 2) % 3, (axis + 1) % 3)
                quad = []
                for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    corner = list(cell)
                    corner[axis] += side
                    corner[u] += du
                    corner[v] += dv
                    quad.append(corners.setdefault(tuple(corner), len(corners)))
                triangles += [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]
        return Mesh(np.array(list(corners), dtype=float) * scale + shift, np.array(triangles))

    def normals(self, point: Sequence[Fraction | int]) -> list[tuple[int, int, int]]:
        """Outward normals of the faces that meet at a surface point, from the eight cells around it."""
        around = {
            octant: self.occupied([(p // 1 if p % 1 or s > 0 else p - 1) for p, s in zip(point, octant, strict=True)])
            for octant in product((-1, 1), repeat=3)
        }
        found = set()
        for octant, axis in product(around, range(3)):
            across = tuple(-s if k == axis else s for k, s in enumerate(octant))
            if around[octant] and not around[across]:
                found.add(tuple(-octant[k] if k == axis else 0 for k in range(3)))
        return sorted(found)

    def hides(self, point: Sequence[Fraction], eye: Sequence[Fraction], margin: Fraction = Fraction(0)) -> bool | None:
        """Whether the open segment from point to eye enters the interior; None within the margin of grazing.

        A verdict is within the margin if boxes shrunk by it would no longer hide, or if a box that does not touch
        the point would hide if it were grown by it.
        """
        if any(_enters(point, eye, box, Fraction(0)) for box in self.boxes):
            return True if any(_enters(point, eye, box, margin) for box in self.boxes) else None
        others = [box for box in self.boxes if not all(box[0][k] <= point[k] <= box[1][k] for k in range(3))]
        return None if any(_enters(point, eye, box, -margin) for box in others) else False


def _enters(p: Sequence[Fraction], q: Sequence[Fraction], box: Box, shrink: Fraction) -> bool:
    """Whether the open segment from p to q meets the open box, by exact clipping against its slabs."""
    first, last = Fraction(0), Fraction(1)
    for k in range(3):
        low, high = box[0][k] + shrink, box[1][k] - shrink
        step = q[k] - p[k]
        if step == 0:
            if not low < p[k] < high:
                return False
            continue
        a, b = sorted(((low - p[k]) / step, (high - p[k]) / step))
        first, last = max(first, a), min(last, b)
    return first < last


BOX = BoxSolid((((0, 0, 0), (1, 1, 1)),))
STEPPED = BoxSolid((((0, 0, 0), (4, 2, 1)), ((0, 0, 0), (3, 2, 2)), ((0, 0, 0), (1, 2, 3))))
SLOTTED = BoxSolid((((0, 0, 0), (4, 3, 1)), ((0, 0, 0), (1, 3, 3)), ((2, 0, 0), (4, 3, 3))))
POCKET = BoxSolid(
    (
        ((0, 0, 0), (4, 4, 1)),
        ((0, 0, 0), (1, 4, 3)),
        ((3, 0, 0), (4, 4, 3)),
        ((0, 0, 0), (4, 1, 3)),
        ((0, 3, 0), (4, 4, 3)),
    )
)


def edge_points(solid: BoxSolid, per_edge: int, rng: np.random.Generator) -> list[tuple[Fraction, ...]]:
    """Every corner of a solid, and points with dyadic coordinates on each unit piece of its edges."""
    size = max(max(hi) for _, hi in solid.boxes)
    points: list[tuple[Fraction, ...]] = []
    for corner in product(range(size + 1), repeat=3):
        base = tuple(Fraction(c) for c in corner)
        if len(solid.normals(base)) >= 2:
            points.append(base)
        for axis in range(3):
            inner = [base[k] + (Fraction(1, 2) if k == axis else 0) for k in range(3)]
            if len(solid.normals(inner)) >= 2:
                for numerator in rng.integers(1, 1 << 10, per_edge):
                    along = Fraction(int(numerator), 1 << 10)
                    points.append(tuple(base[k] + (along if k == axis else 0) for k in range(3)))
    return points
