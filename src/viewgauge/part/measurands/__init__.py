"""Measurands: what of a characteristic is computed from located edge points, one file a kind.

A new kind is one file with a class that fulfils :class:`Measurand`, and one entry in :mod:`.kinds` (or a call of
:func:`register_measurand` from outside).
"""

from .base import Measurand
from .diameter import Diameter, rim_axes
from .kinds import measurand_kinds, register_measurand
from .length import LengthBetweenPoints
from .point_pair import PointPair

__all__ = [
    "Diameter",
    "LengthBetweenPoints",
    "Measurand",
    "PointPair",
    "measurand_kinds",
    "register_measurand",
    "rim_axes",
]
