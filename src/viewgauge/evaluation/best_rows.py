"""Of each characteristic the most probable viewpoint, and how often each condition fails: all that a table of any
length leaves.
"""

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
    """The best row of the table for each of d characteristics: visible, then most probable, then most accurate, then
    first.

    Parameters
    ----------
    viewpoint
        ``(d,)`` index of the viewpoint, -1 where there was none.
    values
        The table's values there, each ``(d,)``.
    counts
        ``(d, r)``: of how many viewpoints each of :data:`~viewgauge.visibility.REASONS` was said.
    """

    viewpoint: NDArray[np.int64]
    values: TableBlock
    counts: NDArray[np.int64]

    @classmethod
    def of(cls, block: TableBlock, index: NDArray[np.int64]) -> BestRows:
        """Of a block ``(n, d)`` whose viewpoints have these ascending indices ``(n,)``."""
        characteristics = np.arange(block.reason.shape[1])
        reasons = np.arange(len(REASONS))
        counts = (block.reason[..., None] == reasons).sum(axis=0, dtype=np.int64)
        if not len(index):
            empty = (np.zeros(len(characteristics), getattr(block, f.name).dtype) for f in fields(block))
            return cls(np.full(len(characteristics), -1), TableBlock(*empty), counts)
        rank = np.where(block.visible, block.probability, -1.0)
        accuracy = np.where(rank == rank.max(axis=0), block.expected_accuracy, -1.0)
        row = np.argmax(accuracy, axis=0)
        taken = (getattr(block, f.name)[row, characteristics] for f in fields(block))
        return cls(np.asarray(index)[row], TableBlock(*taken), counts)

    def merged(self, other: BestRows) -> BestRows:
        """Of the viewpoints of both."""
        ours, theirs = self._rank(), other._rank()
        take = np.zeros(len(self.viewpoint), dtype=bool)
        equal = np.ones(len(self.viewpoint), dtype=bool)
        for a, b in zip(ours, theirs, strict=True):
            take |= equal & (b > a)
            equal &= a == b
        taken = (
            np.where(take, getattr(other.values, f.name), getattr(self.values, f.name)) for f in fields(self.values)
        )
        return BestRows(np.where(take, other.viewpoint, self.viewpoint), TableBlock(*taken), self.counts + other.counts)

    def taken(self, characteristics: list[int]) -> BestRows:
        """Of some of the characteristics, by index."""
        values = TableBlock(*(getattr(self.values, f.name)[characteristics] for f in fields(self.values)))
        return BestRows(self.viewpoint[characteristics], values, self.counts[characteristics])

    def arrays(self) -> dict[str, NDArray[np.generic]]:
        """As plain arrays, to be stored."""
        values = {f.name: getattr(self.values, f.name) for f in fields(self.values)}
        return {"viewpoint": self.viewpoint, "counts": self.counts, **values}

    @classmethod
    def from_arrays(cls, arrays: dict[str, NDArray[np.generic]]) -> BestRows:
        """What :meth:`arrays` gave."""
        values = TableBlock(**{f.name: arrays[f.name] for f in fields(TableBlock)})  # type: ignore[arg-type]
        return cls(arrays["viewpoint"], values, arrays["counts"])  # type: ignore[arg-type]

    def _rank(self) -> tuple[NDArray[Any], ...]:
        there, values = self.viewpoint >= 0, self.values
        return there, values.visible & there, values.probability, values.expected_accuracy, -self.viewpoint
