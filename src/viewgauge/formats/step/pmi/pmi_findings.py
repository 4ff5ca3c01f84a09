"""What is implausible in a file's PMI, and where the reader and the text disagree."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence

from ....findings import Finding
from ....part.brep import Face, PmiRecord
from ....part.face_angles import disagreeing_angle

__all__ = ["pmi_findings"]

_NO_WIDTH = 1e-9  # mm or rad
_AT_ITS_LIMIT = ("maximum material", "least material")  # a zone of 0 at the limit of size widens with the size


def pmi_findings(
    pmi_records: Sequence[PmiRecord], counts: Mapping[str, int], faces: Sequence[Face], drawn: int
) -> tuple[Finding, ...]:
    """Tolerance zones without a width, angles that the part does not have, and counts that differ from the text's.

    Parameters
    ----------
    pmi_records
        What was read.
    counts
        Toleranced records by kind, as counted in the text.
    faces
        The faces of the part.
    drawn
        Number of annotations of the graphical PMI.
    """
    if drawn and not pmi_records:
        return (
            Finding(
                "graphical_pmi",
                f"the file has graphical PMI ({drawn} annotations, drawn lines) but no semantic PMI: what the drawing "
                "demands cannot be read",
                cause="the file was exported with drawn PMI only; export it as AP242 with semantic PMI",
            ),
        )
    found = [finding for record in pmi_records if (finding := _without_width(record)) is not None]
    found += [finding for record in pmi_records if (finding := _other_angle(record, faces)) is not None]
    read = Counter(record.kind for record in pmi_records if record.indication.toleranced)
    for kind in sorted({*read, *counts}):
        if read[kind] != counts.get(kind, 0):
            found.append(
                Finding(
                    "pmi_count",
                    f"{read[kind]} toleranced records of kind {kind} were read, and the text of the file has "
                    f"{counts.get(kind, 0)}",
                    cause="the file writes some in a way that is not known",
                )
            )
    return tuple(found)


def _other_angle(record: PmiRecord, faces: Sequence[Face]) -> Finding | None:
    between = disagreeing_angle(record, faces) if record.kind == "angle" else None
    if between is None:
        return None
    in_degrees = math.isclose(record.nominal_mm, math.degrees(between), rel_tol=0.01)
    said = math.degrees(record.nominal_mm)
    return Finding(
        "angle_of_the_part",
        f"{record.name}: the file says {said:.6g} deg, and its faces are {math.degrees(between):.6g} deg apart",
        cause="degrees were written under the unit radian" if in_degrees else "",
    )


def _without_width(record: PmiRecord) -> Finding | None:
    if record.tolerance_mm is not None:
        lower, upper = record.tolerance_mm
        if upper - lower > _NO_WIDTH:
            return None
        twice = abs(upper) > _NO_WIDTH
        return Finding(
            "tolerance_without_width",
            f"{record.name} ({record.indication.text}): the tolerance zone has no width, so nothing is good enough",
            cause="one value was written for both deviations" if twice else "the deviations were left at 0",
        )
    zone, modifiers = record.indication.zone_mm, " ".join(record.indication.modifiers)
    if zone is None or not zone <= _NO_WIDTH or any(words in modifiers for words in _AT_ITS_LIMIT):
        return None
    found = f"{record.name} ({record.indication.text}): the tolerance zone has no width"
    return Finding("tolerance_without_width", found, cause="the size of the zone was left at 0")
