"""Angles between the planes that a PMI record refers to, compared with its nominal value."""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, isnan, pi

from .brep import Face, PmiRecord, Reference

__all__ = ["angle_between_planes", "disagreeing_angle"]

_AGREEMENT_RAD = 1e-3  # without a tolerance, the file's value may be rounded by this much


def disagreeing_angle(pmi_record: PmiRecord, faces: Sequence[Face]) -> float | None:
    """The angle between the planes that an angle refers to, rad, where the nominal value is another; else None.

    The supplement and the full turn's rest count as the same angle.
    """
    between = angle_between_planes(pmi_record.first, pmi_record.second, faces)
    nominal = pmi_record.nominal_mm
    if between is None or isnan(nominal):
        return None
    limit = max((abs(deviation) for deviation in pmi_record.tolerance_mm or ()), default=0.0)
    same = min(abs(nominal - angle) for angle in (between, pi - between, pi + between, 2 * pi - between))
    return between if same > max(min(limit, 0.1), _AGREEMENT_RAD) else None


def angle_between_planes(
    first: Sequence[Reference], second: Sequence[Reference], faces: Sequence[Face]
) -> float | None:
    """The smaller angle between two planes, rad, from 0 to pi / 2; None where a side is no single plane."""
    planes = [[faces[r.index] for r in side if r.kind == "face"] for side in (first, second)]
    if any(not side or len({face.kind for face in side} | {"plane"}) > 1 for side in planes):
        return None
    cosines = {round(abs(float(a.axis @ b.axis)), 9) for a in planes[0] for b in planes[1]}
    return acos(min(cosines.pop(), 1.0)) if len(cosines) == 1 else None
