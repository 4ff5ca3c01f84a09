"""Parameters of ratios of normals: ordinary, degenerate and harsh ones."""

import math

import numpy as np
from hypothesis import strategies as st


def correlations():
    """Ordinary, none, a hair off ±1, and ±1 itself."""
    return st.one_of(st.sampled_from([0.0, 1e-12, -1.0, 1.0, 1 - 1e-12, -1 + 1e-9]), st.floats(-1.0, 1.0))


def means():
    """Of the denominator, in any sign: 0, near 0, ordinary and huge."""
    return st.one_of(st.sampled_from([0.0, 1e-9, 5.0, -5.0, 1e9]), st.floats(-50.0, 50.0))


def sigmas():
    """Standard deviations, positive, over eight decades."""
    return st.one_of(st.just(1.0), st.floats(-4.0, 4.0).map(lambda exponent: 10.0**exponent))


def ratios():
    """(s1, s2, r, mu) with s1, s2 > 0, and not so near a single point that doubles cannot tell."""
    return st.tuples(sigmas(), sigmas(), correlations(), means()).filter(
        lambda p: math.sqrt(1 - abs(p[2])) + abs(p[3]) / p[1] > 1e-6
    )


def steady_ratios():
    """(s1, s2, r, mu) as displacement errors are: the denominator at least eight standard deviations from 0."""
    return st.tuples(
        st.one_of(st.sampled_from([0.0, 1.0]), st.floats(1e-3, 10.0)),
        st.one_of(st.sampled_from([0.0, 0.125]), st.floats(1e-6, 0.125)),
        st.one_of(st.sampled_from([0.0, 0.999]), st.floats(-0.999, 0.999)),
        st.just(1.0),
    )


def pixels():
    """Pixel pitches (width, height) against errors of about 1: none, narrow, wide."""
    side = st.one_of(st.sampled_from([0.0, 1e-9, 1.0, 1e3]), st.floats(1e-3, 100.0))
    return st.tuples(side, side).map(np.array)
