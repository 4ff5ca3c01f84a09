"""Ways to phi(z) and Phi(-z) that were tried for the inner loop of the kernel."""

from __future__ import annotations

import math
from collections.abc import Callable

import numba
import numpy as np
import pytest
from scipy.special import ndtr

from viewgauge.errors.joint.closed_form_array import _normal

pytestmark = pytest.mark.benchmark(group="tried")

_FLOATS = {"contract", "nsz"}
_PER_UNIT = 32  # nodes of the table
_NODES = np.arange(9 * _PER_UNIT + 2) / _PER_UNIT
_TABLE = np.stack([ndtr(-_NODES), np.exp(-0.5 * _NODES**2) / math.sqrt(2 * math.pi)], axis=1).ravel()


@numba.njit(error_model="numpy", fastmath=_FLOATS)
def _polynomials(z: np.ndarray, density: np.ndarray, tail: np.ndarray) -> None:
    for k in range(z.size):
        density[k], mills = _normal(z[k])
        tail[k] = density[k] * mills


@numba.njit(error_model="numpy", fastmath=_FLOATS)
def _table(z: np.ndarray, density: np.ndarray, tail: np.ndarray) -> None:
    for k in range(z.size):
        node = int(z[k] * _PER_UNIT + 0.5)
        c = node * (1.0 / _PER_UNIT)
        d, q, p = z[k] - c, _TABLE[2 * node], _TABLE[2 * node + 1]
        e = -(c + 0.5 * d) * d
        power = 1 + e * (1 / 5 + e * (1 / 30 + e * (1 / 210 + e / 1680)))
        power = 1 + e * (1 + e * (1 / 2 + e * (1 / 6 + e * (1 / 24) * power)))
        h = c * c
        s = ((h - 6) * h + 3) / 120 - d * ((h - 10) * h + 15) * c / 720
        s = d * (1 + d * (-c / 2 + d * ((h - 1) / 6 + d * (-(h - 3) * c / 24 + d * s))))
        density[k], tail[k] = p * power, q - p * s


@numba.njit(error_model="numpy", fastmath=_FLOATS)
def _library(z: np.ndarray, density: np.ndarray, tail: np.ndarray) -> None:
    for k in range(z.size):
        density[k] = math.exp(-0.5 * z[k] * z[k]) * 0.3989422804014327
        tail[k] = 0.5 * math.erfc(z[k] * 0.7071067811865476)


@pytest.mark.parametrize("way", ["polynomials", "table", "library"])
def test_normal_law(way: str, tiny: bool, timed: Callable[..., None]) -> None:
    """One thread, values in the first-level cache, in random order."""
    z = np.random.default_rng(0).uniform(0, 9, 64 if tiny else 2048)
    density, tail = np.empty(z.size), np.empty(z.size)
    name, call = {
        "polynomials": ("two polynomials", _polynomials),
        "table": ("table and Taylor step", _table),
        "library": ("math.exp and math.erfc", _library),
    }[way]
    call(z, density, tail)
    assert np.abs(tail - ndtr(-z)).max() < 1e-13
    assert np.abs(density - np.exp(-0.5 * z * z) / math.sqrt(2 * math.pi)).max() < 1e-13
    times = 2 if tiny else 500

    def many() -> None:
        for _ in range(times):
            call(z, density, tail)

    timed(many, count=times * z.size, unit="pairs phi, Phi", rounds=15, name=name)
