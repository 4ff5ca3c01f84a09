"""Ranges in which a quantity usually lies, and the finding of a value outside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...findings import Finding

__all__ = ["UsualRange", "some_of"]

_NAMED = 5


@dataclass(frozen=True)
class UsualRange:
    """What is usual of one quantity.

    Parameters
    ----------
    name
        Of the finding.
    least, most
        In the unit of the values that are judged.
    unit, scale
        What a value is shown in, and how many of these are one of the unit that is judged.
    if_less, if_more
        The likely cause of a smaller and of a greater value.
    """

    name: str
    what: str
    least: float
    most: float
    unit: str
    scale: float = 1.0
    if_less: str = ""
    if_more: str = ""

    def judge(self, value: float, where: str, *, more: str = "") -> list[Finding]:
        """The finding of a value outside, if it is; ``more`` is said after the value."""
        if self.least <= value <= self.most:
            return []
        cause = self.if_less if value < self.least else self.if_more
        usual = f"{self._shown(self.least)} to {self._shown(self.most)}"
        return [Finding(self.name, f"{self.what} is {self._shown(value)}{more}", usual, cause, where)]

    def _shown(self, value: float) -> str:
        return f"{self.scale * value:.4g} {self.unit}".rstrip()


def some_of(names: Sequence[str]) -> str:
    """The first of several names, and how many more there are."""
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more} more" if more > 0 else "")
