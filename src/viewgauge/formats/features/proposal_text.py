"""Proposed characteristics as the section ``part`` of an inspection file, to be edited."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from ...part.catalogue import Proposal

__all__ = ["PROPOSED_TOLERANCE", "proposed_section", "proposed_tolerance_mm"]

PROPOSED_TOLERANCE = "ISO 2768-1, class m"
# ISO 2768-1, table 1, class m: deviation, mm, of lengths up to, mm
_LENGTHS = ((6.0, 0.1), (30.0, 0.2), (120.0, 0.3), (400.0, 0.5), (1000.0, 0.8), (2000.0, 1.2), (float("inf"), 2.0))
_DIGITS = 9  # of a nominal value: those of the geometry, without the noise of its computation
_LETTERS = {"distance": "L", "diameter": "D", "position": "P"}


def proposed_tolerance_mm(nominal_mm: float) -> float:
    """The deviation, mm, that the general tolerance of class m allows a length."""
    return next(deviation for limit, deviation in _LENGTHS if nominal_mm <= limit)


def proposed_section(part_file: str, proposals: Sequence[Proposal]) -> str:
    """YAML of the section ``part``: distances and diameters as entries, positions as comments.

    Parameters
    ----------
    part_file
        The part's file, as seen from the folder of the inspection file.
    """
    datums = _common_datums(proposals)
    lines = [
        "# Characteristics proposed from the geometry. Delete what nobody needs, and state the drawing's tolerances:",
        f"# those proposed are the general ones of {PROPOSED_TOLERANCE}.",
        "# `viewgauge features` with the part's file lists the features by these ids.",
        "part:",
        f"  file: {json.dumps(part_file, ensure_ascii=False)}",
    ]
    if datums:
        lines.append("  datums: {" + ", ".join(f"{letter}: {name}" for name, letter in datums.items()) + "}")
    entries = list(_entries(proposals, datums))
    if any(not line.lstrip().startswith("#") for line in entries):
        lines += ["  characteristics:", *entries]
    else:
        lines += ["  characteristics: []", *entries]
    return "\n".join(lines) + "\n"


def _entries(proposals: Sequence[Proposal], datums: dict[str, str]) -> Iterator[str]:
    counts = dict.fromkeys(_LETTERS, 0)
    announced = False
    for proposal in proposals:
        counts[proposal.kind] += 1
        name = f"{_LETTERS[proposal.kind]}{counts[proposal.kind]}"
        if proposal.kind == "position":
            if not announced:
                yield "    # Positions are read and listed, and not measured yet; take the # away to have them listed."
                announced = True
            letters = ", ".join(datums.get(datum, datum) for datum in proposal.datums)
            basic = ", ".join(_number(value) for value in proposal.basic_mm)
            words = f'position: {proposal.features[0]}, datums: [{letters}], basic: "[{basic}] mm", zone: 0.2 mm'
            if all(datum in datums for datum in proposal.datums):
                yield f"    # - {{id: {name}, {words}}}"
            continue
        features = proposal.features[0] if proposal.kind == "diameter" else f"[{', '.join(proposal.features)}]"
        tolerance = f"{proposed_tolerance_mm(proposal.nominal_mm):g} mm"
        size = f"nominal: {_number(proposal.nominal_mm)} mm, tolerance: {tolerance}"
        yield f"    - {{id: {name}, {proposal.kind}: {features}, {size}}}  # {proposal.what}"


def _common_datums(proposals: Sequence[Proposal]) -> dict[str, str]:
    """Letters A, B, C, ... of all planes from which positions are proposed, by the planes' ids."""
    names = dict.fromkeys(datum for proposal in proposals for datum in proposal.datums)
    return {name: chr(ord("A") + k) for k, name in enumerate(names) if k < 26}


def _number(value_mm: float) -> str:
    return f"{round(value_mm, 6) + 0.0:.{_DIGITS}g}"
