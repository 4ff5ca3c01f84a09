"""Say what was read, before anything is planned."""

from __future__ import annotations

from typing import Any

from ..planning import without_allowed_error
from ..planning.inspection import Inspection

__all__ = ["check"]


def check(inspection: Inspection) -> dict[str, Any]:
    """What an inspection holds, as plain data: the part, its characteristics, and what cannot be measured and why."""
    judged, refused = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    low, high = inspection.part.mesh.bounds
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
            {
                "id": characteristic.id,
                "kind": characteristic.kind,
                "nominal_mm": characteristic.nominal_mm,
                "tolerance_mm": list(characteristic.tolerance_mm) if characteristic.tolerance_mm else None,
                "allowed_error_mm": inspection.requirement.allowed_error_mm(
                    characteristic.nominal_mm, characteristic.tolerance_mm
                ),
                "measurands": len(characteristic.measurands),
            }
            for characteristic in judged
        ],
        "not_measurable": [
            {
                "id": entry.id,
                "kind": entry.kind,
                "tolerance_mm": list(entry.tolerance_mm) if entry.tolerance_mm and entry.kind != "angle" else None,
                "reason": entry.reason,
            }
            for entry in (*inspection.part.not_measurable, *refused)
        ],
        "inputs": dict(inspection.inputs),
    }
