"""Whether the part hides a point from a camera, by Embree's ray caster."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from ..part import Mesh

__all__ = ["Occluder"]

_RAYS_PER_TASK = 65_536
# Embree computes in float32 (24 bits): points of a part centred at the origin are off by up to 3e-8 of its size.
_FLOAT32_MARGIN = 1e-5


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
        self._centre = (low + high) / 2
        diagonal = float(np.linalg.norm(high - low))
        self.clearance_mm = 2 * mesh.chord_error_mm + _FLOAT32_MARGIN * diagonal
        """How far off the surface a ray starts: twice the mesh's chord error plus 1e-5 of its diagonal, mm."""
        corners = (mesh.vertices - self._centre)[mesh.triangles].astype(np.float32)
        self._scene = EmbreeScene(robust=True)
        self._surface = TriangleMesh(self._scene, corners)
        self._cast(np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]), np.array([1e-3]))  # commits the scene

    def hidden(
        self, points: NDArray[np.float64], outward: NDArray[np.float64], eyes: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """Whether the surface lies between each point and each eye.

        Parameters
        ----------
        points
            ``(n, 3)`` mm, part frame, on the surface.
        outward
            ``(n, 3)`` unit vectors into free space at the points (zero to start at the point itself).
        eyes
            ``(n, 3)`` mm, part frame: the camera's centre of projection for each point.

        Returns
        -------
        ``(n,)``
        """
        origin = points + self.clearance_mm * outward
        to_eye = eyes - origin
        distance = np.linalg.norm(to_eye, axis=1)
        direction = to_eye / np.where(distance > 0, distance, 1.0)[:, None]
        blocks = [slice(k, k + _RAYS_PER_TASK) for k in range(0, len(points), _RAYS_PER_TASK)]

        def cast(block: slice) -> NDArray[np.bool_]:
            return self._cast(origin[block] - self._centre, direction[block], distance[block])

        if len(blocks) < 2:
            return cast(slice(None))
        with ThreadPoolExecutor(os.cpu_count()) as pool:  # embreex releases the GIL
            return np.concatenate(list(pool.map(cast, blocks)))

    def _cast(
        self, origin: NDArray[np.float64], direction: NDArray[np.float64], reach: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        hit = self._scene.run(
            origin.astype(np.float32), direction.astype(np.float32), dists=reach.astype(np.float32), query="OCCLUDED"
        )
        return np.asarray(hit) >= 0
