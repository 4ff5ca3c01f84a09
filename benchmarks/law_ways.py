"""Ways to compute P(|sigma Z + a (U1 + U2 - 1) + b (U3 + U4 - 1)| <= x), ours and those a user would turn to.

Each way takes the same arrays and gives the same answer, to the accuracy stated with it. Lengths are in pixels.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import openturns as ot
from numpy.typing import NDArray
from scipy import integrate
from scipy.special import ndtr

from viewgauge.errors.joint.closed_form import central_probability
from viewgauge.errors.joint.closed_form_array import central_probability_into

__all__ = ["WAYS", "Pairs", "Way", "hard_pairs", "ordinary_pairs"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Pairs:
    """Pairs of a viewpoint and a characteristic: allowed error, normal and triangular parts, each ``(n,)``, pixels."""

    x: Array
    sigma: Array
    a: Array
    b: Array

    def first(self, count: int) -> Pairs:
        """The first ``count`` of them."""
        return Pairs(self.x[:count], self.sigma[:count], self.a[:count], self.b[:count])

    def rows(self) -> zip[tuple[float, float, float, float]]:
        """One tuple a pair, for code that takes numbers."""
        return zip(self.x.tolist(), self.sigma.tolist(), self.a.tolist(), self.b.tolist(), strict=True)


def ordinary_pairs(count: int) -> Pairs:
    """Displacements of 0.01 to 10 pixels, every angle, allowed errors of 0 to 3 standard deviations."""
    rng = np.random.default_rng(1998)
    sigma, angle = 10 ** rng.uniform(-2, 1, count), rng.uniform(0, math.pi, count)
    a, b = np.abs(np.cos(angle)), np.abs(np.sin(angle))
    return Pairs(rng.uniform(0, 3, count) * np.sqrt(sigma**2 + 1 / 6), sigma, a, b)


def hard_pairs(degrees: float) -> Pairs:
    """Segments at one angle, displacements of 0.001 to 10 pixels, allowed errors of 0.3 and 1 standard deviations."""
    sigma, share = (grid.ravel() for grid in np.meshgrid(10.0 ** np.arange(-3, 2), [0.3, 1.0]))
    a, b = (np.full(sigma.size, f(math.radians(degrees))) for f in (math.cos, math.sin))
    return Pairs(share * np.sqrt(sigma**2 + 1 / 6), sigma, a, b)


def scalar_code(pairs: Pairs) -> Array:
    """The scalar closed form, as a ufunc."""
    return central_probability(pairs.x, pairs.sigma, pairs.a, pairs.b)


def array_code(pairs: Pairs) -> Array:
    """The array closed form."""
    out = np.empty(pairs.x.size)
    central_probability_into(pairs.x, pairs.sigma, pairs.a, pairs.b, out)
    return out


_SECOND = ((-1, 1), (0, -2), (1, 1))  # second difference: where, weight
_POOL = ThreadPoolExecutor(2)


def array_code_by_two(pairs: Pairs) -> Array:
    """The array closed form, half of the pairs in each of two threads."""
    out, middle = np.empty(pairs.x.size), pairs.x.size // 2

    def compute(part: slice) -> None:
        central_probability_into(pairs.x[part], pairs.sigma[part], pairs.a[part], pairs.b[part], out[part])

    list(_POOL.map(compute, (slice(middle), slice(middle, None))))
    return out


def plain_sum(pairs: Pairs) -> Array:
    """The nine terms of the textbook closed form, by NumPy and SciPy's normal law; it cancels where a part is small."""
    sigma, a, b = pairs.sigma, pairs.a, pairs.b
    total = np.zeros_like(sigma)
    for i, wi in _SECOND:
        for j, wj in _SECOND:
            z = (i * a + j * b - pairs.x) / sigma
            square = z * z  # a power would be ten times as slow
            density = np.exp(-0.5 * square) / math.sqrt(2 * math.pi)
            total += wi * wj * (((square + 6) * square + 3) * ndtr(z) + (square + 5) * z * density)
    with np.errstate(divide="ignore", invalid="ignore"):
        return 1 - 2 * total / 24 * sigma**4 / (a * b) ** 2


def _openturns_law(sigma: float, a: float, b: float) -> ot.Distribution:
    parts = [ot.Normal(0.0, sigma), ot.Triangular(-a, 0.0, a), ot.Triangular(-b, 0.0, b)]
    return ot.LinearCombinationDistribution(parts)


def openturns_probability(pairs: Pairs) -> Array:
    """OpenTURNS as its documentation shows: the law of the sum, and the probability of an interval."""
    return np.array([_openturns_law(s, a, b).computeProbability(ot.Interval(-x, x)) for x, s, a, b in pairs.rows()])


def openturns_cdf(pairs: Pairs) -> Array:
    """OpenTURNS at its best: by symmetry one look at the cdf. Its precision viewpoints change neither time nor
    error.
    """
    return np.array([2 * _openturns_law(s, a, b).computeCDF(x) - 1 for x, s, a, b in pairs.rows()])


def _quantization_density(e: Array, a: Array, b: Array) -> Array:
    """The paper's eq. 3 as a sum of cubes; it cancels where a or b is small."""
    total = np.zeros_like(e)
    for i, wi in _SECOND:
        for j, wj in _SECOND:
            beyond = np.maximum(i * a + j * b - e, 0)
            total += wi * wj * (beyond * beyond * beyond)
    with np.errstate(divide="ignore", invalid="ignore"):
        return total / (6 * a * a * b * b)


def scipy_quad(pairs: Pairs) -> Array:
    """SciPy's adaptive quadrature of eq. 19-20: the normal law times the quantization density, its kinks given."""

    def one(x: float, sigma: float, a: float, b: float) -> float:
        steps = [(i * a + j * b, wi * wj) for i, wi in _SECOND for j, wj in _SECOND]

        def integrand(e: float) -> float:
            density = sum(weight * max(step - e, 0.0) ** 3 for step, weight in steps) / (6 * a * a * b * b)
            return (ndtr((x - e) / sigma) - ndtr((-x - e) / sigma)) * density

        kinks = sorted({min(k, a + b) for k in (abs(a - b), a, b, x)})
        return 2 * integrate.quad(integrand, 0, a + b, points=kinks, epsabs=1e-10, epsrel=0, limit=400)[0]

    return np.array([one(*row) for row in pairs.rows()])


def scipy_tplquad(pairs: Pairs) -> Array:
    """SciPy's triple quadrature of the plain convolutions, eq. 18-20: density of each part, nothing else given."""

    def one(x: float, sigma: float, a: float, b: float) -> float:
        def integrand(v: float, u: float, e: float) -> float:
            triangles = (a - abs(u)) * (b - abs(v)) / (a * a * b * b)
            return triangles * math.exp(-0.5 * ((e - u - v) / sigma) ** 2) / (sigma * math.sqrt(2 * math.pi))

        return integrate.tplquad(integrand, -x, x, -a, a, -b, b, epsabs=1e-4, epsrel=1e-4)[0]

    return np.array([one(*row) for row in pairs.rows()])


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)


def gauss_legendre(pairs: Pairs) -> Array:
    """Eq. 19-20 by 20 nodes between the kinks and where the normal law rises, all pairs at once in NumPy."""
    x, sigma, a, b = (v[:, None] for v in (pairs.x, pairs.sigma, pairs.a, pairs.b))
    rises = x + sigma * np.array([-8.0, -4.0, -2.0, 0.0, 2.0, 4.0, 8.0])
    ends = np.concatenate([0 * x, np.abs(a - b), a, b, a + b, np.clip(rises, 0, a + b)], axis=1)
    ends.sort(axis=1)
    half = 0.5 * np.diff(ends)[:, :, None]
    e = ends[:, :-1, None] + half * (1 + _NODES)
    x, sigma, a, b = (v[:, :, None] for v in (x, sigma, a, b))
    integrand = (ndtr((x - e) / sigma) - ndtr((-x - e) / sigma)) * _quantization_density(e, a, b)
    return 2 * np.sum(integrand * half * _WEIGHTS, axis=(1, 2))


def monte_carlo(draws: int) -> Callable[[Pairs], Array]:
    """Counting among draws that all pairs share, so that each costs its sum and comparison only."""

    def counted(pairs: Pairs) -> Array:
        rng, hits, block = np.random.default_rng(20), np.zeros(pairs.x.size), 25_000
        for _ in range(draws // block):
            z = rng.standard_normal(block)
            first, second = (rng.random(block) - rng.random(block) for _ in range(2))
            for k, (x, sigma, a, b) in enumerate(pairs.rows()):
                hits[k] += np.count_nonzero(np.abs(sigma * z + a * first + b * second) <= x)
        return hits / (draws // block * block)

    return counted


@dataclass(frozen=True)
class Way:
    """One way, what it states, and how much of it a benchmark run bears."""

    name: str
    compute: Callable[[Pairs], Array]
    accuracy: float
    """Largest deviation from the reference that is let pass."""
    pairs: int
    rounds: int
    extrapolated_to: float | None = None
    """The accuracy that its cost is extrapolated to, as 1 / accuracy²."""
    seconds_at_least: bool = False
    """Takes seconds however few the pairs: not for a mere test of the benchmarks."""


WAYS = {
    "array": Way("this package, array code, one thread", array_code, 1e-11, 1_000_000, 51),
    "array2": Way("this package, array code, two threads", array_code_by_two, 1e-11, 1_000_000, 51),
    "scalar": Way("this package, scalar code (the reference)", scalar_code, 1e-14, 200_000, 9),
    "plain": Way("NumPy and scipy.special.ndtr, the textbook's nine terms", plain_sum, math.inf, 100_000, 9),
    "legendre": Way("NumPy, Gauss-Legendre between the kinks, all pairs at once", gauss_legendre, 1e-3, 2_000, 7),
    "openturns": Way("OpenTURNS, computeProbability", openturns_probability, 1e-9, 300, 7),
    "openturns_cdf": Way("OpenTURNS, 2 computeCDF - 1", openturns_cdf, 1e-9, 300, 7),
    "quad": Way("SciPy quad, one integral, kinks given", scipy_quad, 1e-9, 40, 5),
    "tplquad": Way("SciPy tplquad, the plain convolutions, tolerance 1e-4", scipy_tplquad, 1e-3, 2, 3),
    "draws3": Way("NumPy Monte Carlo, standard error 1e-3", monte_carlo(250_000), 4e-3, 40, 7),
    "draws4": Way("NumPy Monte Carlo, standard error 1e-4", monte_carlo(25_000_000), 4e-4, 20, 3, 1e-9, True),
}
