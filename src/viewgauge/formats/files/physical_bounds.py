"""Between which values each quantity of the inspection file can lie at all, in one table.

Beyond these bounds a value is an error, because nothing physical has it and arithmetic with it means nothing. What is
merely unusual is a finding (:mod:`viewgauge.planning.plausibility`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel

from .problems import KeyPath, Problems

__all__ = ["BOUNDS", "Bounds", "bounds_of", "within_bounds"]


@dataclass(frozen=True)
class Bounds:
    """The least and the greatest magnitude of a quantity in its unit (mm, rad, px or none); 0 is always allowed.

    ``reason`` completes "... is ...", in the words of a person.
    """

    least: float
    most: float
    unit: str
    reason: str


_LENS = "no lens has it"
_EDGE = "no edge of an image is so wide"
_POSE = "a camera whose pose is known no better measures nothing"

BOUNDS: dict[str, Bounds] = {
    "camera.focal_length": Bounds(0.01, 1e5, "mm", _LENS),
    "camera.focus_distance": Bounds(0.01, 1e9, "mm", _LENS),
    "camera.f_number": Bounds(0.01, 1e4, "", _LENS),
    "camera.pixel_pitch": Bounds(1e-5, 10, "mm", "no sensor has such pixels"),
    "camera.principal_point": Bounds(0, 1e7, "px", "no image is so large"),
    "camera.blur_limit": Bounds(1e-6, 1e5, "px", "no image is so large"),
    "camera.distortion": Bounds(0, 1e6, "", _LENS),
    "camera.calibration_uncertainty": Bounds(0, 1e6, "px", "no calibration is so uncertain"),
    "camera.edge_detector": Bounds(1e-9, 1e4, "px", _EDGE),
    "camera.edge_detector.signal_to_noise": Bounds(1e-3, 1e7, "", "no image has such a signal"),
    "pose_uncertainty.translation": Bounds(1e-12, 1e4, "mm", _POSE),
    "pose_uncertainty.rotation": Bounds(1e-15, math.pi / 2, "rad", _POSE),
    "pose_uncertainty.common.translation": Bounds(1e-12, 1e4, "mm", _POSE),
    "pose_uncertainty.common.rotation": Bounds(1e-15, math.pi / 2, "rad", _POSE),
    "pose_uncertainty.frame.position": Bounds(0, 1e5, "mm", "no flange is so far from its camera"),
    "pose_uncertainty.frame.quaternion": Bounds(0, 2, "", "a unit quaternion has no such component"),
    "part.general_tolerance": Bounds(1e-9, 1e5, "mm", "no drawing has such a tolerance"),
    "part.characteristics.tolerance": Bounds(1e-9, 1e5, "mm", "no drawing has such a tolerance"),
    "part.characteristics.points": Bounds(0, 1e7, "mm", "no part is so large"),
    "requirement": Bounds(1e-12, 1e6, "", "nothing is measured so"),
    "requirement.error": Bounds(1e-9, 1e5, "mm", "no length is measured so"),
    "observation": Bounds(0, 1e7, "px", "no image is so large"),
    "observation.grazing_angle": Bounds(
        0, math.pi / 2, "rad", "a line of sight makes an angle of 0 to 90 deg with a face"
    ),
    "candidates": Bounds(0, 1e7, "mm", "no camera is so far from its part"),
    "candidates.distance": Bounds(1e-3, 1e7, "mm", "no camera is so far from its part, or so near"),
    "candidates.cone.axis": Bounds(0, 1e9, "", "a direction needs no such numbers"),
    "candidates.cone.half_angle": Bounds(1e-9, math.pi, "rad", "a cone's half angle is at most 180 deg"),
}
"""By the dotted key, without the numbers of list entries; a section's bounds are those of all keys below that have none
of their own."""


def bounds_of(path: KeyPath) -> Bounds | None:
    """The bounds of a key: its own, or those of the nearest section above."""
    names = [str(step) for step in path if not isinstance(step, int)]
    for length in range(len(names), 0, -1):
        found = BOUNDS.get(".".join(names[:length]))
        if found is not None:
            return found
    return None


def within_bounds(section: BaseModel, path: KeyPath, problems: Problems) -> bool:
    """Whether every quantity of a section is within its bounds; those that are not go to ``problems``."""
    right = True
    for name in type(section).model_fields:
        value, bounds = getattr(section, name), bounds_of((*path, name))
        magnitudes = _magnitudes(value)
        if bounds is None or not magnitudes:
            continue
        # what is no number at all is judged by what the section builds
        wrong = [x for x in magnitudes if x != 0 and math.isfinite(x) and not bounds.least <= x <= bounds.most]
        if wrong:
            right = False
            problems.add(
                (*path, name),
                f"the value is out of range: {bounds.reason}",
                got=_shown(wrong[0], bounds.unit),
                expected=_range(bounds),
            )
    return right


def _magnitudes(value: object) -> list[float]:
    """The magnitudes of a number or of a tuple of numbers; none for anything else."""
    items = value if isinstance(value, tuple | list) else (value,)
    if not all(isinstance(item, int | float) and not isinstance(item, bool) for item in items):
        return []
    return [abs(float(item)) for item in items]


def _range(bounds: Bounds) -> str:
    most = _shown(bounds.most, bounds.unit)
    if bounds.unit == "rad":  # "0 to 90 deg"
        return f"0 to {most}" if bounds.least < 1e-6 else f"{_shown(bounds.least, bounds.unit)} to {most}"
    return f"at most {most}" if bounds.least == 0 else f"{_shown(bounds.least, bounds.unit)} to {most}"


def _shown(value: float, unit: str) -> str:
    if unit == "rad":
        return f"{np.rad2deg(value):.6g} deg"
    return f"{value:.6g} {unit}".rstrip()
