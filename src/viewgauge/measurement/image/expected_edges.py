"""What is looked for at the ends of a measurand: the edges in which the faces there meet."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import transform
from ...sensors import Camera

__all__ = ["CLEAR_OF_CORNER_PX", "HALF_PX", "EdgeDirection", "ExpectedMeasurand", "image_directions"]

HALF_PX, CLEAR_OF_CORNER_PX = 9.0, 5.0
"""Of an edge that is fitted: half its length, and how far from a corner it begins."""

_THROUGH = np.arange(-HALF_PX, HALF_PX + 1)
_AFTER_CORNER = np.arange(CLEAR_OF_CORNER_PX, 2 * HALF_PX + 1)
_AT_CORNER = (_AFTER_CORNER, -_AFTER_CORNER)
_ON_EDGE = (_THROUGH, *_AT_CORNER)  # on one side alone, where a corner or another edge is near


@dataclass(frozen=True)
class ExpectedMeasurand:
    """A measurand as it is looked for in an image, part frame.

    Parameters
    ----------
    points
        ``(2, 3)`` mm.
    normals
        Normals ``(k, 3)`` of the faces that meet at each end.
    bent
        Its edges are curves, such as the rim of a hole.
    rim_axis
        ``(3,)``: normal of the circle of which it is a diameter, where the whole rim is seen; None for any other.
    trusted
        The edges to look for at each end, by direction and place along it; None for all
        (:func:`~viewgauge.measurement.image.measurand_image.rehearsed`).
    """

    points: NDArray[np.float64]
    normals: tuple[NDArray[np.float64], NDArray[np.float64]]
    bent: bool = False
    rim_axis: NDArray[np.float64] | None = None
    trusted: tuple[frozenset[tuple[int, int]], frozenset[tuple[int, int]]] | None = None

    def directions(self, k: int, T_camera_part: NDArray[np.float64], camera: Camera) -> list[EdgeDirection]:
        """The edges to look for at end k, in the image from a pose."""
        point = transform(T_camera_part, self.points[k])
        found = image_directions(point, T_camera_part[:3, :3], self.normals[k], camera)
        if self.trusted is None:
            return found
        kept = [tuple(s for j, s in enumerate(d.spans) if (i, j) in self.trusted[k]) for i, d in enumerate(found)]
        return [replace(d, spans=spans) for d, spans in zip(found, kept, strict=True) if spans]


def image_directions(
    point: NDArray[np.float64], R_camera_part: NDArray[np.float64], normals: NDArray[np.float64], camera: Camera
) -> list[EdgeDirection]:
    """The edges in which the faces at a point meet, two and two, as directions in the image.

    Where only two faces meet the edge goes through the point. At a corner it is on one side alone: of a convex corner
    on that side from which the other faces fall away, which is tried first.
    """
    found = []
    turned = normals @ R_camera_part.T
    for i, j in itertools.combinations(range(len(turned)), 2):
        edge = np.cross(turned[i], turned[j])
        if np.linalg.norm(edge) < 1e-6:
            continue
        others = [float(edge @ turned[k]) for k in range(len(turned)) if k not in (i, j)]
        leaning = next((value for value in others if abs(value) > 1e-6), 0.0)
        edge *= -np.sign(leaning) if leaning else 1.0
        step = 1e-3 * edge / np.linalg.norm(edge)
        image = camera.to_pixels(camera.project(np.stack([point - step, point + step])))
        run = image[1] - image[0]
        if np.linalg.norm(run) > 0:
            spans = _AT_CORNER if leaning else _ON_EDGE
            found.append(EdgeDirection(run / np.linalg.norm(run), spans, through=not leaning))
    return found


@dataclass(frozen=True)
class EdgeDirection:
    """The direction of an edge in the image from the point at which it is expected.

    Parameters
    ----------
    unit
        ``(2,)``.
    spans
        Where along it to look, px, in this order.
    through
        The edge goes on to both sides of the point.
    """

    unit: NDArray[np.float64]
    spans: tuple[NDArray[np.float64], ...]
    through: bool
