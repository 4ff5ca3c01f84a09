"""From samples of the pose error to its covariance, with confidence, and whether a normal law is fair.

Pose error frame, perturbation on the left, translation first; mm and rad.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .pose_samples import PoseSamples

__all__ = ["CONFIDENCE", "PoseErrorEstimate", "estimate_pose_error", "small_sample_factor"]

CONFIDENCE = 0.95
"""Of the intervals."""

_EM_STEPS, _EM_CHANGE = 5000, 1e-7
_OUTLIERS = 0.01  # probability that any of the samples of a normal law is named an outlier


@dataclass(frozen=True)
class PoseErrorEstimate:
    """The law of a pose error, as samples say it is; mm and rad, translation first, pose error frame.

    Parameters
    ----------
    covariance
        ``(6, 6)``: about the mean; of the pose error alone, where the noise of measuring it is known.
    mean
        ``(6,)``: the systematic part, which a calibration can take away; zero for repeated visits.
    degrees_of_freedom
        Of the covariance.
    deviation_interval, mean_interval
        ``(6, 2)``: at :data:`CONFIDENCE`, each axis by itself (chi-squared; Student's t).
    normality
        ``(6,)`` p-values of Shapiro and Wilk's test of each axis.
    skewness_p, kurtosis_p
        Of Mardia's tests of all six together (*Biometrika* 57 (1970) 519-530); NaN where samples are too few.
    outliers
        Names of samples that are too far from the others: Hotelling's T² of each against the rest, at a probability of
        1 % for any of them (Bonferroni). They are part of all the figures.
    """

    covariance: NDArray[np.float64]
    mean: NDArray[np.float64]
    degrees_of_freedom: int
    deviation_interval: NDArray[np.float64]
    mean_interval: NDArray[np.float64]
    normality: NDArray[np.float64]
    skewness_p: float
    kurtosis_p: float
    outliers: tuple[str, ...]
    noise_share: NDArray[np.float64] | None = None
    """``(6,)``: of the variance of the samples the part that measuring them added; None where it is not known."""

    @property
    def deviation(self) -> NDArray[np.float64]:
        """``(6,)`` standard deviations."""
        return np.sqrt(self.covariance.diagonal())

    @property
    def second_moment(self) -> NDArray[np.float64]:
        """``(6, 6)``: about zero, the systematic part counted as if it were drawn anew."""
        return np.asarray(self.covariance + np.outer(self.mean, self.mean))


def estimate_pose_error(samples: PoseSamples, groups: int = 0) -> PoseErrorEstimate:
    """Covariance, mean and what can be said of them.

    Parameters
    ----------
    groups
        Number of poses that were visited repeatedly, whose means were taken away; 0 for other samples.

    Raises
    ------
    InputError
        If there are too few samples for a covariance of six errors.
    """
    from scipy.stats import chi2, shapiro, t

    errors, n = samples.errors, len(samples.errors)
    lost = groups if samples.repeated else max(1, int(np.ceil(samples.parameters / 6)))
    freedom = n - lost
    if freedom < 6:
        raise InputError(
            "too few samples for the covariance of six errors",
            key="samples",
            got=f"{n} samples, {freedom} degrees of freedom",
            expected="at least 6 degrees of freedom (samples less what was fitted to them)",
        )
    mean = np.zeros(6) if samples.repeated else errors.mean(axis=0)
    about = errors - mean
    covariance, share = about.T @ about / freedom, None
    if samples.noise is not None:
        seen = covariance.diagonal()
        covariance = _without_noise(about, samples.noise, freedom)
        share = np.clip(1 - covariance.diagonal() / np.where(seen > 0, seen, 1.0), 0.0, 1.0)
    deviation = np.sqrt(covariance.diagonal())
    tail = (1 - CONFIDENCE) / 2
    bounds = np.sqrt(freedom / chi2.ppf([1 - tail, tail], freedom))
    half = 0.0 if samples.repeated else t.ppf(1 - tail, freedom) / np.sqrt(n) * deviation
    skewness, kurtosis = _mardia(about)
    return PoseErrorEstimate(
        covariance=covariance,
        mean=mean,
        degrees_of_freedom=freedom,
        deviation_interval=deviation[:, None] * bounds,
        mean_interval=np.stack([mean - half, mean + half], axis=1),
        normality=np.array([shapiro(axis).pvalue if np.ptp(axis) > 0 else 1.0 for axis in about.T]),
        skewness_p=skewness,
        kurtosis_p=kurtosis,
        outliers=tuple(samples.names[k] for k in _outliers(about)),
        noise_share=share,
    )


def small_sample_factor(degrees_of_freedom: int, probability: float) -> float:
    """By what a standard deviation from few samples is multiplied, for a normal law to hold as much as is known.

    With ν degrees of freedom the error over its estimated standard deviation follows Student's t: within
    ``t_ν((1 + p)/2)`` of them with probability p, where a normal law would have ``z((1 + p)/2)``. Their ratio, at the
    probability that is required; 1 for many samples. For every direction of the error alike, since ``J S J^T`` of a
    Wishart matrix S is chi-squared (Muirhead, *Aspects of Multivariate Statistical Theory*, theorem 3.2.8).
    """
    from scipy.stats import norm, t

    tail = (1 + probability) / 2
    return float(t.ppf(tail, degrees_of_freedom) / norm.ppf(tail))


def _without_noise(about: NDArray[np.float64], noise: NDArray[np.float64], freedom: int) -> NDArray[np.float64]:
    """``(6, 6)``: covariance of the greatest likelihood for errors about their mean that noise was added to.

    Each is normal with covariance ``Sigma + C_i``. Expectation and maximization (Dempster, Laird and Rubin 1977), with
    the degrees of freedom in place of the number of samples.
    """
    unit = np.sqrt(np.maximum((about**2).mean(axis=0), np.finfo(float).tiny))  # mm and rad alike
    errors, added = about / unit, noise / np.outer(unit, unit)
    sigma = errors.T @ errors / freedom
    for _ in range(_EM_STEPS):
        gain = np.linalg.solve(sigma + added, np.broadcast_to(sigma, added.shape)).swapaxes(1, 2)  # S (S + C)^-1
        expected = np.einsum("nij,nj->ni", gain, errors)
        spread = sigma - gain @ sigma
        found = (expected.T @ expected + spread.sum(axis=0) * freedom / len(errors)) / freedom
        found = (found + found.T) / 2
        done = np.abs(found - sigma).max() < _EM_CHANGE
        sigma = found
        if done:
            break
    return np.asarray(sigma * np.outer(unit, unit))


def _mardia(about: NDArray[np.float64]) -> tuple[float, float]:
    """p-values of the multivariate skewness and kurtosis of samples about their mean ``(n, 6)``."""
    from scipy.stats import chi2, norm

    n, p = about.shape
    moment = about.T @ about / n
    if n <= 2 * p or np.linalg.matrix_rank(moment / _scale(moment)) < p:
        return float("nan"), float("nan")
    products = about @ np.linalg.solve(moment, about.T)
    skewness = float((products**3).sum()) / n**2
    kurtosis = float((products.diagonal() ** 2).mean())
    small = (p + 1) * (n + 1) * (n + 3) / (n * ((n + 1) * (p + 1) - 6))  # Mardia 1974, for few samples
    of_skewness = chi2.sf(small * n * skewness / 6, p * (p + 1) * (p + 2) / 6)
    of_kurtosis = 2 * norm.sf(abs(kurtosis - p * (p + 2)) / np.sqrt(8 * p * (p + 2) / n))
    return float(of_skewness), float(of_kurtosis)


def _outliers(about: NDArray[np.float64]) -> list[int]:
    """Samples that the others do not explain, the farthest first taken away, until none is left that is too far."""
    from scipy.stats import f

    left, found = list(range(len(about))), list[int]()
    limit = _OUTLIERS / len(about)
    p = about.shape[1]
    while len(left) > p + 3:
        distance = []
        for k in left:
            others = about[[m for m in left if m != k]]
            m = len(others)
            S = np.cov(others.T)
            if np.linalg.matrix_rank(S / _scale(S)) < p:
                return found
            offset = about[k] - others.mean(axis=0)
            T2 = float(offset @ np.linalg.solve(S, offset)) * m / (m + 1)
            distance.append(f.sf(T2 * (m - p) / (p * (m - 1)), p, m - p))
        farthest = int(np.argmin(distance))
        if distance[farthest] >= limit:
            break
        found.append(left.pop(farthest))
    return sorted(found)


def _scale(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    deviation = np.sqrt(np.maximum(covariance.diagonal(), np.finfo(float).tiny))
    return np.outer(deviation, deviation)
