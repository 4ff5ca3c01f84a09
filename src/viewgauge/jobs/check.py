"""Say what was read, before anything is planned."""

from __future__ import annotations

import math
from typing import Any

from ..evaluation import Requirement
from ..formats.plan.indication_document import indication_document
from ..part import Characteristic, NotMeasurable
from ..planning import sort_characteristics
from ..planning.inspection import Inspection

__all__ = ["check"]


def check(inspection: Inspection) -> dict[str, Any]:
    """What an inspection holds, as plain data: the part, and its characteristics with their status.

    ``characteristics`` has an entry for every characteristic, with ``status`` (``measurable``, ``partial``,
    ``not_measurable`` or ``out_of_scope``) and ``reason``; ``not_measurable`` has those that are not measurable alone.
    ``without_tolerance`` has the basic and reference dimensions that the requirement cannot judge: nothing is demanded
    of them. ``counts`` has the number of toleranced records of the part's file by kind, counted in its text apart from
    the reader.
    """
    found = sort_characteristics(inspection.part, inspection.requirement)
    low, high = inspection.part.mesh.bounds
    not_measurable = [_not_measurable(entry) for entry in found.not_measurable]
    return {
        "part": {
            "name": inspection.part.name,
            "length_unit": inspection.part.length_unit,
            "size_mm": (high - low).tolist(),
            "solids": inspection.part.solids,
            "triangles": len(inspection.part.mesh.triangles),
            "chord_error_mm": inspection.part.mesh.chord_error_mm,
            "notes": list(inspection.part.notes),
        },
        "characteristics": [
            *(_measurable(characteristic, inspection.requirement) for characteristic in found.judged),
            *not_measurable,
        ],
        "not_measurable": not_measurable,
        "without_tolerance": [_not_measurable(entry) for entry in found.without_tolerance],
        "counts": dict(inspection.part.pmi_counts),
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
        **indication_document(characteristic.kind, nominal, tolerance, characteristic.indication),
        "allowed_error_mm": requirement.allowed_error_mm(nominal, tolerance),
        "measurands": len(characteristic.measurands),
        "status": "measurable",
        "reason": "",
    }


def _not_measurable(entry: NotMeasurable) -> dict[str, Any]:
    """``nominal_mm`` and ``tolerance_mm`` are mm, and so none for an angle."""
    length = entry.kind != "angle"
    return {
        "id": entry.id,
        "kind": entry.kind,
        "nominal_mm": entry.nominal_mm if length and math.isfinite(entry.nominal_mm) else None,
        "tolerance_mm": list(entry.tolerance_mm) if length and entry.tolerance_mm else None,
        **indication_document(entry.kind, entry.nominal_mm, entry.tolerance_mm, entry.indication),
        "allowed_error_mm": None,
        "measurands": 0,
        "status": entry.status.value,
        "reason": entry.reason,
    }
