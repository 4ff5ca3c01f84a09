"""Occlusion: whether the part hides a measurand from a camera, by Embree's ray caster."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from ..geometry import VIEWS
from ..part import Mesh
from ..part.measurand_table import MeasurandTable

__all__ = ["Occluder", "SightLines"]

# Embree computes in float32 (24 bits): points of a part centred at the origin are off by up to 3e-8 of its size.
_FLOAT32_MARGIN = 1e-5

_WHOLE_SAMPLES = 33
"""Points of a segment that are tested where the whole of it must be seen, both ends among them."""

_START, _END, _BETWEEN = np.array([0.0]), np.array([1.0]), np.linspace(0.0, 1.0, _WHOLE_SAMPLES)[1:-1]

_RAYS_PER_CAST = 65_536
"""Bounds the memory of rays (28 bytes each)."""


class Occluder:
    """The part's surface as something that hides points.

    A point on an edge lies on the surface that may hide it. To ask about the part and not about rounding, the
    ray starts off the surface by :attr:`clearance_mm`, in the mean direction of the normals of the faces that
    meet there: into free space, at convex and concave edges alike.

    Parameters
    ----------
    mesh
        The part's surface, part frame, mm.
    """

    def __init__(self, mesh: Mesh) -> None:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        low, high = mesh.bounds
        self.centre_mm = (low + high) / 2
        """Origin of the frame in which rays are cast, part frame."""
        diagonal = float(np.linalg.norm(high - low))
        self.clearance_mm = 2 * mesh.chord_error_mm + _FLOAT32_MARGIN * diagonal
        """How far off the surface a ray starts: twice the mesh's chord error plus 1e-5 of its diagonal, mm."""
        corners = (mesh.vertices - self.centre_mm)[mesh.triangles].astype(np.float32)
        self._scene = EmbreeScene(robust=True)
        self._surface = TriangleMesh(self._scene, corners)
        # the first cast commits the scene, which is not for several threads at once
        self.blocked(*(np.array(v, dtype=np.float32) for v in ([[0, 0, 0]], [[0, 0, 1]], [1e-3])))

    def blocked(
        self, origin: NDArray[np.float32], direction: NDArray[np.float32], reach: NDArray[np.float32]
    ) -> NDArray[np.bool_]:
        """``(n,)``: whether rays ``(n, 3)``, mm from :attr:`centre_mm`, meet the surface within ``(n,)`` lengths.

        Other Python threads run meanwhile.
        """
        return np.asarray(self._scene.run(origin, direction, dists=reach, query="OCCLUDED")) >= 0


class SightLines:
    """Casts the rays from measurands to cameras.

    A measurand is hidden where the part hides an end, or any sample of it if the whole of it must be seen.
    """

    def __init__(self, measurands: MeasurandTable, occluder: Occluder) -> None:
        outward = measurands.normals.sum(axis=2)
        outward /= np.maximum(np.linalg.norm(outward, axis=-1, keepdims=True), np.finfo(float).tiny)
        # rays start here at the two ends, and between these for samples between the ends
        self._origins = np.ascontiguousarray(measurands.points + occluder.clearance_mm * outward - occluder.centre_mm)
        self._whole = measurands.whole
        self._occluder = occluder

    def hidden(
        self, views: NDArray[np.float64], viewpoint: NDArray[np.int64], measurand: NDArray[np.int64]
    ) -> NDArray[np.bool_]:
        """``(p,)``: whether the part hides the measurand from the viewpoint, for pairs of a block of viewpoints.

        Parameters
        ----------
        views
            From :func:`~viewgauge.geometry.view_block`.
        viewpoint, measurand
            ``(p,)``: indices into the block, and into the table of measurands.
        """
        viewpoint, measurand = np.ascontiguousarray(viewpoint), np.ascontiguousarray(measurand)
        hidden = self._any_blocked(views, viewpoint, measurand, _START)
        for fractions, asked in (
            (_END, np.ones(len(viewpoint), dtype=bool)),
            (_BETWEEN, self._whole[measurand]),
        ):
            left = np.flatnonzero(asked & ~hidden)
            if len(left):
                hidden[left] = self._any_blocked(views, viewpoint[left], measurand[left], fractions)
        return hidden

    def _any_blocked(
        self,
        views: NDArray[np.float64],
        viewpoint: NDArray[np.int64],
        measurand: NDArray[np.int64],
        fractions: NDArray[np.float64],
    ) -> NDArray[np.bool_]:
        blocked = np.zeros(len(viewpoint), dtype=bool)
        pairs = max(1, _RAYS_PER_CAST // len(fractions))
        for first in range(0, len(viewpoint), pairs):
            chunk = slice(first, first + pairs)
            n = len(viewpoint[chunk]) * len(fractions)
            rays = np.empty((n, 3), np.float32), np.empty((n, 3), np.float32), np.empty(n, np.float32)
            _rays(views, viewpoint[chunk], measurand[chunk], fractions, self._origins, self._occluder.centre_mm, *rays)
            blocked[chunk] = self._occluder.blocked(*rays).reshape(-1, len(fractions)).any(axis=1)
        return blocked


@numba.njit(
    "void(float64[::1], int64[::1], int64[::1], float64[::1], float64[:,:,::1], float64[::1], "
    "float32[:,::1], float32[:,::1], float32[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _rays(views, viewpoint, measurand, fractions, origins, centre, origin, direction, reach):  # type: ignore[no-untyped-def]
    """Rays from points of measurands to the viewpoints' centres of projection: origin, unit direction, length."""
    ray = 0
    for k in range(len(viewpoint)):
        s, g = viewpoint[k], measurand[k]
        ex, ey, ez = (
            views[12 * VIEWS + s] - centre[0],
            views[13 * VIEWS + s] - centre[1],
            views[14 * VIEWS + s] - centre[2],
        )
        for f in fractions:
            x = (1.0 - f) * origins[g, 0, 0] + f * origins[g, 1, 0]
            y = (1.0 - f) * origins[g, 0, 1] + f * origins[g, 1, 1]
            z = (1.0 - f) * origins[g, 0, 2] + f * origins[g, 1, 2]
            dx, dy, dz = ex - x, ey - y, ez - z
            distance = math.sqrt(dx * dx + dy * dy + dz * dz)
            scale = 1.0 / distance if distance > 0.0 else 1.0
            origin[ray, 0], origin[ray, 1], origin[ray, 2] = x, y, z
            direction[ray, 0], direction[ray, 1], direction[ray, 2] = dx * scale, dy * scale, dz * scale
            reach[ray] = distance
            ray += 1
