"""Fourier coefficients of a weighted sum of independent normal ratios and quantization, with controlled error.

The sum is ``S = sum_k W_k + Q`` with ratios ``W_k = A_k N(0, 1) / N(1, eps_k)``, correlation r_k, and Q the
quantization error of half-widths a, b. Given the denominator 1 + eps z (z standard normal) a ratio is normal, so its
characteristic function is exactly ::

    phi_k(t) = E_z exp( i t A r z / (1 + eps z) - t² A² (1 - r²) / (2 (1 + eps z)²) )

and that of the sum is the product of all with ``sinc²(a t/2) sinc²(b t/2)``. On a period [-P, P] that holds the sum the
density is the Fourier series with coefficients phi(n pi / P). What is left out, in probability:

- *denominators* beyond z_c standard deviations: at most ``8 Phi(-z_c)``, 6e-10 for 1/eps = 7.1 and 2e-12 from 8 on;
- *period*: P is such that Chernoff's bound leaves at most 1e-11 outside;
- *quadrature over z*: trapezoidal rule, which converges exponentially; halved until no coefficient moves by 1e-11;
- *terms*: doubled until the last tenth of the N coefficients is below 2e-11 (what follows falls as 1/n at least).

Where one of the last two is not met there are no coefficients. Amplitudes, half-widths and P share any unit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numba
import numpy as np

__all__ = ["SMALLEST_MEAN", "coefficients", "displacement_reach"]

SMALLEST_MEAN = 7.1
"""1/eps below which a ratio's tails are too heavy for a period."""

_NODE_REACH = 7.3  # of z; 8 Phi(-7.3) = 1.2e-12
_NODE_MARGIN = 0.7  # of the mean of a denominator: it keeps 10 % of its mean or more
_NODE_STEP = 0.36
_HALVINGS = 10
_QUADRATURE_TOLERANCE = 1e-11
_COEFFICIENT_TOLERANCE = 2e-11
_MOST_TERMS = 8192
_FREQUENCY = 7.7  # exp(-7.7²/2) = 1.3e-13
_LOG_TAIL = 26.3  # -log of 4e-12: the mass left out beyond either end

_compiled: Callable[[Any], Any] = numba.njit(cache=True, error_model="numpy")
# sums may be reordered, so that several nodes are added at once
_vectorised: Callable[[Any], Any] = numba.njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})


@_compiled
def _node_limit(eps: float) -> float:
    return min(_NODE_REACH, 1.0 / eps - _NODE_MARGIN) if eps > 0.0 else _NODE_REACH


@_compiled
def _chernoff(s: float, amp: Any, eps: Any, r: Any) -> float:
    """The x with ``exp(-s x) E exp(s S) = exp(-_LOG_TAIL)``: P(S > x) is less (s < 0: P(S < x))."""
    exponent = _LOG_TAIL
    for k in range(amp.size):
        if amp[k] == 0.0:
            continue
        limit = _node_limit(eps[k])
        count = int(limit / _NODE_STEP)
        total = 0.0
        for j in range(-count, count + 1):
            z = j * _NODE_STEP
            inverse = amp[k] / (1.0 + eps[k] * z)
            spread = s * inverse
            total += math.exp(spread * r[k] * z + 0.5 * spread * spread * (1.0 - r[k]) * (1.0 + r[k]) - 0.5 * z * z)
        exponent += math.log(total * _NODE_STEP / math.sqrt(2.0 * math.pi))
    return exponent / s


@_compiled
def displacement_reach(amp: Any, eps: Any, r: Any) -> float:
    """Half-width of an interval about 0 that holds the sum of ratios but for 1e-11."""
    widest = 0.0
    for side in (-1.0, 1.0):
        best = math.inf
        s = 7.2
        for _ in range(24):
            reach = _chernoff(side * s, amp, eps, r) * side
            if reach < best:
                best = reach
            elif best < math.inf:
                break
            s *= 0.8
        widest = max(widest, best)
    return widest


@_vectorised
def _add_nodes(amp: float, eps: float, r: float, dt: float, offset: float, step: float, re: Any, im: Any) -> float:
    """Add the integrand at the nodes ``(j + offset) step`` for all t = dt, 2 dt, …; returns the nodes' weight."""
    limit = _node_limit(eps)
    first, last = math.ceil(-limit / step - offset), math.floor(limit / step - offset)
    count = last - first + 1
    u, v, turn_re, turn_im, ratio, ratio_step = np.zeros((6, count))
    weight_sum = 0.0
    for j in range(count):
        z = (first + j + offset) * step
        u[j] = step * math.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi)
        weight_sum += u[j]
        inverse = dt * amp / (1.0 + eps * z)
        decay = 0.5 * inverse * inverse * (1.0 - r) * (1.0 + r)
        turn_re[j], turn_im[j] = math.cos(inverse * r * z), math.sin(inverse * r * z)
        # exp(-n² decay) by the ratios exp(-(2 n + 1) decay)
        ratio[j], ratio_step[j] = math.exp(-decay), math.exp(-2.0 * decay)
    for n in range(re.size):
        sum_re, sum_im = 0.0, 0.0
        for j in range(count):
            new_re = (u[j] * turn_re[j] - v[j] * turn_im[j]) * ratio[j]
            new_im = (u[j] * turn_im[j] + v[j] * turn_re[j]) * ratio[j]
            u[j], v[j] = new_re, new_im
            ratio[j] *= ratio_step[j]
            sum_re += new_re
            sum_im += new_im
        re[n] += sum_re
        im[n] += sum_im
    return weight_sum


@_compiled
def _multiply_ratio(amp: float, eps: float, r: float, dt: float, re: Any, im: Any) -> bool:
    """Multiply ``phi(n dt)``, n = 1, 2, …, of one ratio into (re, im); False where its quadrature does not converge."""
    own_re, own_im = np.zeros(re.size), np.zeros(re.size)
    weight = _add_nodes(amp, eps, r, dt, 0.0, _NODE_STEP, own_re, own_im)
    own_re /= weight
    own_im /= weight
    step = _NODE_STEP
    for _ in range(_HALVINGS):
        mid_re, mid_im = np.zeros(re.size), np.zeros(re.size)
        weight = _add_nodes(amp, eps, r, dt, 0.5, step, mid_re, mid_im)
        change = 0.0
        for n in range(re.size):
            new_re, new_im = 0.5 * (own_re[n] + mid_re[n] / weight), 0.5 * (own_im[n] + mid_im[n] / weight)
            change = max(change, abs(new_re - own_re[n]), abs(new_im - own_im[n]))
            own_re[n], own_im[n] = new_re, new_im
        step *= 0.5
        if change <= _QUADRATURE_TOLERANCE:
            for n in range(re.size):
                re[n], im[n] = re[n] * own_re[n] - im[n] * own_im[n], re[n] * own_im[n] + im[n] * own_re[n]
            return True
    return False


@_compiled
def coefficients(amp: Any, eps: Any, r: Any, a: float, b: float, period: float) -> Any:
    """``phi(n pi / period)``, n = 1, 2, …, as an array (2, N); empty where an error bound is not met."""
    count = max(int(_FREQUENCY * period / math.pi) + 1, 16)
    while count <= _MOST_TERMS:
        dt = math.pi / period
        phi = np.zeros((2, count))
        for n in range(count):
            factor = 1.0
            for width in (a, b):
                if width > 0.0:
                    half = 0.5 * width * dt * (n + 1)
                    factor *= (math.sin(half) / half) ** 2
            phi[0, n] = factor
        for k in range(amp.size):
            if amp[k] != 0.0 and not _multiply_ratio(amp[k], eps[k], r[k], dt, phi[0], phi[1]):
                return np.zeros((2, 0))
        last = 0.0
        for n in range(count - max(count // 10, 4), count):
            last = max(last, abs(phi[0, n]), abs(phi[1, n]))
        if last < _COEFFICIENT_TOLERANCE:
            return phi
        count *= 2
    return np.zeros((2, 0))
