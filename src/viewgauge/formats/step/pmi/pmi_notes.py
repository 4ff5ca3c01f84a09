"""What the user should know of a file's PMI beside its characteristics: counts, datum targets, general tolerances."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ....part.brep import PmiRecord
from ..step_text import StepText
from .datum_systems import DatumSystems
from .dimension_values import DimensionValues
from .shape_aspects import LOCATIONS, SIZES

__all__ = ["drawn_annotations", "pmi_notes"]

_GRAPHICAL = (
    "ANNOTATION_OCCURRENCE",
    "ANNOTATION_CURVE_OCCURRENCE",
    "ANNOTATION_FILL_AREA_OCCURRENCE",
    "ANNOTATION_PLACEHOLDER_OCCURRENCE",
    "ANNOTATION_TEXT_OCCURRENCE",
    "TESSELLATED_ANNOTATION_OCCURRENCE",
    "DRAUGHTING_ANNOTATION_OCCURRENCE",
    "DRAUGHTING_CALLOUT",
)
_GENERAL = re.compile(
    r"general tolerance|default tolerance|unless otherwise|all over|ISO\s*2768|ISO\s*22081|ISO\s*8015|ISO\s*8062"
    r"|ISO\s*13920|ISO\s*20457|DIN\s*7168|Y14\.5|title block tolerance",
    re.I,
)


def drawn_annotations(text: StepText) -> int:
    """Number of annotations of the file's graphical PMI, which are drawn lines without meaning."""
    return len(text.numbers(*_GRAPHICAL))


def pmi_notes(text: StepText, pmi_records: Sequence[PmiRecord]) -> list[str]:
    """One sentence for each thing that the characteristics do not say.

    Parameters
    ----------
    text
        The file's records.
    pmi_records
        What was read of them.
    """
    notes = _of_dimensions(text, [record for record in pmi_records if record.indication.zone_mm is None])
    if not pmi_records:
        drawn = drawn_annotations(text)
        notes = ["The file has no semantic PMI: geometry only."]
        if drawn:
            notes = [
                f"The file has graphical PMI ({drawn} annotations, drawn lines) but no semantic PMI: geometry only."
            ]
    targets = DatumSystems(text).targets()
    if targets:
        notes.append(f"Datum targets: {', '.join(targets)}; the characteristics that refer to them are not measured.")
    notes += [f'General tolerance note, not applied to any dimension: "{note}".' for note in _general_tolerances(text)]
    return notes


def _of_dimensions(text: StepText, dimensions: Sequence[PmiRecord]) -> list[str]:
    """How the counts of dimensions and of plus-minus tolerances compare."""
    known, plus_minus = set(text.numbers(*LOCATIONS, *SIZES)), DimensionValues(text).plus_minus
    notes = []
    stray = sum(len(ranges) for number, ranges in plus_minus.items() if number not in known)
    if stray:
        notes.append(f"{stray} PLUS_MINUS_TOLERANCE entities belong to no dimension and are not used.")
    repeated = sum(len(ranges) - 1 for number, ranges in plus_minus.items() if number in known)
    if repeated:
        notes.append(f"{repeated} PLUS_MINUS_TOLERANCE entities repeat one of the same dimension; the first counts.")
    toleranced = [record for record in dimensions if record.indication.toleranced]
    angles = sum(record.kind == "angle" for record in toleranced)
    if angles:
        notes.append(f"Toleranced dimensions that are angles: {angles}.")
    limits = len(toleranced) - len(plus_minus.keys() & known)
    if limits > 0:
        notes.append(f"Dimensions toleranced by limits, without a PLUS_MINUS_TOLERANCE entity: {limits}.")
    return notes


def _general_tolerances(text: StepText) -> list[str]:
    """Texts of the file that state tolerances for all that has none of its own."""
    found = []
    for _, item in text.parts("DESCRIPTIVE_REPRESENTATION_ITEM", "DEFAULT_TOLERANCE_TABLE_CELL"):
        words = [" ".join(p.split()) for p in item.parameters if isinstance(p, str) and p.strip()]
        if any(_GENERAL.search(word) for word in words):
            found.append(words[-1])
    return list(dict.fromkeys(found))
