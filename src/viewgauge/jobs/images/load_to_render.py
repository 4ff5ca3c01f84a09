"""Read an inspection whose part is to be rendered: with a mesh as fine as the characteristics ask for."""

from __future__ import annotations

from os import PathLike

from ...planning import without_allowed_error
from ...planning.inspection import Inspection
from ..load import load

__all__ = ["load_to_render", "rendered_chord_error_mm"]

_OF_ALLOWED_ERROR = 1 / 20
_FINEST_MM = 2e-4


def load_to_render(
    path: str | PathLike[str], *, part: str | PathLike[str] | None = None, chord_error_mm: float | None = None
) -> Inspection:
    """What :func:`~viewgauge.load` reads; where no chord error is given, the part's mesh is made as fine as needed.

    Parameters
    ----------
    chord_error_mm
        How far the mesh may be from curved faces; None for :func:`rendered_chord_error_mm`.
    """
    inspection = load(path, part=part, chord_error_mm=chord_error_mm)
    if chord_error_mm is not None:
        return inspection
    needed = rendered_chord_error_mm(inspection)
    if inspection.part.mesh.chord_error_mm <= needed:
        return inspection
    return load(path, part=part, chord_error_mm=needed)


def rendered_chord_error_mm(inspection: Inspection) -> float:
    """The chord error, mm, with which a perfect part measures as perfect; infinite where no rim is measured.

    A rim of chords that end on the circle is too small by up to twice their rise. That is at most a tenth of the
    smallest allowed error of a characteristic with a rim: the chord error is a twentieth of it, and 0.2 um at least.
    """
    judged, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    allowed = [
        inspection.requirement.allowed_error_mm(characteristic.nominal_mm, characteristic.tolerance_mm)
        for characteristic in judged
        if characteristic.kind == "diameter" or any(m.rim_axis is not None for m in characteristic.measurands)
    ]
    errors = [error for error in allowed if error is not None]
    return max(_OF_ALLOWED_ERROR * min(errors), _FINEST_MM) if errors else float("inf")
