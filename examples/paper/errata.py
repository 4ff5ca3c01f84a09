"""The numbers of docs/paper/errata.md: each erratum of the 1998 paper, printed against right.

Usage: python errata.py

Prints one row for each erratum. The exit code is 1 where a claim of the page does not hold.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.spatial.transform import Rotation
from scipy.special import erf

from viewgauge.errors import (
    NormalRatio,
    PointDisplacement,
    SegmentDisplacement,
    SpatialQuantization,
    covariance_numerator_denominator,
    lambdas,
    projected_length,
    projected_length_on_axis,
)

# the example of the page: a 16 mm lens, a point half a metre away, a pose error in all six directions
F = 16.0
POINT = np.array([40.0, -25.0, 500.0])  # camera frame, mm
C1, C2, C3 = POINT + np.array([0, 0, F])  # the paper's frame
ERROR = np.array([1.1e-3, -0.7e-3, 0.9e-3, 0.4, -0.3, 0.5])  # rad, rad, rad, mm, mm, mm: the paper's order
ROTATION, TRANSLATION = 1e-3, 0.5  # standard deviations, rad and mm


@dataclass(frozen=True)
class Claim:
    """One row: what was computed, as printed and right, and whether it is as the page says."""

    where: str
    what: str
    printed: str
    right: str
    holds: bool


def image_after_error(error: NDArray[np.float64]) -> float:
    """u' of the example in the paper's frame, straight from eq. 4-6 with differential rotations."""
    (dx, dy, dz), shift = error[:3], error[3:]
    rotation = np.array([[0, -dz, dy], [dz, 0, -dx], [-dy, dx, 0]])
    moved = np.array([C1, C2, C3]) + rotation @ [C1, C2, C3] + shift
    return float(F * moved[0] / (F - moved[2]))


def perspective_matrix() -> Claim:
    P = np.eye(4)
    P[2, 3] = -1 / F
    Q = np.eye(4)  # the camera frame is the world frame
    q_printed = Q.copy()
    q_printed[3, 3] = 0
    point = np.array([C1, C2, C3, 1.0])
    image = P @ Q @ point
    right = P.T @ Q @ point
    u, wanted = right[0] / right[3], F * C1 / (F - C3)
    c = (P @ q_printed @ point)[3]
    holds = np.isclose(u, wanted) and c == 0 and image[0] / image[3] == C1
    return Claim("(4), P_per", "u, mm", f"{image[0] / image[3]:.4f} (= C1)", f"{u:.4f}", bool(holds))


def last_row_of_q() -> Claim:
    q_printed = np.diag([1.0, 1, 1, 0])
    c = (q_printed @ [C1, C2, C3, 1.0])[3]
    return Claim("(4), Q", "c with the right P_per = 1 - C3/f", f"{c - C3 / F:.4f}", f"{1 - C3 / F:.4f}", c == 0)


def lambda_20() -> Claim:
    exact = image_after_error(ERROR) - F * C1 / (F - C3)
    row = np.append(ERROR, 1.0)
    values = []
    for printed in (True, False):
        numbers = lambdas(C1, C2, C3, F, printed=printed)
        values.append(float(numbers[:7] @ row / (numbers[14:] @ row)))
    holds = abs(values[1] - exact) < 1e-15 and abs(values[0] - exact) > 1e-6
    return Claim("lambda_20", f"eps_u, mm (exact {exact:.8f})", f"{values[0]:.8f}", f"{values[1]:.8f}", holds)


def sign_of_translation() -> list[Claim]:
    claims = []
    for depth in (500.0, 130.0):
        pose_error = (1.2e-3, 0.2)  # the reconstruction's: s_t / s_r = 167 mm
        wrong, right = (
            float(covariance_numerator_denominator(20, 0, depth + F, F, *pose_error, printed=p)[0])
            for p in (True, False)
        )
        law = PointDisplacement([20, 0, depth], F, paper_covariance(*pose_error))
        scale = float(law.sigma_zeta * law.sigma_chi)
        # the paper's image is the inverted one: its zeta is the negative of the law's, its chi the same
        holds = np.isclose(right / scale, -float(law.r_zeta_chi))
        holds = holds and (wrong < 0) == (depth < 167) and right > 0
        what = f"correlation at Z = {depth:.0f} mm, C1 = 20 mm"
        claims.append(Claim("(13), (14)", what, f"{wrong / scale:+.4f}", f"{right / scale:+.4f}", bool(holds)))
    return claims


def paper_covariance(rotation: float, translation: float) -> NDArray[np.float64]:
    """Covariance at the centre of projection of equal errors about the paper's origin, a focal length behind it."""
    adjoint = np.eye(6)
    adjoint[:3, 3:] = [[0, F, 0], [-F, 0, 0], [0, 0, 0]]  # [o]x with o = (0, 0, -f)
    return adjoint @ np.diag([translation**2] * 3 + [rotation**2] * 3) @ adjoint.T


def unsquared_lambda_10() -> Claim:
    number = lambdas(C1, C2, C3, F)
    variances = np.repeat([ROTATION**2, TRANSLATION**2], 3)
    right = number[7:13] ** 2 @ variances
    printed = right - number[9] ** 2 * variances[2] + number[9] * variances[2]
    law = PointDisplacement(POINT, F, paper_covariance(ROTATION, TRANSLATION))
    holds = np.isclose(np.sqrt(right), law.sigma_xi) and printed < right
    return Claim("sigma_xi^2", "sigma_xi, mm^3", f"{np.sqrt(printed):.1f}", f"{np.sqrt(right):.1f}", bool(holds))


def ratio_density(w: float, s1: float, s2: float, r: float, mu: float, printed: bool) -> float:
    """Eq. 11, as printed or with the factor 1 - r^2 in the first exponent."""
    g1, g2, rest = s1**2 - 2 * r * s1 * s2 * w + s2**2 * w**2, s1 - r * s2 * w, 1 - r**2
    inside = w**2 + g2**2 / s2**2 / (1.0 if printed else rest)
    first = s1 * s2 * np.sqrt(rest) / (np.pi * g1) * np.exp(-(mu**2) / (2 * g1) * inside)
    second = g2 * mu * s1 / (np.sqrt(2 * np.pi) * g1**1.5) * np.exp(-((mu * w) ** 2) / (2 * g1))
    return float(first + second * erf(g2 * mu / (s2 * np.sqrt(2 * rest * g1))))


def total(density: Callable[[float], float]) -> float:
    """Integral over the line, w = tan(t)."""
    return float(quad(lambda t: density(np.tan(t)) / np.cos(t) ** 2, -np.pi / 2, np.pi / 2, epsabs=1e-11, limit=400)[0])


def first_exponent() -> list[Claim]:
    claims = []
    for mu, s, r in ((1.0, 2.0, 0.5), (2.0, 1.0, 0.8)):
        wrong, right = (
            total(lambda w, p=p, mu=mu, s=s, r=r: ratio_density(w, s, s, r, mu, p))  # type: ignore[misc]
            for p in (True, False)
        )
        holds = abs(right - 1) < 1e-8 and wrong > 1.01
        holds = holds and np.isclose(ratio_density(0.3, s, s, r, mu, False), NormalRatio(s, s, r, mu).pdf(0.3))
        what = f"integral of the pdf, mu = {mu:g}, sigma = {s:g}, r = {r:g}"
        claims.append(Claim("(11), (12)", what, f"{wrong:.4f}", f"{right:.4f}", bool(holds)))
    return claims


def g1_for_h1() -> Claim:
    """Eq. 12's erf with g1, sigma_zeta, in place of h1, sigma_xi (the correlation put right)."""
    s_zeta, s_xi, s_chi, r, mu = 2.0, 1.0, 1.0, 0.5, 1.0

    def printed(w: float) -> float:
        right = ratio_density(w, s_xi, s_chi, r, mu, False)
        g1, h1 = (s**2 - 2 * r * s * s_chi * w + (s_chi * w) ** 2 for s in (s_zeta, s_xi))
        h2 = s_xi - r * s_chi * w
        factor = h2 * mu * s_xi / (np.sqrt(2 * np.pi) * h1**1.5) * np.exp(-((mu * w) ** 2) / (2 * h1))
        wrong_erf, right_erf = (erf(h2 * mu / (s_chi * np.sqrt(2 * (1 - r**2) * g))) for g in (g1, h1))
        return float(right + factor * (wrong_erf - right_erf))

    wrong, right = total(printed), total(lambda w: ratio_density(w, s_xi, s_chi, r, mu, False))
    what = "integral of the pdf, sigma_zeta = 2, sigma_xi = sigma_chi = mu = 1, r = 0.5"
    return Claim("(12), erf", what, f"{wrong:.4f}", f"{right:.4f}", abs(right - 1) < 1e-8 and abs(wrong - 1) > 0.01)


def f_equal_c3() -> Claim:
    chi = lambdas(C1, C2, F, F)[14:]
    holds = not chi.any()
    what = "largest |lambda_15..21| at C3 = f"
    return Claim("f = C3", what, "chi varies about 0", f"{np.abs(chi).max():.0f}: chi is 0", bool(holds))


def moments() -> Claim:
    law = NormalRatio(1.0, 1.0, 0.0, 2.0)
    far = [float(w**2 * law.pdf(w)) for w in (1e3, 1e4)]
    # Cauchy tails: w^2 f(w) tends to the density of the denominator at 0 times E|numerator|
    limit = np.exp(-2.0) / np.pi
    holds = np.isclose(far[1], limit, rtol=1e-6)
    return Claim("IV, variance", "w^2 pdf(w) at w = 1e3, 1e4", "-> 0", f"{far[0]:.4f}, {far[1]:.4f}", bool(holds))


def first_order_of_six() -> Claim:
    small = np.array([1e-3, 1e-3, 1e-3])
    skew = np.array([[0, -small[2], small[1]], [small[2], 0, -small[0]], [-small[1], small[0], 0]])
    off = np.abs(Rotation.from_euler("XYZ", small).as_matrix() - np.eye(3) - skew).max()
    return Claim("(6)", "largest entry of Rot Rot Rot - 1 - Delta, 1 mrad", "0", f"{off:.2e}", 1e-7 < off < 2e-6)


def quantization_at_zero() -> Claim:
    pitch = 0.01
    with np.errstate(all="ignore"):
        printed = np.tan(0.0) * (np.float64(1.0) / np.sin(0.0) * 0.004 - 0.002)
    value = float(SpatialQuantization(pitch, 0.0).pdf(0.004))
    near = float(SpatialQuantization(pitch, 1e-6).pdf(0.004))
    triangle = (1 - 0.4) / pitch
    holds = np.isnan(printed) and np.isclose(value, triangle) and np.isclose(near, triangle, rtol=1e-9)
    what = "pdf at gamma = 0, 0.4 of a 0.01 mm pixel, 1/mm"
    return Claim("(3), (17)", what, "0 times infinity", f"{value:.6f}", bool(holds))


def ends_lengths(length: float, beta: float, t_x: float, t_y: float, depth: float) -> float:
    """Image length from the two ends, projected."""
    half = length / 2 * np.array([0, np.sin(beta), np.cos(beta)])
    start, end = (np.array([t_x, t_y, depth]) + sign * half for sign in (-1, 1))
    return float(np.linalg.norm(F * (end[:2] / end[2] - start[:2] / start[2])))


def length_on_axis() -> Claim:
    length, beta, distance = 150.0, np.radians(30), 250.0
    depth = distance + F
    printed = length * F * np.sin(beta) * depth / (depth**2 + length**2 * np.cos(beta) ** 2 / 4)
    right = float(projected_length_on_axis(length, beta, distance, F))
    holds = np.isclose(right, ends_lengths(length, beta, 0, 0, depth)) and abs(printed / right - 1) > 0.05
    return Claim("(22)", "L, mm: Lw = 150, beta = 30 deg, d = 250 mm", f"{printed:.4f}", f"{right:.4f}", bool(holds))


def depth_of_21() -> Claim:
    exact = ends_lengths(60, np.pi / 3, 30, -20, POINT[2])
    with_c3 = float(projected_length(60, np.pi / 3, 30, -20, C3, F))
    right = float(projected_length(60, np.pi / 3, 30, -20, C3 - 2 * F, F))
    holds = np.isclose(right, exact) and with_c3 < 0.95 * exact
    return Claim("(21)", "L, mm, with t_z = C3 or t_z = C3 - 2f", f"{with_c3:.4f}", f"{right:.4f}", bool(holds))


def independence() -> list[Claim]:
    covariance = paper_covariance(ROTATION, TRANSLATION)
    claims = []
    for length in (30.0, 60.0):
        ends = np.array([[-length / 2, 0, 500.0], [length / 2, 0, 500.0]])
        joint, independent = spreads(ends, covariance)
        ratio = independent / joint
        what = f"sigma_d, um: Lw = {length:.0f} mm at 0.5 m, 1 mrad, 0.5 mm"
        claims.append(
            Claim("(15)-(17)", what, f"{1e3 * independent:.2f}", f"{1e3 * joint:.2f} ({ratio:.1f} times)", ratio > 10)
        )
    along = np.diag([0, 0, TRANSLATION**2, 0, 0, 0])
    joint, independent = spreads(np.array([[-30, 0, 500.0], [30, 0, 500.0]]), along)
    what = "sigma_d, um: the head errs along the axis only"
    claims.append(
        Claim(
            "(15), bound",
            what,
            f"{1e3 * independent:.4f}",
            f"{1e3 * joint:.4f} ({independent / joint:.3f} times)",
            bool(np.isclose(joint, np.sqrt(2) * independent, rtol=1e-5)),
        )
    )
    return claims


def spreads(ends: NDArray[np.float64], covariance: NDArray[np.float64]) -> tuple[float, float]:
    """Standard deviation of the length error: joint, independent (first order), mm."""
    joint = float(SegmentDisplacement.joint(*ends, F, covariance).sigma_mm)
    points = [PointDisplacement(end, F, covariance) for end in ends]
    direction = np.array([1.0, 0.0])
    variance = sum(float(((direction @ p.jacobian) @ covariance) @ (direction @ p.jacobian)) for p in points)
    return joint, float(np.sqrt(variance))


def horizontal_and_vertical() -> Claim:
    """Eq. 17 convolves two errors that one pose error makes."""
    law = PointDisplacement([300, 250, 500.0], F, paper_covariance(ROTATION, TRANSLATION))
    joint = law.jacobian @ law.covariance @ law.jacobian.T
    correlation = float(joint[0, 1] / np.sqrt(joint[0, 0] * joint[1, 1]))
    what = "correlation of eps_u and eps_v of the point (300, 250, 500) mm"
    return Claim("(17)", what, "0", f"{correlation:.4f}", correlation > 0.1)


def farther() -> Claim:
    """The spread on the axis falls by far less than Fig. 3's with fixed sigmas."""
    spread = []
    for depth in (350.0, 700.0):
        law = PointDisplacement([0, 0, depth], F, paper_covariance(1.2e-3, 0.2))
        spread.append(float(law.sigma_zeta / law.mean_chi))
    what = "spread at 700 mm over that at 350 mm, 1.2 mrad, 0.2 mm"
    ratio = spread[1] / spread[0]
    return Claim("Fig. 3", what, "0.2500 (sigmas held)", f"{ratio:.4f}", 0.8 < ratio < 1)


def all_claims() -> list[Claim]:
    return [
        perspective_matrix(),
        last_row_of_q(),
        first_order_of_six(),
        lambda_20(),
        *sign_of_translation(),
        unsquared_lambda_10(),
        *first_exponent(),
        g1_for_h1(),
        f_equal_c3(),
        moments(),
        farther(),
        quantization_at_zero(),
        *independence(),
        horizontal_and_vertical(),
        depth_of_21(),
        length_on_axis(),
    ]


def main() -> int:
    claims = all_claims()
    print("| where | what | printed | right | holds |")
    print("| --- | --- | --- | --- | --- |")
    for claim in claims:
        print(f"| {claim.where} | {claim.what} | {claim.printed} | {claim.right} | {'yes' if claim.holds else 'NO'} |")
    return 0 if all(claim.holds for claim in claims) else 1


if __name__ == "__main__":
    sys.exit(main())
