"""What of a set-up can be changed, each by one factor: pixels, head, lens, distance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...geometry import PoseError
from ...sensors import Camera

__all__ = ["KNOBS", "MOVING", "SETTLED", "Knob", "SetUp", "scaled_head"]


@dataclass(frozen=True)
class SetUp:
    """A camera on a head, and the range of distances, mm, from which it looks at the part."""

    camera: Camera
    head: PoseError
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
    today: Callable[[SetUp], float]
    turned: Callable[[SetUp, float], SetUp]


def scaled_head(head: PoseError, translation: float, rotation: float) -> PoseError:
    """The head with the standard deviations of its translation and of its rotation multiplied, common parts alike."""
    scale = np.diag([translation] * 3 + [rotation] * 3)
    common = head.common_covariance
    return replace(
        head,
        covariance=scale @ head.covariance @ scale,
        pivot_mm=(0.0, 0.0, 0.0),  # T_camera_head holds it
        common_covariance=None if common is None else scale @ common @ scale,
    )


def _deviation(head: PoseError, first: int) -> float:
    """The largest standard deviation of three."""
    return float(np.sqrt(head.covariance.diagonal()[first : first + 3].max()))


def _pixel(setup: SetUp, factor: float) -> SetUp:
    camera, locator = setup.camera, setup.camera.locator
    if locator is None:
        return replace(setup, camera=replace(camera, edge_resolution_px=camera.edge_resolution_px * factor))
    locator = replace(locator, noise_px=locator.noise_px * factor, bias_px=locator.bias_px * factor)
    return replace(setup, camera=replace(camera, locator=locator))


def _edge_location(setup: SetUp) -> float:
    locator = setup.camera.locator
    return setup.camera.edge_resolution_px if locator is None else max(locator.noise_px, locator.bias_px)


def _focal_length(setup: SetUp, factor: float) -> SetUp:
    """Distances go with it: the part stays as large in the image; so does the distance in focus."""
    camera, (near, far) = setup.camera, setup.distance_mm
    focus = camera.focus_distance_mm
    camera = replace(
        camera,
        focal_length_mm=camera.focal_length_mm * factor,
        focus_distance_mm=None if focus is None else focus * factor,
    )
    return replace(setup, camera=camera, distance_mm=(near * factor, far * factor))


def _distance(setup: SetUp, factor: float) -> SetUp:
    """One distance: the farthest of today's times the factor."""
    distance = setup.distance_mm[1] * factor
    return replace(setup, distance_mm=(distance, distance))


SETTLED = (
    Knob(
        "pixel",
        "px",
        "quantization step of the edge locator, or its noise and offset (as well a pixel smaller by the factor on a "
        "sensor of the same size)",
        _edge_location,
        _pixel,
    ),
    Knob(
        "translation",
        "mm",
        "standard deviation of the head's translation (the largest of the three)",
        lambda setup: _deviation(setup.head, 0),
        lambda setup, factor: replace(setup, head=scaled_head(setup.head, factor, 1.0)),
    ),
    Knob(
        "rotation",
        "deg",
        "standard deviation of the head's rotation (the largest of the three)",
        lambda setup: float(np.degrees(_deviation(setup.head, 3))),
        lambda setup, factor: replace(setup, head=scaled_head(setup.head, 1.0, factor)),
    ),
    Knob(
        "head",
        "of today",
        "translation and rotation of the head together",
        lambda setup: 1.0 if setup.head.covariance.any() else 0.0,
        lambda setup, factor: replace(setup, head=scaled_head(setup.head, factor, factor)),
    ),
)
"""Errors: settings stay where they are, and less is always better."""

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
"""Settings move, and more or less may be better."""

KNOBS = {knob.name: knob for knob in (*SETTLED, *MOVING)}
