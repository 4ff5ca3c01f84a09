"""Say what was read, before anything is planned."""

from __future__ import annotations

from typing import Any

from ..planning import without_allowed_error
from ..planning.inspection import Inspection

__all__ = ["check"]


def check(inspection: Inspection) -> dict[str, Any]:
    """What an inspection holds, as plain data: the part, its dimensions, and what cannot be measured and why."""
    judged, refused = without_allowed_error(inspection.part.dimensions, inspection.requirement)
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
        "dimensions": [
            {
                "id": dimension.id,
                "kind": dimension.kind,
                "nominal_mm": dimension.nominal_mm,
                "tolerance_mm": list(dimension.tolerance_mm) if dimension.tolerance_mm else None,
                "allowed_error_mm": inspection.requirement.allowed_error_mm(
                    dimension.nominal_mm, dimension.tolerance_mm
                ),
                "gauges": len(dimension.gauges),
            }
            for dimension in judged
        ],
        "not_measurable": [
            {
                "id": entry.id,
                "kind": entry.kind,
                "tolerance_mm": list(entry.tolerance_mm) if entry.tolerance_mm and entry.kind != "angle" else None,
                "reason": entry.reason,
            }
            for entry in (*inspection.part.unusable, *refused)
        ],
        "inputs": dict(inspection.inputs),
    }
