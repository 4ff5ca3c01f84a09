"""Whether a part is as large as parts are that a camera measures."""

from __future__ import annotations

import numpy as np

from ..findings import Finding
from .mesh import Mesh

__all__ = ["size_findings"]

_SMALLEST_MM, _LARGEST_MM = 1.0, 5000.0
_LIKELY_MM = (5.0, 3000.0)
_OTHER_UNITS = {"m": 1000.0, "inch": 25.4, "cm": 10.0, "um": 1e-3}  # the likeliest first


def size_findings(mesh: Mesh, unit_key: str = "") -> tuple[Finding, ...]:
    """The finding ``part_size`` for a part whose longest side is below 1 mm or above 5 m, with the likely unit.

    Parameters
    ----------
    unit_key
        The key that says the unit of a file whose coordinates were taken as mm for want of one; empty where the unit
        is stated.
    """
    size = float(np.ptp(mesh.bounds, axis=0).max())
    if _SMALLEST_MM <= size <= _LARGEST_MM:
        return ()
    low, high = _LIKELY_MM
    likely = [(unit, size * scale) for unit, scale in _OTHER_UNITS.items() if low <= size * scale <= high]
    cause = "the unit of the file's lengths is another"
    if likely:
        unit, then_mm = likely[0]
        cause = f"the file's lengths are in {unit}: then it is {then_mm:.4g} mm"
        cause += f" ({unit_key}: {unit})" if unit_key else ""
    usual = f"{_SMALLEST_MM:g} mm to {_LARGEST_MM / 1000:g} m"
    return (Finding("part_size", f"the part's longest side is {size:.4g} mm", usual, cause, "part.file"),)
