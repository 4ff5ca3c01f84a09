"""How far the joint model is from the full camera model over random set-ups, and which of them are flagged.

Usage: python benchmarks/validity_sweep.py [--count N] [--seed S]

Prints docs/paper/validity.md. The reference is the full camera model by randomised quasi-Monte Carlo, to 1e-3 at first
and to 1.5e-4 where that does not decide; "bad" is an error above 1e-3 by more than the half-width of the 99.9 %
interval.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

import viewgauge as vg
from viewgauge.evaluation import image_segment, success_probability
from viewgauge.evaluation.validity import probability_error, validity
from viewgauge.simulation import Sampling, estimate_success_probabilities

STRATA = ("ordinary", "wide", "harsh", "absurd")
LIMIT = 1e-3
CONFIDENCE = 0.999

INTRODUCTION = """# Validity of the small-error model

The joint model is of first order in the pose error. `viewgauge.evaluation.validity` flags the pairs of viewpoint and
characteristic for which its probability may be wrong by more than 1e-3. This page compares it with the full camera
model, by randomised quasi-Monte Carlo, over random set-ups. A set-up is *bad* if the joint model is wrong by more than
1e-3, and *good* if it is right within 1e-3, in both cases by more than the half-width of the reference's 99.9 %
interval (1.5e-4 where needed). Otherwise it is *undecided*.

- ordinary: up to 2 mrad and 0.1 % of the distance, up to 23 degrees off axis, images longer than 30 px;
- wide: up to 2 mrad and 0.2 %, up to 57 degrees off axis;
- harsh: up to 20 mrad and 3 %;
- absurd: up to 0.3 rad and 30 %, images of 1 px on, segments along the line of sight, tolerances of a thousandth to a
  hundred standard deviations, origins of the pose error frame at twice the distance.

Half of all covariances are full. The edge detectors have steps of 1, 0.1, 0.02 or 0 px. The thresholds were set on the
seeds 1 and 2 (500 set-ups per stratum each). The table shows {count} set-ups per stratum of seed {seed}, printed by
`python benchmarks/validity_sweep.py --count {count} --seed {seed}`.
"""


@dataclass(frozen=True)
class Rig:
    """A segment before a camera: points mm, camera frame; T relative."""

    stratum: str
    start: np.ndarray
    end: np.ndarray
    camera: vg.Camera
    error: vg.PoseError
    tolerance: float


@dataclass(frozen=True)
class Judged:
    """A set-up with its probabilities, the reference's half-width, the estimated error and the warning."""

    stratum: str
    joint: float
    exact: float
    half_width: float
    estimate: float
    warning: str

    @property
    def bad(self) -> bool:
        """The joint model is wrong by more than 1e-3 beyond the reference's interval."""
        return abs(self.joint - self.exact) - self.half_width > LIMIT

    @property
    def good(self) -> bool:
        """The joint model is right within 1e-3 beyond the reference's interval."""
        return abs(self.joint - self.exact) + self.half_width <= LIMIT


def draw(stratum: str, rng: np.random.Generator) -> Rig:
    """A random set-up; "ordinary" and "wide" as in practice, "harsh" at its edge, "absurd" far beyond."""
    absurd = stratum == "absurd"
    largest_angle, largest_shift = {"ordinary": (2e-3, 1e-3), "wide": (2e-3, 2e-3), "harsh": (2e-2, 3e-2)}.get(
        stratum, (0.3, 0.3)
    )
    while True:
        distance, pitch = np.exp(rng.uniform(np.log(150), np.log(2000))), rng.uniform(0.002, 0.014)
        camera = vg.Camera(
            float(rng.uniform(6, 50)),
            (pitch, pitch * rng.choice([1.0, 1.25])),
            (4000, 3000),
            edge_resolution_px=float(rng.choice([1.0, 0.1, 0.02, 0.0])),
        )
        off_axis = rng.uniform(0, {"ordinary": 0.4, "wide": 1.0, "harsh": 0.6}.get(stratum, 1.2))
        sight = Rotation.from_euler("zx", [rng.uniform(0, 2 * np.pi), off_axis]).apply([0, 0, 1])
        direction = rng.standard_normal(3)
        if absurd and rng.random() < 0.3:  # nearly along the optical axis
            direction = sight + 0.03 * rng.standard_normal(3)
        direction /= np.linalg.norm(direction)
        reach = distance * rng.uniform(0.05, 0.4)
        if absurd and rng.random() < 0.4:  # an image of 1 to 20 px
            reach = rng.uniform(1, 20) * pitch * distance / camera.focal_length_mm
        centre = sight * distance
        start, end = centre - direction * reach / 2, centre + direction * reach / 2
        length_px = np.linalg.norm(np.diff(camera.project([start, end]), axis=0)) / pitch
        if min(start[2], end[2]) > 0.05 * distance and length_px > (0.5 if absurd else 30):
            break
    return Rig(
        stratum,
        start,
        end,
        camera,
        *_error_and_tolerance(stratum, start, end, camera, largest_angle, largest_shift, rng),
    )


def _error_and_tolerance(stratum, start, end, camera, largest_angle, largest_shift, rng):  # type: ignore[no-untyped-def]
    distance = np.linalg.norm(start + end) / 2
    deviations = np.concatenate(
        [
            distance * largest_shift * 10 ** rng.uniform(-1, 0) * rng.uniform(0.3, 1, 3),
            largest_angle * 10 ** rng.uniform(-1, 0) * rng.uniform(0.3, 1, 3),
        ]
    )
    covariance = np.diag(deviations**2)
    if rng.random() < 0.5:  # correlated
        factor = rng.standard_normal((6, rng.integers(2, 9)))
        correlation = factor @ factor.T
        scale = np.sqrt(correlation.diagonal())
        covariance = correlation / np.outer(scale, scale) * np.outer(deviations, deviations)
    if rng.random() < 0.5:
        pivot = (0.0, 0.0, -camera.focal_length_mm)
    else:
        pivot = tuple(map(float, rng.normal(0, distance * {"absurd": 2.0, "harsh": 0.5}.get(stratum, 0.2), 3)))
    error = vg.PoseError(covariance, pivot_mm=pivot)
    image = image_segment(start, end, camera, error)
    deviation = float(image.total_error().std() / image.length_mm)
    if stratum == "absurd":
        return error, deviation * 10 ** rng.uniform(-3, 2)
    return error, deviation * rng.uniform(0.1, 4.5)


def judge(setup: Rig, seed: int) -> Judged:
    """Joint model, full camera model and warning of a set-up."""
    given = (setup.start, setup.end, setup.camera, setup.error, setup.tolerance)
    joint = float(success_probability(*given))
    for precision in (1e-3, 4e-4, 1.5e-4):
        estimate = estimate_success_probabilities(
            *given, sampling=Sampling(precision=precision, confidence=CONFIDENCE, seed=seed)
        )
        exact, half_width = float(estimate.probability[0]), float(estimate.half_width[0])
        if abs(abs(joint - exact) - LIMIT) > half_width:
            break
    return Judged(setup.stratum, joint, exact, half_width, float(probability_error(*given)), str(validity(*given)))


def sweep(count: int, seed: int, strata: tuple[str, ...] = STRATA) -> list[Judged]:
    """``count`` set-ups of each stratum."""
    rng = np.random.default_rng(seed)
    return [judge(draw(stratum, rng), seed) for stratum in strata for _ in range(count)]


def report(judged: list[Judged]) -> str:
    """The table of docs/paper/validity.md."""
    lines = [
        "| stratum | set-ups | largest error | bad | bad, not flagged | good | good, flagged | undecided |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for stratum in STRATA:
        rows = [j for j in judged if j.stratum == stratum]
        bad, good = [j for j in rows if j.bad], [j for j in rows if j.good]
        flagged = sum(j.warning != "" for j in good)
        largest = max(abs(j.joint - j.exact) for j in rows)
        lines.append(
            f"| {stratum} | {len(rows)} | {largest:.1e} | {len(bad)} | {sum(j.warning == '' for j in bad)} | "
            f"{len(good)} | {flagged} ({flagged / max(len(good), 1):.1%}) | {len(rows) - len(bad) - len(good)} |"
        )
    names = [j.warning for j in judged if j.warning]
    lines += ["", "Warnings given: " + ", ".join(f"{n} {names.count(n)}" for n in sorted(set(names))) + "."]
    return "\n".join(lines)


def main() -> None:
    """Sweep and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=400, help="set-ups of each stratum")
    parser.add_argument("--seed", type=int, default=3)
    arguments = parser.parse_args()
    judged = sweep(arguments.count, arguments.seed)
    print(INTRODUCTION.format(count=arguments.count, seed=arguments.seed))
    print(report(judged))


if __name__ == "__main__":
    main()
