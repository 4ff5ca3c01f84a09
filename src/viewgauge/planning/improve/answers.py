"""How given viewpoints measure a part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...evaluation import WARNINGS, Setup, TableBlock
from ...part import Characteristic, PointPair
from ...visibility import REASONS

__all__ = ["Answers", "CharacteristicAnswer"]


@dataclass(frozen=True)
class CharacteristicAnswer:
    """How a characteristic is measured.

    Parameters
    ----------
    viewpoint
        The one with the highest probability; None where no viewpoint sees it.
    measurand
        What is measured from there; where it is not seen, its first measurand.
    reason
        Why it is not seen from where it fails last; empty where it is seen.
    """

    characteristic: Characteristic
    allowed_error_mm: float
    met: bool
    probability: float
    expected_accuracy: float
    viewpoint: str | None
    measurand: PointPair
    reason: str
    warning: str


@dataclass(frozen=True)
class Answers:
    """How given viewpoints measure the part.

    Parameters
    ----------
    viewpoints
        ``T_part_camera`` ``(4, 4)`` mm by name.
    table
        Viewpoint x characteristic, in the order of ``viewpoints`` and ``characteristics``.
    """

    setup: Setup
    viewpoints: Mapping[str, NDArray[np.float64]]
    characteristics: tuple[CharacteristicAnswer, ...]
    table: TableBlock

    @property
    def met(self) -> int:
        """Number of characteristics that are met."""
        return sum(answer.met for answer in self.characteristics)

    @property
    def weakest(self) -> CharacteristicAnswer | None:
        """The least probable of all; None where there is none."""
        return min(self.characteristics, key=lambda answer: answer.probability, default=None)

    def of(self, name: str) -> CharacteristicAnswer:
        """By the characteristic's id; KeyError where there is none."""
        return {answer.characteristic.id: answer for answer in self.characteristics}[name]

    @classmethod
    def from_table(
        cls,
        setup: Setup,
        viewpoints: Mapping[str, NDArray[np.float64]],
        characteristics: tuple[Characteristic, ...],
        allowed_error_mm: NDArray[np.float64],
        table: TableBlock,
    ) -> Answers:
        """Each characteristic at its most probable viewpoint of a table."""
        names = list(viewpoints)
        answers = tuple(
            _answer(characteristic, float(allowed_error_mm[j]), table, j, names, setup.requirement.probability)
            for j, characteristic in enumerate(characteristics)
        )
        return cls(setup, viewpoints, answers, table)


def _answer(
    characteristic: Characteristic, allowed: float, table: TableBlock, j: int, names: list[str], required: float
) -> CharacteristicAnswer:
    visible = table.visible[:, j]
    if not visible.any():
        last = int(table.reason[:, j].max()) if len(names) else None
        reason = "no viewpoint yet" if last is None else REASONS[last]
        return CharacteristicAnswer(
            characteristic, allowed, False, 0.0, 0.0, None, characteristic.measurands[0], reason, ""
        )
    row = int(np.argmax(np.where(visible, table.probability[:, j], -1.0)))
    probability = float(table.probability[row, j])
    return CharacteristicAnswer(
        characteristic,
        allowed,
        probability >= required,
        probability,
        float(table.expected_accuracy[row, j]),
        names[row],
        characteristic.measurands[int(table.measurand[row, j])],
        "",
        ("", *WARNINGS)[int(table.validity[row, j])],
    )
