"""Which characteristics of a part are planned, which cannot be measured, and which demand nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..evaluation import Requirement
from ..part import Characteristic, NotMeasurable, Part

__all__ = ["SortedCharacteristics", "sort_characteristics", "toleranced", "without_allowed_error", "without_tolerance"]


@dataclass(frozen=True)
class SortedCharacteristics:
    """The characteristics of a part under a requirement.

    Parameters
    ----------
    judged
        Those that can be measured and that the requirement can judge.
    not_measurable
        Those that have a tolerance but cannot be measured or judged, each with its reason.
    without_tolerance
        Basic and reference dimensions of the drawing: they demand nothing, and nothing depends on them.
    """

    judged: tuple[Characteristic, ...]
    not_measurable: tuple[NotMeasurable, ...]
    without_tolerance: tuple[NotMeasurable, ...]


def sort_characteristics(part: Part, requirement: Requirement) -> SortedCharacteristics:
    """Every characteristic of a part in one of the three groups."""
    judged, refused = without_allowed_error(part.characteristics, requirement)
    rest = (*part.not_measurable, *refused)
    return SortedCharacteristics(judged, toleranced(rest), without_tolerance(rest))


def toleranced(entries: Iterable[NotMeasurable]) -> tuple[NotMeasurable, ...]:
    """Those of which the drawing demands something."""
    return tuple(entry for entry in entries if entry.indication.toleranced)


def without_tolerance(entries: Iterable[NotMeasurable]) -> tuple[NotMeasurable, ...]:
    """Basic and reference dimensions, of which the drawing demands nothing."""
    return tuple(entry for entry in entries if not entry.indication.toleranced)


def without_allowed_error(
    characteristics: Sequence[Characteristic], requirement: Requirement
) -> tuple[tuple[Characteristic, ...], tuple[NotMeasurable, ...]]:
    """Split characteristics into those that the requirement can judge and those that it cannot, with the reason."""
    judged, refused = [], []
    for characteristic in characteristics:
        reason = requirement.cannot_judge(characteristic.tolerance_mm)
        if reason is None:
            judged.append(characteristic)
            continue
        if characteristic.tolerance_mm is None and characteristic.indication.is_one_sided:
            limit = characteristic.indication.text
            reason = f"its limit is one-sided ({limit}), and the requirement is about a zone between two limits"
        refused.append(
            NotMeasurable(
                characteristic.id,
                characteristic.kind,
                reason,
                characteristic.nominal_mm,
                characteristic.tolerance_mm,
                indication=characteristic.indication,
            )
        )
    return tuple(judged), tuple(refused)
