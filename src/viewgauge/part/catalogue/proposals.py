"""Characteristics that a part without PMI might have: distances of parallel planes, diameters, positions of holes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..characteristics.outcome import Derived
from ..features.coincidence import distance_from_axis, is_parallel, same_radius
from ..features.parallel_planes import distinct_normals
from .catalogue import Catalogue
from .part_feature import PartFeature
from .stated import outcome_on_features

__all__ = ["Proposal", "propose"]

_TRIES = 3  # faces of one level that are tried against faces of another
_LEVELS = 40  # in one direction; a part with more has steps that nobody measures all


@dataclass(frozen=True)
class Proposal:
    """A characteristic that a user may want.

    Parameters
    ----------
    kind
        "distance", "diameter" or "position".
    features
        Ids of the features.
    nominal_mm
        The geometry's value, mm; NaN for a position.
    datums, basic_mm
        Of a position: ids of the planes A, B and C, and the distances of the axis from B and C, mm.
    what
        In words, such as "width of slot S1".
    """

    kind: str
    features: tuple[str, ...]
    nominal_mm: float
    what: str
    datums: tuple[str, ...] = ()
    basic_mm: tuple[float, ...] = ()


def propose(catalogue: Catalogue) -> list[Proposal]:
    """Proposals, distances and diameters only where they can be measured."""
    distances = _unrepeated([*_slot_widths(catalogue), *_between_levels(catalogue), *_between_holes(catalogue)])
    return [*distances, *_diameters(catalogue), *_positions(catalogue)]


def _unrepeated(proposals: Sequence[Proposal]) -> list[Proposal]:
    return list({frozenset(proposal.features): proposal for proposal in reversed(proposals)}.values())[::-1]


def _slot_widths(catalogue: Catalogue) -> Iterator[Proposal]:
    plane_of = {plane.references[0]: plane.id for plane in catalogue.of_kind("plane")}
    for slot in catalogue.of_kind("slot"):
        ids = tuple(plane_of[reference] for reference in slot.references)
        yield from _measurable(catalogue, "distance", ids, f"width of slot {slot.id}")


def _between_levels(catalogue: Catalogue) -> Iterator[Proposal]:
    """In each direction of planes: the overall size, and each level from the lowest, or else from the next."""
    planes = catalogue.of_kind("plane")
    for normal in distinct_normals([plane.direction for plane in planes]):
        normal = normal if tuple(np.round(normal, 6)) > (0.0, 0.0, 0.0) else -normal
        levels = _levels(catalogue, planes, normal)[:_LEVELS]
        for k in [len(levels) - 1, *range(1, len(levels) - 1)]:
            what = "overall size" if k == len(levels) - 1 else "step"
            for lower in dict.fromkeys((0, k - 1)) if k > 0 else ():
                found = next(_first_measurable(catalogue, levels[lower], levels[k], what), None)
                if found is not None:
                    yield found
                    break


def _levels(
    catalogue: Catalogue, planes: Sequence[PartFeature], normal: NDArray[np.float64]
) -> list[list[PartFeature]]:
    """The planes of one direction by their height along it, the largest of each height first."""
    along = [plane for plane in planes if is_parallel(plane.direction, normal)]
    along.sort(key=lambda plane: float(plane.position @ normal))
    levels: list[list[PartFeature]] = []
    for plane in along:
        if levels and float((plane.position - levels[-1][-1].position) @ normal) <= catalogue.outline.tolerance_mm:
            levels[-1].append(plane)
        else:
            levels.append([plane])
    return [sorted(level, key=_size, reverse=True) for level in levels]


def _size(plane: PartFeature) -> float:
    return round(plane.sizes_mm["length"] * plane.sizes_mm["width"], 6)


def _first_measurable(
    catalogue: Catalogue, lower: Sequence[PartFeature], upper: Sequence[PartFeature], what: str
) -> Iterator[Proposal]:
    for a, b in product(lower[:_TRIES], upper[:_TRIES]):
        yield from _measurable(catalogue, "distance", (a.id, b.id), what)


def _between_holes(catalogue: Catalogue) -> Iterator[Proposal]:
    """From each hole to the next parallel one of the same diameter, where they lie beside each other."""
    left = catalogue.of_kind("hole")
    while left:
        hole, *left = left
        alike = [other for other in left if _is_alike(catalogue, hole, other)]
        if alike:
            nearest = min(alike, key=lambda other: round(_apart(hole, other), 6))
            yield from _measurable(catalogue, "distance", (hole.id, nearest.id), "distance of holes")


def _is_alike(catalogue: Catalogue, a: PartFeature, b: PartFeature) -> bool:
    tolerance = catalogue.outline.tolerance_mm
    return (
        is_parallel(a.direction, b.direction)
        and same_radius(a.sizes_mm["diameter"], b.sizes_mm["diameter"], tolerance)
        and _apart(a, b) > tolerance
    )


def _apart(a: PartFeature, b: PartFeature) -> float:
    """Distance of two parallel axes, mm."""
    return float(np.linalg.norm(distance_from_axis(b.position, a.position, a.direction)))


def _diameters(catalogue: Catalogue) -> Iterator[Proposal]:
    for feature in (*catalogue.of_kind("hole"), *catalogue.of_kind("boss")):
        yield from _measurable(catalogue, "diameter", (feature.id,), f"diameter of a {feature.kind}")


def _measurable(catalogue: Catalogue, kind: str, ids: tuple[str, ...], what: str) -> Iterator[Proposal]:
    outcome = outcome_on_features(catalogue, kind, ids)
    if isinstance(outcome, Derived):
        yield Proposal(kind, ids, outcome.value_mm, what)


def _positions(catalogue: Catalogue) -> Iterator[Proposal]:
    """Holes from the largest planes across the axis (A) and along it (B, C), as a drawing would have them."""
    planes = sorted(catalogue.of_kind("plane"), key=_size, reverse=True)
    for hole in catalogue.of_kind("hole"):
        across = [plane for plane in planes if is_parallel(plane.direction, hole.direction)]
        along = [plane for plane in planes if abs(float(plane.direction @ hole.direction)) < 1e-6]
        third = [plane for plane in along if abs(float(plane.direction @ along[0].direction)) < 1e-6]
        if across and third:
            datums = (across[0], along[0], third[0])
            basic = tuple(abs(float((hole.position - datum.position) @ datum.direction)) for datum in datums[1:])
            ids = tuple(datum.id for datum in datums)
            yield Proposal("position", (hole.id,), np.nan, "position of a hole", ids, basic)
