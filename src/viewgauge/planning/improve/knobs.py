"""What of a set-up can be changed, each by one factor: pixels, head, lens, distance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...geometry import PoseError
from ...sensors import Camera

__all__ = ["KNOBS", "MOVING", "SETTLED", "Knob", "Rig", "scaled_pose_error"]


@dataclass(frozen=True)
class Rig:
    """A camera on a head, and the range of distances, mm, from which it looks at the part."""

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


def scaled_pose_error(pose_error: PoseError, translation: float, rotation: float) -> PoseError:
    """The head with the standard deviations of its translation and of its rotation multiplied, common parts alike."""
    scale = np.diag([translation] * 3 + [rotation] * 3)
    common = pose_error.common_covariance
    return replace(
        pose_error,
        covariance=scale @ pose_error.covariance @ scale,
        pivot_mm=(0.0, 0.0, 0.0),  # T_camera_frame holds it
        common_covariance=None if common is None else scale @ common @ scale,
    )


def _deviation(pose_error: PoseError, first: int) -> float:
    """The largest standard deviation of three."""
    return float(np.sqrt(pose_error.covariance.diagonal()[first : first + 3].max()))


def _pixel(setup: Rig, factor: float) -> Rig:
    camera, edge_detector = setup.camera, setup.camera.edge_detector
    if edge_detector is None:
        return replace(setup, camera=replace(camera, edge_resolution_px=camera.edge_resolution_px * factor))
    edge_detector = replace(
        edge_detector, noise_px=edge_detector.noise_px * factor, bias_px=edge_detector.bias_px * factor
    )
    return replace(setup, camera=replace(camera, edge_detector=edge_detector))


def _edge_location(setup: Rig) -> float:
    edge_detector = setup.camera.edge_detector
    return (
        setup.camera.edge_resolution_px if edge_detector is None else max(edge_detector.noise_px, edge_detector.bias_px)
    )


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


SETTLED = (
    Knob(
        "pixel",
        "px",
        "quantization step of the edge detector, or its noise and offset (as well a pixel smaller by the factor on a "
        "sensor of the same size)",
        _edge_location,
        _pixel,
    ),
    Knob(
        "translation",
        "mm",
        "standard deviation of the head's translation (the largest of the three)",
        lambda setup: _deviation(setup.pose_error, 0),
        lambda setup, factor: replace(setup, pose_error=scaled_pose_error(setup.pose_error, factor, 1.0)),
    ),
    Knob(
        "rotation",
        "deg",
        "standard deviation of the head's rotation (the largest of the three)",
        lambda setup: float(np.degrees(_deviation(setup.pose_error, 3))),
        lambda setup, factor: replace(setup, pose_error=scaled_pose_error(setup.pose_error, 1.0, factor)),
    ),
    Knob(
        "pose_error",
        "of today",
        "translation and rotation of the head together",
        lambda setup: 1.0 if setup.pose_error.covariance.any() else 0.0,
        lambda setup, factor: replace(setup, pose_error=scaled_pose_error(setup.pose_error, factor, factor)),
    ),
)
"""Errors: viewpoints stay where they are, and less is always better."""

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
