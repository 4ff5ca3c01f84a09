"""Numbers in CSV are those of Python's repr, to the byte."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from viewgauge.formats.tables.row_text import row_lines


def texts(numbers):
    lines = row_lines([b"s"], [b"d"] * len(numbers), [np.array(numbers, dtype=float)]).decode().split("\n")
    assert lines.pop() == ""
    assert all(line.startswith("s,d,") for line in lines)
    return [line.removeprefix("s,d,") for line in lines]


def as_repr(numbers):
    return ["" if np.isnan(number) else repr(number) for number in map(float, numbers)]


@settings(deadline=None)  # the first example waits for the compiler
@given(st.lists(st.floats(), min_size=1))
def test_any_double(numbers):
    assert texts(numbers) == as_repr(numbers)


@pytest.mark.parametrize(
    "numbers",
    [
        [0.0, -0.0, 1.0, -1.5, 0.1, 2 / 3, np.inf, -np.inf, np.nan, -np.nan],
        [1e-4, 9.999e-5, 1e-5, 1.5e-7, 1e15, 1e16, 123456789012345680.0, 1e22, 1e23, 9007199254740993.0],
        [5e-324, 1.5e-323, 2.2250738585072014e-308, 2.225073858507201e-308, 1.7976931348623157e308],
        2.0 ** np.arange(-1074, 1024),  # where the lower neighbour is nearer
        np.nextafter(2.0 ** np.arange(-1073, 1024), 0),
        [float(f"1e{k}") for k in range(-323, 309)],
        np.random.default_rng(1).integers(0, 2**63, 100_000, dtype=np.uint64).view(float),  # all exponents
        np.random.default_rng(2).normal(size=100_000),
        np.random.default_rng(3).integers(-(10**17), 10**17, 20_000),
        np.round(np.random.default_rng(4).random(20_000) * 1000, 3),
    ],
    ids=["signs", "decimal", "extremes", "powers of 2", "below", "powers of 10", "bits", "normal", "whole", "rounded"],
)
def test_sweeps(numbers):
    assert texts(numbers) == as_repr(numbers)


def test_rows_are_pairs_viewpoint_by_viewpoint():
    columns = [
        (np.array([0, 1, 1, 0, 0, 1]), [b"False", b"True"]),
        np.array([1.0, np.nan, 3.25, -1.0, 1e30, 0.0]),
        (np.array([2, 0, 1, 1, 0, 2], dtype=np.int8), [b"", b"x", b"long"]),
    ]
    assert row_lines([b"a", b'"b,"'], ["ü".encode(), b"", b"E3"], columns).decode() == (
        "a,ü,False,1.0,long\na,,True,,\na,E3,True,3.25,x\n"
        '"b,",ü,False,-1.0,x\n"b,",,False,1e+30,\n"b,",E3,True,0.0,long\n'
    )
    assert row_lines([], [b"d"], []) == b""
    assert row_lines([b"s"], [b"d"], []) == b"s,d\n"
