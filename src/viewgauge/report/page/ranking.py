"""The order in which reports list characteristics, and the words for their states."""

from __future__ import annotations

from ...planning.plan import Plan, PlannedCharacteristic, Status

__all__ = ["STATUS_WORDS", "ranked"]

STATUS_WORDS = {
    Status.NOT_MET: "not met",
    Status.PARTIAL: "partial",
    Status.NOT_MEASURABLE: "not measurable",
    Status.OUT_OF_SCOPE: "out of scope",
    Status.MET: "met",
}


def ranked(plan: Plan) -> list[PlannedCharacteristic]:
    """Not met, not measurable, out of scope, then met; within each the least probable first."""
    order = list(STATUS_WORDS)
    return sorted(plan.characteristics, key=lambda d: (order.index(d.status), d.probability))
