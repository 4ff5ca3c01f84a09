"""What limits a dimension: the dominating reason where it is not seen, else pixels or pose error."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from viewgauge.planning.cause import limiting_cause
from viewgauge.visibility import REASONS


def column(reasons, probability=None, pose=0.2, pixels=0.1, length=500.0):
    n = len(reasons)
    values = {
        "reason": np.array(reasons, dtype=object),
        "visible": np.array([r == "" for r in reasons]),
        "probability": np.zeros(n) if probability is None else np.array(probability),
        "sigma_displacement_px": np.broadcast_to(pose, n),
        "sigma_quantization_px": np.broadcast_to(pixels, n),
        "image_length_px": np.broadcast_to(length, n),
    }
    return xr.Dataset({name: ("setting", value) for name, value in values.items()})


def test_the_dominating_reason_comes_first_with_its_share():
    told = limiting_cause(column(["occluded"] * 6 + ["out_of_view"] * 3 + ["facing_away"]))
    assert told == (
        "not visible from any of 10 candidates: hidden by the part (60%), outside the image (30%), "
        "on faces turned away (10%)"
    )


@pytest.mark.parametrize("reason", REASONS[:-1])
def test_every_reason_has_words(reason):
    told = limiting_cause(column([reason, reason]))
    assert "(100%)" in told
    assert "_" not in told


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
    told = limiting_cause(column(["", "occluded"], [0.4, 0.0], pose, pixels))
    assert telling in told
    assert f"{np.hypot(pose, pixels):.3g} px of 500 px" in told


def test_the_shares_are_those_of_the_best_setting():
    told = limiting_cause(column(["", "", ""], [0.1, 0.8, 0.2], pose=[1.0, 0.1, 1.0], pixels=[0.1, 0.3, 0.1]))
    assert "limited by pixels (90%" in told


def test_the_best_setting_is_a_visible_one_even_where_nothing_is_probable():
    told = limiting_cause(
        column(["occluded", ""], [0.0, 0.0], pose=[np.nan, 0.3], pixels=[np.nan, 0.1], length=[400.0, 500.0])
    )
    assert "pose error (90%" in told
    assert "nan" not in told
