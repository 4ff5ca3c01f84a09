"""Of each dimension the surest setting, and how often each condition fails: all that a table of any length leaves."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..visibility import REASONS
from .evaluator import TableBlock

__all__ = ["BestRows"]


@dataclass(frozen=True)
class BestRows:
    """The best row of the table for each of d dimensions: visible, then surest, then most accurate, then first.

    Parameters
    ----------
    setting
        ``(d,)`` index of the setting, -1 where there was none.
    values
        The table's values there, each ``(d,)``.
    counts
        ``(d, r)``: of how many settings each of :data:`~viewgauge.visibility.REASONS` was said.
    """

    setting: NDArray[np.int64]
    values: TableBlock
    counts: NDArray[np.int64]

    @classmethod
    def of(cls, block: TableBlock, index: NDArray[np.int64]) -> BestRows:
        """Of a block ``(n, d)`` whose settings have these ascending indices ``(n,)``."""
        dimensions = np.arange(block.reason.shape[1])
        reasons = np.arange(len(REASONS))
        counts = (block.reason[..., None] == reasons).sum(axis=0, dtype=np.int64)
        if not len(index):
            empty = (np.zeros(len(dimensions), getattr(block, f.name).dtype) for f in fields(block))
            return cls(np.full(len(dimensions), -1), TableBlock(*empty), counts)
        rank = np.where(block.visible, block.probability, -1.0)
        accuracy = np.where(rank == rank.max(axis=0), block.expected_accuracy, -1.0)
        row = np.argmax(accuracy, axis=0)
        taken = (getattr(block, f.name)[row, dimensions] for f in fields(block))
        return cls(np.asarray(index)[row], TableBlock(*taken), counts)

    def merged(self, other: BestRows) -> BestRows:
        """Of the settings of both."""
        ours, theirs = self._rank(), other._rank()
        take = np.zeros(len(self.setting), dtype=bool)
        equal = np.ones(len(self.setting), dtype=bool)
        for a, b in zip(ours, theirs, strict=True):
            take |= equal & (b > a)
            equal &= a == b
        taken = (
            np.where(take, getattr(other.values, f.name), getattr(self.values, f.name)) for f in fields(self.values)
        )
        return BestRows(np.where(take, other.setting, self.setting), TableBlock(*taken), self.counts + other.counts)

    def taken(self, dimensions: list[int]) -> BestRows:
        """Of some of the dimensions, by index."""
        values = TableBlock(*(getattr(self.values, f.name)[dimensions] for f in fields(self.values)))
        return BestRows(self.setting[dimensions], values, self.counts[dimensions])

    def arrays(self) -> dict[str, NDArray[np.generic]]:
        """As plain arrays, to be stored."""
        values = {f.name: getattr(self.values, f.name) for f in fields(self.values)}
        return {"setting": self.setting, "counts": self.counts, **values}

    @classmethod
    def from_arrays(cls, arrays: dict[str, NDArray[np.generic]]) -> BestRows:
        """What :meth:`arrays` gave."""
        values = TableBlock(**{f.name: arrays[f.name] for f in fields(TableBlock)})  # type: ignore[arg-type]
        return cls(arrays["setting"], values, arrays["counts"])  # type: ignore[arg-type]

    def _rank(self) -> tuple[NDArray[Any], ...]:
        there, values = self.setting >= 0, self.values
        return there, values.visible & there, values.probability, values.expected_accuracy, -self.setting
