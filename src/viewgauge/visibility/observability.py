"""Whether a gauge can be observed from a sensor setting, and if not, why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import Camera, invert, transform
from ..part.gauge_table import GaugeTable
from .limits import ObservationLimits
from .occlusion import Occluder

__all__ = ["REASONS", "Observation", "observe"]

REASONS = ("behind_camera", "out_of_view", "facing_away", "too_short", "out_of_focus", "occluded", "")
"""Names of the observability conditions in the order in which they are tested; the last, empty, is visible."""

_BEHIND, _OUT_OF_VIEW, _FACING_AWAY, _TOO_SHORT, _OUT_OF_FOCUS, _OCCLUDED, VISIBLE = range(len(REASONS))

_WHOLE_SAMPLES = 33
"""Points of a segment that are tested for occlusion where the whole of it must be seen."""


@dataclass(frozen=True)
class Observation:
    """How n settings see g gauges.

    Parameters
    ----------
    reason
        ``(n, g)`` index into :data:`REASONS`: the first condition that fails, or the last index where visible.
    points_camera
        ``(n, g, 2, 3)`` mm: start and end, camera frame.
    length_px
        ``(n, g)`` image length, px; NaN where an end is behind the camera.
    """

    reason: NDArray[np.int8]
    points_camera: NDArray[np.float64]
    length_px: NDArray[np.float64]

    @property
    def visible(self) -> NDArray[np.bool_]:
        """``(n, g)``: no condition fails."""
        return np.asarray(self.reason == VISIBLE)


def observe(
    T_part_camera: NDArray[np.float64],
    gauges: GaugeTable,
    camera: Camera,
    occluder: Occluder,
    limits: ObservationLimits,
) -> Observation:
    """Test every gauge from every setting.

    The conditions, in this order: both ends in front of the camera; both inside the image less a margin; at each
    end at least one adjoining face turned to the camera; image long enough; both ends in focus; not hidden by
    the part (both ends, or the whole segment where the dimension asks for it). Occlusion, the costly one, is
    last and only tested where nothing else fails.

    Parameters
    ----------
    T_part_camera
        ``(n, 4, 4)`` mm.
    """
    points = transform(invert(T_part_camera)[:, None, None], gauges.points)
    pixels = camera.to_pixels(camera.project(points))
    with np.errstate(invalid="ignore"):
        length_px = np.linalg.norm(pixels[..., 1, :] - pixels[..., 0, :], axis=-1)
        low, high = limits.margin_px - 0.5, np.asarray(camera.resolution) - 0.5 - limits.margin_px
        inside = ((pixels >= low) & (pixels <= high)).all(axis=(-1, -2))
        conditions = {
            _BEHIND: (points[..., 2] > 0).all(axis=-1),
            _OUT_OF_VIEW: inside,
            _FACING_AWAY: _facing(T_part_camera[:, :3, 3], gauges, limits.grazing_angle_rad),
            _TOO_SHORT: length_px >= limits.minimum_length_px,
            _OUT_OF_FOCUS: (camera.blur_px(points[..., 2]) <= camera.blur_limit_px).all(axis=-1),
        }
    reason = np.full(length_px.shape, VISIBLE, dtype=np.int8)
    for code in sorted(conditions, reverse=True):
        reason[~conditions[code]] = code
    setting, gauge = np.nonzero(reason == VISIBLE)
    hidden = _hidden(T_part_camera[:, :3, 3], setting, gauges, gauge, occluder)
    reason[setting[hidden], gauge[hidden]] = _OCCLUDED
    return Observation(reason, points, length_px)


def _facing(eyes: NDArray[np.float64], gauges: GaugeTable, grazing_angle_rad: float) -> NDArray[np.bool_]:
    """``(n, g)``: at both ends a face is turned to the eye ``(n, 3)`` by more than the grazing angle."""
    sight = eyes[:, None, None, :] - gauges.points
    sight = sight / np.maximum(np.linalg.norm(sight, axis=-1, keepdims=True), np.finfo(float).tiny)
    cosine = np.einsum("ngec,gekc->ngek", sight, gauges.normals)
    # a padded normal is zero and never faces, also with a grazing angle of zero
    return np.asarray((cosine > np.sin(grazing_angle_rad)).any(axis=-1).all(axis=-1))


def _hidden(
    eyes: NDArray[np.float64],
    setting: NDArray[np.int64],
    gauges: GaugeTable,
    gauge: NDArray[np.int64],
    occluder: Occluder,
) -> NDArray[np.bool_]:
    """For pairs (setting, gauge), both ``(p,)``: whether the part hides an end, or any sample of a whole segment."""
    outward = gauges.normals.sum(axis=2)
    outward /= np.maximum(np.linalg.norm(outward, axis=-1, keepdims=True), np.finfo(float).tiny)
    hidden = np.zeros(len(setting), dtype=bool)
    for fraction in np.linspace(0.0, 1.0, _WHOLE_SAMPLES):
        is_end = fraction in (0.0, 1.0)
        left = np.nonzero(~hidden & (is_end | gauges.whole[gauge]))[0]
        if len(left):
            weights = np.array([1 - fraction, fraction])[:, None]
            position = (gauges.points * weights).sum(axis=1)[gauge[left]]
            direction = (outward * weights).sum(axis=1)[gauge[left]]
            hidden[left] = occluder.hidden(position, direction, eyes[setting[left]])
    return hidden
