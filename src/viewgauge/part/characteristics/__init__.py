"""From the PMI records of a B-rep to characteristics with measurands: pairs of points on real, visible edges.

A kind of PMI record is one file with a deriver, and one entry in :mod:`.derivers` (or a call of :func:`register` from
outside).
"""

from .derive import derive_characteristics
from .derivers import Deriver, register

__all__ = ["Deriver", "derive_characteristics", "register"]
