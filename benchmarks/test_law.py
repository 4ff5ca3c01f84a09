"""The probability of one allowed error: our closed form beside OpenTURNS, SciPy, NumPy and Monte Carlo."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from law_ways import WAYS, Pairs, ordinary_pairs, scalar_code


@pytest.fixture(scope="module")
def pairs(tiny: bool) -> Pairs:
    """The pairs that every way gets, or the first of."""
    return ordinary_pairs(100 if tiny else max(way.pairs for way in WAYS.values()))


@pytest.mark.benchmark(group="law")
@pytest.mark.parametrize("key", WAYS)
def test_law(key: str, pairs: Pairs, tiny: bool, timed: Callable[..., None]) -> None:
    """Agrees with the reference to the accuracy stated, and is timed."""
    way = WAYS[key]
    if tiny and way.seconds_at_least:
        pytest.skip("takes seconds however few the pairs")
    part = pairs.first(min(way.pairs, 3) if tiny and way.pairs < 1000 else way.pairs)
    error = np.abs(way.compute(part) - scalar_code(part))
    assert error.max() <= way.accuracy
    timed(
        lambda: way.compute(part),
        count=part.x.size,
        unit="pairs",
        rounds=way.rounds,
        name=way.name,
        largest_error=float(error.max()),
        median_error=float(np.median(error)),
        extrapolated_to=way.extrapolated_to,
    )
