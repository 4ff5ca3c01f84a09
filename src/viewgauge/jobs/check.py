"""Say what was read, before anything is planned."""

from __future__ import annotations

import math
from typing import Any

from ..evaluation import Requirement
from ..part import Characteristic, NotMeasurable
from ..planning import without_allowed_error
from ..planning.inspection import Inspection

__all__ = ["check"]


def check(inspection: Inspection) -> dict[str, Any]:
    """What an inspection holds, as plain data: the part, and its characteristics with their status.

    ``characteristics`` has an entry for every characteristic, with ``status`` (``measurable`` or ``not_measurable``)
    and ``reason``; ``not_measurable`` has those of the latter alone.
    """
    judged, refused = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    low, high = inspection.part.mesh.bounds
    not_measurable = [_not_measurable(entry) for entry in (*inspection.part.not_measurable, *refused)]
    return {
        "part": {
            "name": inspection.part.name,
            "length_unit": inspection.part.length_unit,
            "size_mm": (high - low).tolist(),
            "triangles": len(inspection.part.mesh.triangles),
            "chord_error_mm": inspection.part.mesh.chord_error_mm,
            "notes": list(inspection.part.notes),
        },
        "characteristics": [
            *(_measurable(characteristic, inspection.requirement) for characteristic in judged),
            *not_measurable,
        ],
        "not_measurable": not_measurable,
        "inputs": dict(inspection.inputs),
        "findings": [finding.document() for finding in inspection.findings],
    }


def _measurable(characteristic: Characteristic, requirement: Requirement) -> dict[str, Any]:
    nominal, tolerance = characteristic.nominal_mm, characteristic.tolerance_mm
    return {
        "id": characteristic.id,
        "kind": characteristic.kind,
        "nominal_mm": nominal,
        "tolerance_mm": list(tolerance) if tolerance else None,
        "allowed_error_mm": requirement.allowed_error_mm(nominal, tolerance),
        "measurands": len(characteristic.measurands),
        "status": "measurable",
        "reason": "",
    }


def _not_measurable(entry: NotMeasurable) -> dict[str, Any]:
    """Values are mm, and so none for an angle."""
    length = entry.kind != "angle"
    return {
        "id": entry.id,
        "kind": entry.kind,
        "nominal_mm": entry.nominal_mm if length and math.isfinite(entry.nominal_mm) else None,
        "tolerance_mm": list(entry.tolerance_mm) if length and entry.tolerance_mm else None,
        "allowed_error_mm": None,
        "measurands": 0,
        "status": "not_measurable",
        "reason": entry.reason,
    }
