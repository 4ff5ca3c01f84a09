"""What of a set-up can be changed, each by one factor: errors, lens, distance.

Which errors a knob turns, and how, the sources of error say themselves (:mod:`viewgauge.error_sources`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from ...error_sources import ERROR_SOURCES, LengthError, sources_of
from ...geometry import PoseError
from ...sensors import Camera

__all__ = ["KNOBS", "MOVING", "OF_TODAY", "SETTLED", "Knob", "Rig", "knob_named", "settled_knobs"]

OF_TODAY = "of today"
"""Unit of a knob that shows a factor."""


@dataclass(frozen=True)
class Rig:
    """A camera, the uncertainty of its pose, and the range of distances, mm, from which it looks at the part."""

    camera: Camera
    pose_error: PoseError
    distance_mm: tuple[float, float]


@dataclass(frozen=True)
class Knob:
    """One thing that can be changed.

    Parameters
    ----------
    name, unit, what
        The unit is that of ``today``'s value.
    today
        Its value in a set-up; 0 where there is nothing to change.
    turned
        The set-up with this multiplied by a factor.
    """

    name: str
    unit: str
    what: str
    today: Callable[[Rig], float]
    turned: Callable[[Rig, float], Rig]


def _focal_length(setup: Rig, factor: float) -> Rig:
    """Distances go with it: the part stays as large in the image; so does the distance in focus."""
    camera, (near, far) = setup.camera, setup.distance_mm
    focus = camera.focus_distance_mm
    camera = replace(
        camera,
        focal_length_mm=camera.focal_length_mm * factor,
        focus_distance_mm=None if focus is None else focus * factor,
    )
    return replace(setup, camera=camera, distance_mm=(near * factor, far * factor))


def _distance(setup: Rig, factor: float) -> Rig:
    """One distance: the farthest of today's times the factor."""
    distance = setup.distance_mm[1] * factor
    return replace(setup, distance_mm=(distance, distance))


def _of_sources(name: str, unit: str, what: str) -> Knob:
    """A knob that multiplies every source of error which names it; it shows the largest of them."""
    turning = [source for source in ERROR_SOURCES if name in source.knobs]

    def today(rig: Rig) -> float:
        largest = max(source.size(rig.camera, rig.pose_error) for source in turning)
        return float(largest > 0) if unit == OF_TODAY else largest

    def turned(rig: Rig, factor: float) -> Rig:
        camera, pose_error = rig.camera, rig.pose_error
        for source in turning:
            camera, pose_error = source.scaled(camera, pose_error, factor)
        return replace(rig, camera=camera, pose_error=pose_error)

    return Knob(name, unit, what, today, turned)


def _of_further_error(name: str) -> Knob:
    """The knob of a further error of the camera, which it multiplies."""

    def named(rig: Rig) -> LengthError | None:
        return next((e for e in sources_of(rig.camera) if isinstance(e, LengthError) and e.name == name), None)

    def today(rig: Rig) -> float:
        return float(named(rig) is not None)

    def turned(rig: Rig, factor: float) -> Rig:
        error = named(rig)
        if error is None:
            return rig
        camera, pose_error = error.scaled(rig.camera, rig.pose_error, factor)
        return replace(rig, camera=camera, pose_error=pose_error)

    return Knob(name, OF_TODAY, name.replace("_", " "), today, turned)


SETTLED = (
    _of_sources(
        "pixel",
        "px",
        "quantization step of the edge detector, or its noise and offset (as well a pixel smaller by the factor on a "
        "sensor of the same size)",
    ),
    _of_sources("translation", "mm", "standard deviation of the camera's position (the largest of the three)"),
    _of_sources("rotation", "deg", "standard deviation of the camera's orientation (the largest of the three)"),
    _of_sources("pose_error", OF_TODAY, "translation and rotation of the camera's pose together"),
)
"""Errors that every camera can have: viewpoints stay where they are, and less is always better."""

MOVING = (
    Knob(
        "focal_length",
        "mm",
        "focal length, with distances (and the distance in focus) that keep the part as large in the image",
        lambda setup: setup.camera.focal_length_mm,
        _focal_length,
    ),
    Knob(
        "distance",
        "mm",
        "distance from which the camera looks at the part",
        lambda setup: setup.distance_mm[1],
        _distance,
    ),
)
"""Viewpoints move, and more or less may be better."""

KNOBS = {knob.name: knob for knob in (*SETTLED, *MOVING)}
"""By name, without those of a camera's further errors (:func:`knob_named`)."""


def settled_knobs(camera: Camera) -> tuple[Knob, ...]:
    """The knobs of a camera's errors: :data:`SETTLED`, and one for each of its further errors."""
    return (*SETTLED, *(_of_further_error(error.name) for error in camera.further_errors))


def knob_named(name: str) -> Knob:
    """The knob of a name; that of a further error of the camera, where it is none of :data:`KNOBS`."""
    return KNOBS.get(name) or _of_further_error(name)
