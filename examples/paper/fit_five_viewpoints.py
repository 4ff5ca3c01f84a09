"""Find the parameters of the RECONSTRUCTION in five_viewpoints.py.

Usage: python fit_five_viewpoints.py

The text leaves much free: the lens, the image length of E2 and its direction are choices. Each choice fixes the
rest: nine unknowns, nine equations (five probabilities, one displacement law in ss1 and ss2, three equal image
lengths). They are first solved one after the other with two approximations (E2 and the focal length small against
the distance), then all together by least squares.

1. *What the numbers demand.* With image length L and direction gamma chosen, the displacement error that gives a
   printed probability follows by inverting the law of the total error.
2. *Why ss1 and ss2 can have one law and two lengths.* For E2 at the axis, half-length h, inclination beta, the
   independent model gives to second order in h/d

       sigma² = 2 f² [ s_t²/d² (1 + (h/d)² (3 cos² beta + k sin² beta)) + s_r² (1 + (h/d)² (1 + k) sin² beta) ],

   k = cos⁴ gamma + sin⁴ gamma. Translation loses what rotation gains as beta grows: at (s_t / (s_r d))² = q with
   q = (1 + k) / (3 - k) the law does not depend on beta at all.
3. *ss3.* The same formula at beta = 90° and the larger distance d3 is smaller; with that q the ratio of the spreads
   of ss3 and ss2 gives d2/d3, and equal lengths give sin(beta2) = d2/d3.
4. *ss4, ss5.* At equal distance, x = X/Z, y = Y/Z, the spread grows off the axis as

       sigma²/sigma3² = (1 + x² + y²) (1 + x² cos² gamma + y² sin² gamma).

   This gives x from ss4 and, at the same x, y from ss5; sin(beta) follows from the equal lengths.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Collection
from dataclasses import astuple, dataclass, replace
from itertools import product

import numpy as np
from five_viewpoints import RECONSTRUCTION, RELATIVE_TOLERANCE, Experiment, Viewpoint, evaluate, relations
from numpy.typing import NDArray
from scipy.optimize import brentq, least_squares

from viewgauge.errors import TotalError

PRINTED = tuple(viewpoint.printed_probability for viewpoint in RECONSTRUCTION.viewpoints)
ACCEPTED_RESIDUAL = 1e-6
LENSES_MM = (4.8, 6.5)  # wide C-mount lenses for 2/3 inch
IMAGE_LENGTHS_PX = (80, 100, 120, 150, 200)
IMAGE_ANGLES_DEG = (10, 20, 30, 40)
TILTS = tuple(product((-1, 1), repeat=2))  # E2's outer end nearer (-1) or farther (+1) than its midpoint, ss4 and ss5
Choice = tuple[float, float, float, tuple[int, int]]  # lens mm, image length px, direction deg, tilts
CLOSEST = 0.2  # smallest d2/d3 to start from
CHOSEN = (RECONSTRUCTION.focal_length_mm, 120, 25, (-1, -1))  # lens, image length, direction and tilts of the table


@dataclass(frozen=True)
class Unknowns:
    """All that a fit may change; distances in mm, angles in degrees."""

    translation_mm: float
    rotation_mrad: float
    image_angle: float
    near: float
    far: float
    beta1: float
    beta2: float
    horizontal: float
    beta4: float
    vertical: float
    beta5: float

    def experiment(self, focal_length_mm: float) -> Experiment:
        """The experiment with these unknowns; camera and E2 as in the reconstruction."""
        places = (
            (self.near, 0.0, 0.0, self.beta1),
            (self.near, 0.0, 0.0, self.beta2),
            (self.far, 0.0, 0.0, 90.0),
            (self.far, self.horizontal, 0.0, self.beta4),
            (self.far, self.horizontal, self.vertical, self.beta5),
        )
        return replace(
            RECONSTRUCTION,
            focal_length_mm=focal_length_mm,
            translation_mm=self.translation_mm,
            rotation_rad=self.rotation_mrad * 1e-3,
            image_angle_deg=self.image_angle,
            viewpoints=tuple(Viewpoint(f"ss{k + 1}", *place, PRINTED[k]) for k, place in enumerate(places)),
        )


def required_sigma_mm(probability: float, length_mm: float, angle_deg: float) -> float:
    """Displacement error that gives a probability of 99 % accuracy, mm (step 1)."""

    def excess(sigma: float) -> float:
        law = TotalError(sigma, RECONSTRUCTION.pixel_pitch_mm, np.radians(angle_deg))
        return float(law.central_probability(RELATIVE_TOLERANCE * length_mm)) - probability

    return float(brentq(excess, 1e-9, length_mm))


def required_length_mm(probability: float, sigma_mm: float, angle_deg: float) -> float:
    """Image length that gives a probability of 99 % accuracy at a displacement error, mm."""
    law = TotalError(sigma_mm, RECONSTRUCTION.pixel_pitch_mm, np.radians(angle_deg))
    return float(law.interval(probability)[1]) / RELATIVE_TOLERANCE


def directionality(angle_deg: float) -> float:
    """k = cos⁴ gamma + sin⁴ gamma (step 2)."""
    angle = np.radians(angle_deg)
    return float(np.cos(angle) ** 4 + np.sin(angle) ** 4)


def translation_share(angle_deg: float) -> float:
    """q = (s_t / (s_r d))² at which the law does not depend on the inclination (step 2)."""
    k = directionality(angle_deg)
    return (1 + k) / (3 - k)


def distance_ratio(variance_ratio: float, half_length: float, angle_deg: float) -> float:
    """d2/d3 from the variances of ss3 over ss2 and the half-length of E2 over d3 (step 3)."""
    k, q = directionality(angle_deg), translation_share(angle_deg)

    def excess(ratio: float) -> float:
        far = q * ratio**2 * (1 + k * half_length**2) + 1 + (1 + k) * half_length**2
        return far / (q + 1 + 3 * q * (half_length / ratio) ** 2) - variance_ratio

    return float(brentq(excess, CLOSEST, 1)) if excess(CLOSEST) < 0 else CLOSEST


def growth(x: float, y: float, angle_deg: float) -> float:
    """Ratio of variances off and on the axis at equal distance (step 4)."""
    angle = np.radians(angle_deg)
    return float((1 + x**2 + y**2) * (1 + (x * np.cos(angle)) ** 2 + (y * np.sin(angle)) ** 2))


def tilted_deg(x: float, y: float, angle_deg: float, tilt: int) -> float:
    """Inclination at which E2 off the axis has the image length that it has on the axis facing the camera."""
    angle = np.radians(angle_deg)
    squared = 1 + x**2 + y**2
    along = (x * np.cos(angle) + y * np.sin(angle)) ** 2 / squared
    return float(90 + tilt * (np.degrees(np.arcsin(np.sqrt((1 - along) / squared))) - 90))


def approximate(focal_length_mm: float, length_px: float, angle_deg: float, tilts: tuple[int, int]) -> Unknowns:
    """Approximate solution for a choice of lens, image length and direction (steps 1 to 4)."""
    length = length_px * RECONSTRUCTION.pixel_pitch_mm
    _, *sigmas = (required_sigma_mm(p, length, angle_deg) for p in PRINTED)
    near_sigma, far_sigma, horizontal_sigma, both_sigma = sigmas
    far = focal_length_mm * RECONSTRUCTION.length_mm / length
    ratio = distance_ratio((far_sigma / near_sigma) ** 2, length / focal_length_mm / 2, angle_deg)
    share = translation_share(angle_deg)
    short = required_length_mm(PRINTED[0], near_sigma, angle_deg)
    depth_effect = 3 * share * (length / focal_length_mm / 2 / ratio) ** 2
    rotation = near_sigma / focal_length_mm / np.sqrt(2 * (share + 1 + depth_effect))
    x = float(brentq(lambda x: growth(x, 0, angle_deg) - (horizontal_sigma / far_sigma) ** 2, 0, 2))
    y = float(brentq(lambda y: growth(x, y, angle_deg) - (both_sigma / far_sigma) ** 2, 0, 2))
    return Unknowns(
        translation_mm=np.sqrt(share) * rotation * ratio * far,
        rotation_mrad=1e3 * rotation,
        image_angle=angle_deg,
        near=ratio * far,
        far=far,
        beta1=float(np.degrees(np.arcsin(ratio * short / length))),
        beta2=float(np.degrees(np.arcsin(ratio))),
        horizontal=float(np.degrees(np.arctan(x))),
        beta4=tilted_deg(x, 0, angle_deg, tilts[0]),
        vertical=float(np.degrees(np.arctan(y))),
        beta5=tilted_deg(x, y, angle_deg, tilts[1]),
    )


def residuals(unknowns: Unknowns, focal_length_mm: float) -> NDArray[np.float64]:
    """The nine equations: probabilities, the law of ss1 and ss2, image lengths of ss2, ss4, ss5 and ss3."""
    experiment = unknowns.experiment(focal_length_mm)
    law = experiment.displacement_law("independent")
    spread = law.std()
    lengths = law.length_mm[[1, 3, 4]] / law.length_mm[2] - 1
    return np.array([*(experiment.probability("independent") - np.array(PRINTED)), spread[0] / spread[1] - 1, *lengths])


def solve(start: Unknowns, fixed: Collection[str], focal_length_mm: float) -> tuple[Unknowns, float]:
    """Unknowns that satisfy the nine equations, and the largest residual left; ``fixed`` ones keep their value."""
    free = [name for name in Unknowns.__dataclass_fields__ if name not in fixed]
    unit = np.array([getattr(start, name) for name in free])

    def unknowns(x: NDArray[np.float64]) -> Unknowns:
        return replace(start, **dict(zip(free, (x * unit).tolist(), strict=True)))

    # relative variables, kept where every angle and distance has a meaning
    found = least_squares(
        lambda x: residuals(unknowns(x), focal_length_mm), np.ones(len(free)), bounds=(0.1, 1.6), xtol=1e-12
    )
    return unknowns(found.x), float(np.abs(found.fun).max())


def family() -> tuple[dict[Choice, Experiment], Counter[str]]:
    """Choices with a solution that keeps every relation of the text, and why how many others do not."""
    members: dict[Choice, Experiment] = {}
    failures: Counter[str] = Counter()
    for choice in product(LENSES_MM, IMAGE_LENGTHS_PX, IMAGE_ANGLES_DEG, TILTS):
        found, residual = solve(approximate(*choice), ("image_angle", "far"), choice[0])
        experiment = found.experiment(choice[0])
        failed = [relation.statement for relation in relations(experiment, evaluate(experiment)) if not relation.holds]
        if residual > ACCEPTED_RESIDUAL:
            failures["the nine equations have no solution near the approximate one"] += 1
        elif failed:
            failures.update(failed)
        else:
            members[choice] = experiment
    return members, failures


def refine() -> tuple[Unknowns, Unknowns, float]:
    """The reconstruction approximately, before rounding, and the residual of the latter.

    The pose error is held at round numbers; direction and distance are freed instead.
    """
    first = approximate(*CHOSEN)
    found, _ = solve(first, ("image_angle", "far"), CHOSEN[0])
    pose_error = {"translation_mm": RECONSTRUCTION.translation_mm, "rotation_mrad": 1e3 * RECONSTRUCTION.rotation_rad}
    return first, *solve(replace(found, **pose_error), tuple(pose_error), CHOSEN[0])


def print_family() -> None:
    """One line for each member of the family, then what all have in common."""
    print("lens  L px  gamma  tilts     s_t mm  s_r mrad  d2 mm  d3 mm  beta1  beta2  off axis  Pr joint")
    members, failures = family()
    outcomes = []
    for (lens, length, angle, tilts), experiment in members.items():
        rows = evaluate(experiment)
        outcomes.append([(row.joint, row.overstatement) for row in rows])
        ss1, ss2, ss3 = experiment.viewpoints[:3]
        print(
            f"{lens:4.1f}  {length:4d}  {angle:5d}  {tilts!s:8s}  {experiment.translation_mm:6.3f}  "
            f"{1e3 * experiment.rotation_rad:8.3f}  {ss2.distance_mm:5.0f}  {ss3.distance_mm:5.0f}  "
            f"{ss1.inclination_deg:5.1f}  {ss2.inclination_deg:5.1f}  "
            f"{rows[3].off_axis_deg:.0f}, {rows[4].off_axis_deg:.0f}    " + " ".join(f"{row.joint:.3f}" for row in rows)
        )
    tried = len(LENSES_MM) * len(IMAGE_LENGTHS_PX) * len(IMAGE_ANGLES_DEG) * len(TILTS)
    print(f"\n{len(members)} of {tried} choices keep every relation. Over them:")
    low, high = np.min(outcomes, axis=0), np.max(outcomes, axis=0)
    for k, (smallest, largest) in enumerate(zip(low, high, strict=True)):
        print(
            f"ss{k + 1}: Pr joint {smallest[0]:.3f} to {largest[0]:.3f}, "
            f"independent over joint sigma {smallest[1]:.1f} to {largest[1]:.1f}"
        )
    print("The others fail at:")
    for reason, count in failures.most_common():
        print(f"  {count:3d}  {reason}")


def main() -> int:
    """Print the family, then the reconstruction before rounding."""
    print_family()
    first, found, residual = refine()
    print(f"\nThe reconstruction before rounding (largest residual {residual:.1e}); approximately, at {CHOSEN}:")
    for name, value, estimate in zip(Unknowns.__dataclass_fields__, astuple(found), astuple(first), strict=True):
        print(f"  {name:15s} {value:10.4f}  {estimate:10.4f}")
    return 0 if residual < ACCEPTED_RESIDUAL else 1


if __name__ == "__main__":
    sys.exit(main())
