"""From what the text says of a dimension or tolerance to a PMI record with faces and edges of the part."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ....part.brep import Edge, Face, PmiRecord, Reference

__all__ = ["NO_LENGTH", "PmiSource", "named_apart", "to_pmi_records"]

NO_LENGTH = 'a "{}" is no length between two points'
_ROUND = ("cylinder", "cone", "sphere", "torus")


@dataclass(frozen=True)
class PmiSource:
    """A dimension or geometric tolerance as the file's records give it.

    Parameters
    ----------
    pmi_record
        All but the references.
    first, second
        Record numbers of the faces and edges on either side.
    problem_first, problem_second
        Why a side could not be followed to faces and edges; empty where it could.
    """

    pmi_record: PmiRecord
    first: tuple[int, ...]
    second: tuple[int, ...]
    problem_first: str = ""
    problem_second: str = ""


def named_apart(sources: Sequence[PmiSource]) -> tuple[PmiSource, ...]:
    """The same with unique names: the file's, or the label with a running number."""
    taken: Counter[str] = Counter()
    named = []
    for index, source in enumerate(sources, start=1):
        label = source.pmi_record.label.replace("/", "-").replace(" ", "_") or "dimension"
        wanted = source.pmi_record.name or f"{label}_{index}"
        name, repeat = wanted, 1
        while taken[name]:
            repeat += 1
            name = f"{wanted}_{repeat}"
        taken[name] += 1
        named.append(replace(source, pmi_record=replace(source.pmi_record, name=name)))
    return tuple(named)


def to_pmi_records(
    sources: Sequence[PmiSource],
    shapes: Mapping[int, Sequence[Reference]],
    faces: Sequence[Face],
    edges: Sequence[Edge],
) -> tuple[PmiRecord, ...]:
    """PMI records with their references.

    Parameters
    ----------
    sources
        The dimensions and tolerances as read from the records.
    shapes
        The faces and edges of the part that stand for each record.
    faces, edges
        All faces and edges of the part.
    """
    pmi_records = []
    for source in sources:
        pmi_record, problems = source.pmi_record, [source.pmi_record.problem]
        first, problem = _side(source.first, source.problem_first, shapes, faces)
        problems.append(problem)
        second, problem = _side(source.second, source.problem_second, shapes, faces)
        problems.append(problem)
        if pmi_record.kind == "length" and "curve" in pmi_record.label.lower() and not _straight(first, edges):
            problems.append(NO_LENGTH.format(pmi_record.label))
        if pmi_record.indication.zone_mm is not None and pmi_record.problem:
            problems = problems[:1]  # it is not measured whatever it refers to
        problem = "; ".join(dict.fromkeys(problem for problem in problems if problem))
        pmi_records.append(replace(pmi_record, first=first, second=second, problem=problem))
    return tuple(pmi_records)


def _side(
    numbers: Sequence[int], problem: str, shapes: Mapping[int, Sequence[Reference]], faces: Sequence[Face]
) -> tuple[tuple[Reference, ...], str]:
    """References of one side, and what is wrong with them."""
    references = tuple(dict.fromkeys(reference for number in numbers for reference in shapes.get(number, ())))
    lost = sum(not shapes.get(number) for number in numbers)
    if lost:
        return references, f"{lost} of {len(numbers)} faces and edges it refers to are not on the part"
    if references and all(r.kind == "face" and faces[r.index].kind in _ROUND for r in references):
        return references, ""  # a round face stands for its own axis or centre
    return references, problem


def _straight(references: Sequence[Reference], edges: Sequence[Edge]) -> bool:
    return bool(references) and all(r.kind == "edge" and edges[r.index].kind == "line" for r in references)
