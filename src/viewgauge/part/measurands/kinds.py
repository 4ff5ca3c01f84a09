"""The registry of the kinds of measurands."""

from __future__ import annotations

from typing import Any

from ...exceptions import InputError
from .base import Measurand
from .diameter import Diameter
from .length import LengthBetweenPoints

__all__ = ["measurand_kinds", "register_measurand"]

_KINDS: dict[str, type[Measurand]] = {}


def register_measurand(member: type[Any]) -> None:
    """Make a class that fulfils :class:`Measurand` known under its ``kind``.

    Raises
    ------
    InputError
        If another class has that kind.
    """
    if _KINDS.setdefault(member.kind, member) is not member:
        raise InputError("this kind of measurand is registered already", key="kind", got=member.kind)


def measurand_kinds() -> dict[str, type[Measurand]]:
    """The registered classes by their kind."""
    return dict(_KINDS)


for _member in (LengthBetweenPoints, Diameter):
    register_measurand(_member)
