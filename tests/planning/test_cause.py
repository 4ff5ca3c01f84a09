"""What limits a characteristic: the dominating reason where it is not seen, else pixels or pose error."""

from __future__ import annotations

import numpy as np
import pytest

from viewgauge.evaluation import BestRows, TableBlock
from viewgauge.planning.cause import limiting_cause
from viewgauge.visibility import REASONS


def cause(reasons, probability=None, pose=0.2, pixels=0.1, length=500.0):
    """The cause told of one characteristic from n viewpoints."""
    n = len(reasons)
    code = np.array([[REASONS.index(reason)] for reason in reasons], dtype=np.int8)

    def real(value):
        return np.broadcast_to(value, n).astype(float)[:, None]

    block = TableBlock(
        reason=code,
        image_length_px=real(length),
        angle_rad=real(0.0),
        relative_tolerance=real(0.01),
        sigma_displacement_px=real(pose),
        sigma_quantization_px=real(pixels),
        probability=real(0.0 if probability is None else probability),
        expected_accuracy=real(0.0),
        measurand=np.zeros((n, 1), dtype=np.int32),
        validity=np.zeros((n, 1), dtype=np.int8),
    )
    return limiting_cause(BestRows.of(block, np.arange(n)), 0)


def test_the_dominating_reason_comes_first_with_its_share():
    reported = cause(["occluded"] * 6 + ["out_of_view"] * 3 + ["facing_away"])
    assert reported == (
        "not visible from any of 10 candidates: hidden by the part (60%), outside the image (30%), "
        "on faces turned away (10%)"
    )


@pytest.mark.parametrize("reason", REASONS[:-1])
def test_every_reason_has_words(reason):
    reported = cause([reason, reason])
    assert "(100%)" in reported
    assert "_" not in reported


@pytest.mark.parametrize(
    ("pose", "pixels", "telling"),
    [
        (0.3, 0.1, "limited by pose error (90% of the variance)"),
        (0.1, 0.3, "limited by pixels (90% of the variance)"),
        (0.0, 0.3, "limited by pixels (100% of the variance)"),
        (0.3, 0.0, "limited by pose error (100% of the variance)"),
    ],
)
def test_the_larger_share_of_the_variance_limits(pose, pixels, telling):
    reported = cause(["", "occluded"], [0.4, 0.0], pose, pixels)
    assert telling in reported
    assert f"{np.hypot(pose, pixels):.3g} px of 500 px" in reported


def test_the_shares_are_those_of_the_best_viewpoint():
    reported = cause(["", "", ""], [0.1, 0.8, 0.2], pose=[1.0, 0.1, 1.0], pixels=[0.1, 0.3, 0.1])
    assert "limited by pixels (90%" in reported


def test_the_best_viewpoint_is_a_visible_one_even_where_nothing_is_probable():
    reported = cause(["occluded", ""], [0.0, 0.0], pose=[np.nan, 0.3], pixels=[np.nan, 0.1], length=[400.0, 500.0])
    assert "pose error (90%" in reported
    assert "nan" not in reported
