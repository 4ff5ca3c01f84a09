"""Errors of a camera that is more than the paper's, drawn: each source of error says how it is drawn.

Only geometry and the sources are shared with the prediction; of the sources none of their linear laws.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..error_sources import DrawnView, ErrorSource, SourceKind, sources_of
from ..error_sources.registry import CALIBRATION
from ..sensors import Camera

__all__ = ["CameraDraws", "drawn_view", "measured_images"]


@dataclass(frozen=True)
class CameraDraws:
    """n draws of a camera's errors.

    Parameters
    ----------
    by_source
        By the name of each source that has errors ``(n, ...)`` of its own units: steps, or unit normals.
    """

    by_source: Mapping[str, NDArray[np.float64]]

    @staticmethod
    def width(camera: Camera) -> int:
        """How many uniform numbers make a draw."""
        return sum(source.draw_width(camera) for source in sources_of(camera))

    @classmethod
    def of(cls, camera: Camera, uniform: NDArray[np.float64]) -> CameraDraws:
        """Draws from uniform numbers ``(n, width)`` between 0 and 1, neither included."""
        place, found = 0, {}
        for source in _drawing(camera):
            width = source.draw_width(camera)
            found[source.name] = source.drawn(uniform[:, place : place + width])
            place += width
        return cls(found)

    def with_common(self, other: CameraDraws, camera: Camera) -> CameraDraws:
        """These, with what is common to all acquisitions from another draw of the same camera."""
        common = {s.name: other.by_source[s.name] for s in _drawing(camera) if s.kind is SourceKind.COMMON}
        return CameraDraws({**self.by_source, **common})


def _drawing(camera: Camera) -> list[ErrorSource]:
    """The sources of a camera that draw something by themselves."""
    return [source for source in sources_of(camera) if source.draw_width(camera)]


def drawn_view(points: NDArray[np.float64], camera: Camera, rim_axis: NDArray[np.float64] | None = None) -> DrawnView:
    """A segment ``(2, 3)`` mm, camera frame, made ready for the draws of a camera's errors.

    Parameters
    ----------
    rim_axis
        ``(3,)``, camera frame: axis of the whole rim of which it is a diameter; None or zeros for two ends that are
        located each by itself.
    """
    view = DrawnView(camera, points, camera.project(points), rim_axis)
    return replace(view, prepared={source.name: source.prepared(view) for source in _drawing(camera)})


def measured_images(images: NDArray[np.float64], view: DrawnView, draws: CameraDraws) -> NDArray[np.float64]:
    """``(n, 2, 2)`` mm: where, by its calibration, a camera has seen the ends whose ideal images are ``(n, 2, 2)`` mm.

    The true camera, of drawn intrinsics, puts them in its pixels; there they are located with an error; and the nominal
    camera says from where that is seen.
    """
    px = CALIBRATION.shown(images, draws.by_source.get(CALIBRATION.name), view.camera)
    for source in _drawing(view.camera):
        px = source.displaced(px, draws.by_source[source.name], view)
    return view.camera.from_pixels(px)
