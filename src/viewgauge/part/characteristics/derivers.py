"""The registry of derivers: what makes characteristics of the PMI records of one kind."""

from __future__ import annotations

from collections.abc import Callable

from ...exceptions import InputError
from ..brep import PmiRecord
from ..features.outline import Outline
from .angles import derive_angle
from .diameters import derive_diameters
from .distances import derive_distance
from .lengths import derive_lengths
from .outcome import Outcome
from .radii import derive_radius

__all__ = ["Deriver", "deriver_of", "register"]

Deriver = Callable[[Outline, PmiRecord], list[Outcome]]
"""Looks for the measurands of a PMI record on a B-rep; gives one outcome per feature, at least one."""

_DERIVERS: dict[str, Deriver] = {
    "angle": derive_angle,
    "diameter": derive_diameters,
    "distance": derive_distance,
    "length": derive_lengths,
    "radius": derive_radius,
}


def register(kind: str, deriver: Deriver) -> None:
    """Derive characteristics from the PMI records of a kind that nothing derives yet, such as "depth".

    Raises
    ------
    InputError
        If the kind has another deriver.
    """
    if _DERIVERS.setdefault(kind, deriver) is not deriver:
        raise InputError("this kind of PMI record has a deriver already", key="kind", got=kind)


def deriver_of(kind: str) -> Deriver | None:
    """The deriver of a kind of PMI record; None where nothing derives that kind."""
    return _DERIVERS.get(kind)
