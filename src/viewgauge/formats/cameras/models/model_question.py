"""The question which model four coefficients are of, with a proposal found by trying each."""

from __future__ import annotations

import math

from ....geometry import Lens
from ...files.problems import KeyPath
from ..reading.calibration_document import CalibrationDocument
from .lens_reach import LensReach, lens_reach

__all__ = ["ask_for_model"]

_MODELS = {"fisheye": "equidistant", "radial-tangential": "radial-tangential"}
_SANE_TANGENTIAL = 0.02  # the third and fourth coefficients of a radial-tangential lens are its tangential ones
_WIDE_RAD = math.radians(75.0)


def ask_for_model(document: CalibrationDocument, where: KeyPath, values: list[float], corner: float | None) -> None:
    """Note the problem that the file does not say the model.

    Parameters
    ----------
    corner
        Distance of the farthest corner of the image from the principal point, as a tangent; None where the size of the
        image is not known.
    """
    tried = []
    sane = []
    for name, model in _MODELS.items():
        lens = Lens(model, tuple(values))
        if corner is None:
            continue
        reach = lens_reach(lens, corner)
        tried.append(f"as {name} {_told(reach)}")
        if reach.share == 1 and not (model == "radial-tangential" and _is_strange(values, reach)):
            sane.append(name)
    hint = "say which: camera.model: fisheye in the inspection file, --model fisheye on the command line"
    if corner is None:
        hint += "; with the image's size (--size) a proposal can be made"
    elif len(sane) == 1:
        hint += f". Tried: {'; '.join(tried)}. Probably {sane[0]}"
    else:
        hint += f". Tried: {'; '.join(tried)}. Both are possible" if sane else f". Tried: {'; '.join(tried)}"
    document.problems.add(
        where,
        "four distortion coefficients, and the file does not say of which model",
        got=values,
        expected="fisheye (equidistant: k1, k2, k3, k4) or radial-tangential (k1, k2, p1, p2)",
        hint=hint,
    )


def _told(reach: LensReach) -> str:
    if reach.share < 1:
        return f"the lens turns back at {reach.share:.0%} of the distance to the corner"
    return f"the corner lies at {math.degrees(reach.corner_angle_rad):.0f} deg from the axis"


def _is_strange(values: list[float], reach: LensReach) -> bool:
    return max(abs(value) for value in values[2:]) > _SANE_TANGENTIAL or not reach.corner_angle_rad < _WIDE_RAD
