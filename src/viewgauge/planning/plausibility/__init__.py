"""What is implausible in an inspection: one file for each of the things that it holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...findings import Finding

if TYPE_CHECKING:
    from ..inspection import Inspection

__all__ = ["implausible"]


def implausible(inspection: Inspection) -> tuple[Finding, ...]:
    """Every finding of an inspection, those of its camera first."""
    return ()
