"""Images of a part, sampled over the area of each pixel by Embree's ray caster.

A pixel's value is the mean over its square, estimated by N rays through a Fibonacci lattice: along either axis its
points lie 1/N apart, so that an edge along rows or columns is right to 1/N, and for an edge at any angle the error
falls faster than with random rays (Niederreiter, *Random Number Generation and Quasi-Monte Carlo Methods*, 1992, sec.
5.1). Where the centres of a pixel and of all around it meet the same brightness, one ray is enough: nothing smaller
than a pixel is looked for.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..exceptions import InputError
from ..sensors import Camera, Window

__all__ = ["FIBONACCI", "Renderer"]

FIBONACCI = (8, 13, 21, 34, 55, 89, 144, 233, 377, 610)
"""Numbers of rays a pixel: each with the one before makes a lattice."""

_RAYS_AT_ONCE = 2_000_000  # 56 MB
_AROUND = 1  # pixels
_BACKGROUND = 0.02
_DARKEST, _BRIGHTEST = 0.2, 0.85
_FINISH, _FINISH_PERIOD = 0.08, 0.3  # by how much parallel faces differ; of the part's size
_LIGHT = np.array([0.2, 0.55, 0.81])  # the direction that is brightest: faces along the axes differ by a tenth


class Renderer:
    """A part that is looked at.

    Faces are dull and lit evenly from one side: a face is the brighter the more it is turned to a fixed direction in
    the part's frame, and parallel faces differ a little by where they lie, as machined ones do: what lies side by side
    differs. No shadows, no gloss; the background is dark.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm, part frame, and ``(m, 3)`` indices, counter-clockwise seen from outside.
    rays_per_pixel
        One of :data:`FIBONACCI`.
    """

    def __init__(
        self, vertices: NDArray[np.float64], triangles: NDArray[np.int64], *, rays_per_pixel: int = 34
    ) -> None:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        if rays_per_pixel not in FIBONACCI:
            expected = "one of " + ", ".join(map(str, FIBONACCI))
            raise InputError("no lattice has so many points", key="rays", got=rays_per_pixel, expected=expected)
        corners = vertices[triangles]
        self._centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
        self._scene = EmbreeScene(robust=True)
        self._surface = TriangleMesh(self._scene, (corners - self._centre).astype(np.float32))
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
        turned = (1 + normal @ _LIGHT) / 2
        size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
        offset = np.einsum("mi,mi->m", normal, corners[:, 0] - self._centre)
        finish = _FINISH * np.sin(2 * np.pi * offset / (_FINISH_PERIOD * size))
        shade = np.clip(_DARKEST + (_BRIGHTEST - _DARKEST) * turned + finish, 0.0, 1.0)
        self._shade = np.append(shade, _BACKGROUND).astype(np.float32)
        self._offsets = _lattice(rays_per_pixel)

    def radiance(
        self, T_part_camera: NDArray[np.float64], camera: Camera, window: Window | None = None
    ) -> NDArray[np.float32]:
        """Mean brightness of each pixel, ``(rows, columns)``, 0 to 1."""
        return self._mean(T_part_camera, camera, window or Window.whole(camera), self._shade)

    def coverage(
        self, T_part_camera: NDArray[np.float64], camera: Camera, window: Window | None = None
    ) -> NDArray[np.float32]:
        """Share of each pixel that the part covers, ``(rows, columns)``."""
        covered = np.ones(len(self._shade), dtype=np.float32)
        covered[-1] = 0.0
        return self._mean(T_part_camera, camera, window or Window.whole(camera), covered)

    def _mean(
        self, T_part_camera: NDArray[np.float64], camera: Camera, window: Window, value: NDArray[np.float32]
    ) -> NDArray[np.float32]:
        """Of what a ray meets the value (the last is the background's), over each pixel."""
        from scipy.ndimage import maximum_filter, minimum_filter

        columns = np.arange(window.left - _AROUND, window.right + _AROUND)
        rows = np.arange(window.top - _AROUND, window.bottom + _AROUND)
        u, v = np.meshgrid(columns, rows)
        centres = np.stack([u.ravel(), v.ravel()], axis=1)
        once = self._cast(T_part_camera, camera, centres, np.zeros((1, 2)), value).reshape(u.shape)
        around = 2 * _AROUND + 1
        mixed = maximum_filter(once, around) != minimum_filter(once, around)
        inner = (slice(_AROUND, -_AROUND), slice(_AROUND, -_AROUND))
        result, mixed, u, v = once[inner].copy(), mixed[inner], u[inner], v[inner]
        result[mixed] = self._cast(T_part_camera, camera, np.stack([u[mixed], v[mixed]], axis=1), self._offsets, value)
        return result

    def _cast(
        self,
        T_part_camera: NDArray[np.float64],
        camera: Camera,
        pixels: NDArray[np.int64],
        offsets: NDArray[np.float64],
        value: NDArray[np.float32],
    ) -> NDArray[np.float32]:
        """``(n,)``: mean over rays through pixels ``(n, 2)`` at offsets ``(k, 2)`` px."""
        origin = (T_part_camera[:3, 3] - self._centre).astype(np.float32)
        rays, result = len(offsets), np.empty(len(pixels), dtype=np.float32)
        step = max(_RAYS_AT_ONCE // rays, 1)
        for first in range(0, len(pixels), step):
            some = pixels[first : first + step, None] + offsets
            image = camera.from_pixels(some) / camera.principal_distance_mm
            sight = np.concatenate([image, np.ones((*image.shape[:2], 1))], axis=-1).reshape(-1, 3)
            shown = np.isfinite(sight).all(axis=1)  # the lens may show nothing in corners, or just outside the image
            shown &= camera.is_used(some).reshape(-1)
            direction = (np.where(shown[:, None], sight, 1.0) @ T_part_camera[:3, :3].T).astype(np.float32)
            hit = self._scene.run(np.broadcast_to(origin, direction.shape).copy(), direction)
            hit = np.where(shown, hit, -1)
            result[first : first + step] = value[hit].reshape(-1, rays).mean(axis=1)  # -1, nothing, is the last
        return result


def _lattice(rays: int) -> NDArray[np.float64]:
    """``(rays, 2)`` px from the centre of a pixel."""
    k = np.arange(rays)
    step = (5, *FIBONACCI)[FIBONACCI.index(rays)]  # the Fibonacci number before
    return np.stack([(k + 0.5) / rays - 0.5, np.mod(k * step / rays + 0.5 / rays, 1.0) - 0.5], axis=1)
