"""What is left of a table: the same for its parts, merged in any way, as for the whole."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import reduce

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from viewgauge.evaluation import BestRows, TableBlock
from viewgauge.visibility import REASONS, VISIBLE


def table(rng, viewpoints, characteristics):
    """Few different values, so that many are equal; what is not visible has none."""
    shape = (viewpoints, characteristics)
    reason = rng.integers(VISIBLE - 1, VISIBLE + 1, shape).astype(np.int8)
    seen = reason == VISIBLE
    real = {f.name: rng.integers(0, 3, shape) / 2.0 for f in fields(TableBlock)}
    return TableBlock(
        **{
            **real,
            "reason": reason,
            "probability": np.where(seen, real["probability"], 0.0),
            "expected_accuracy": np.where(seen, real["expected_accuracy"], 0.0),
            "sigma_displacement_px": np.where(seen, real["sigma_displacement_px"], np.nan),
            "measurand": rng.integers(0, 5, shape).astype(np.int32),
            "validity": rng.integers(0, 3, shape).astype(np.int8),
        }
    )


def rows(block, some):
    return replace(block, **{f.name: getattr(block, f.name)[some] for f in fields(block)})


def assert_same(a, b):
    for name, array in a.arrays().items():
        np.testing.assert_array_equal(b.arrays()[name], array, err_msg=name)


@given(
    seed=st.integers(0, 2**32 - 1),
    viewpoints=st.integers(1, 12),
    characteristics=st.integers(0, 4),
    data=st.data(),
)
def test_merged_in_any_order_and_grouping_it_is_that_of_the_whole(seed, viewpoints, characteristics, data):
    block = table(np.random.default_rng(seed), viewpoints, characteristics)
    whole = BestRows.of(block, np.arange(viewpoints))
    cuts = sorted(data.draw(st.lists(st.integers(0, viewpoints), max_size=6)))  # equal cuts: empty parts
    bounds = zip([0, *cuts], [*cuts, viewpoints], strict=True)
    parts = [BestRows.of(rows(block, slice(a, b)), np.arange(a, b)) for a, b in bounds]
    parts = data.draw(st.permutations(parts))
    split = data.draw(st.integers(0, len(parts)))
    groups = [reduce(BestRows.merged, group) for group in (parts[:split], parts[split:]) if group]
    assert_same(reduce(BestRows.merged, groups), whole)
    assert_same(BestRows.from_arrays(whole.arrays()), whole)


@given(seed=st.integers(0, 2**32 - 1), viewpoints=st.integers(1, 12))
def test_the_best_row_is_the_one_a_sort_finds(seed, viewpoints):
    block = table(np.random.default_rng(seed), viewpoints, 3)
    best = BestRows.of(block, np.arange(100, 100 + viewpoints))
    for j in range(3):
        order = sorted(
            range(viewpoints),
            key=lambda k: (not block.visible[k, j], -block.probability[k, j], -block.expected_accuracy[k, j], k),
        )
        assert best.viewpoint[j] == 100 + order[0]
        assert best.values.measurand[j] == block.measurand[order[0], j]
        for code in range(len(REASONS)):
            assert best.counts[j, code] == (block.reason[:, j] == code).sum()


def test_of_nothing():
    block = table(np.random.default_rng(0), 0, 3)
    nothing = BestRows.of(block, np.arange(0))
    assert nothing.viewpoint.tolist() == [-1, -1, -1]
    assert not nothing.counts.any()
    assert_same(nothing.merged(nothing), nothing)
