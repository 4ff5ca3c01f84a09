"""A RECONSTRUCTION of the five-viewpoint experiment of Yang, Marefat and Ciarallo (1998), section V.

The paper prints five probabilities and what relates the five viewpoints, but no parameter. The parameters
below are FITTED (fit_five_viewpoints.py) so that the paper's independent model gives its five numbers and every
relation in its text holds. They are one member of a family, not the authors' values.

Usage: python five_viewpoints.py [--draws N]

Prints the viewpoints, the relations, and what the joint model and the full camera model say of the same viewpoints. The
exit code is 1 where a relation fails or a number is off by more than 0.005.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

import viewgauge as vg
from viewgauge.errors import IndependentTotalError, SegmentDisplacement, TotalError
from viewgauge.simulation import Estimate, estimate_success_probability

RELATIVE_TOLERANCE = 0.01  # the paper asks for 99 % accuracy
LARGEST_DEVIATION = 0.005  # of a probability from the printed one: half a unit of its last digit
SAME = 0.005  # relative difference up to which two lengths, distances or spreads count as the same
DIFFERENT_ORIENTATION_DEG = 20.0  # what counts as a significantly different orientation
GRID_PX = np.linspace(-4, 4, 801)  # errors at which densities are compared
QUANTILE = 0.95  # share of measurements for which the kept tolerance is told
DRAWS, CONFIDENCE, SEED = 1_000_000, 0.99, 1998

Model = Literal["independent", "joint"]


@dataclass(frozen=True)
class Viewpoint:
    """A viewpoint, told by where the camera sees E2.

    Parameters
    ----------
    distance_mm
        From the centre of projection to the midpoint of E2, mm.
    horizontal_deg, vertical_deg
        Direction of the midpoint off the optical axis: atan(X/Z) and atan(Y/Z), camera frame.
    inclination_deg
        Angle between E2 and the line of sight to its midpoint (on the axis, the paper's beta).
    printed_probability
        Pr{Accuracy >= 0.99} in the paper.
    """

    name: str
    distance_mm: float
    horizontal_deg: float
    vertical_deg: float
    inclination_deg: float
    printed_probability: float


@dataclass(frozen=True)
class Experiment:
    """Camera, pose error, E2 and the five viewpoints.

    Parameters
    ----------
    focal_length_mm, pixel_pitch_mm, resolution
        The camera.
    translation_mm, rotation_rad
        Standard deviations of the pose error, equal along the three axes as in the paper's section III.
    length_mm
        Length of E2.
    image_angle_deg
        Direction gamma of the image of E2 from +u, the same in all viewpoints.
    edge_resolution_px
        Step of the edge detector; 1 is the paper's whole-pixel one.
    """

    focal_length_mm: float
    pixel_pitch_mm: float
    resolution: tuple[int, int]
    translation_mm: float
    rotation_rad: float
    length_mm: float
    image_angle_deg: float
    viewpoints: tuple[Viewpoint, ...]
    edge_resolution_px: float = 1.0

    @property
    def camera(self) -> vg.Camera:
        """The camera, with square pixels."""
        return vg.Camera(
            focal_length_mm=self.focal_length_mm,
            pixel_pitch_mm=(self.pixel_pitch_mm, self.pixel_pitch_mm),
            resolution=self.resolution,
            edge_resolution_px=self.edge_resolution_px,
        )

    @property
    def pose_error(self) -> vg.PoseError:
        """Error that acts about the origin of the paper's camera frame, in the image plane."""
        return vg.PoseError.from_standard_deviations(
            self.translation_mm, self.rotation_rad, pivot_mm=(0, 0, -self.focal_length_mm)
        )

    def ends(self) -> NDArray[np.float64]:
        """Ends of E2 in each viewpoint, ``(viewpoints, 2, 3)`` mm, camera frame."""
        return np.stack(
            [segment_ends(viewpoint, self.length_mm, self.image_angle_deg) for viewpoint in self.viewpoints]
        )

    def displacement_law(self, model: Model) -> SegmentDisplacement:
        """Law of the displacement error of E2's image length (eq. 17), mm, one entry per viewpoint."""
        make = {"independent": SegmentDisplacement.independent, "joint": SegmentDisplacement.joint}[model]
        ends = self.ends()
        return make(ends[:, 0], ends[:, 1], self.focal_length_mm, self.pose_error.camera_covariance)

    def total_law(self, model: Model) -> TotalError | IndependentTotalError:
        """Law of the total error of E2's image length (eq. 19), mm, one entry per viewpoint."""
        return self.displacement_law(model).plus_quantization(self.camera.quantization_step_mm)

    def probability(self, model: Model) -> NDArray[np.float64]:
        """Pr{Accuracy >= 0.99} (eq. 20), one entry per viewpoint."""
        bound = RELATIVE_TOLERANCE * self.displacement_law(model).length_mm
        return self.total_law(model).central_probability(bound)


def segment_ends(viewpoint: Viewpoint, length_mm: float, image_angle_deg: float) -> NDArray[np.float64]:
    """Ends ``(2, 3)`` mm, camera frame, of a segment whose image has a given direction.

    The segment lies in the plane of the line of sight to its midpoint and of the image direction
    (cos gamma, sin gamma, 0), so that its image points along gamma whatever its inclination.
    """
    angle, inclination = np.radians([image_angle_deg, viewpoint.inclination_deg])
    sight = np.array([*np.tan(np.radians([viewpoint.horizontal_deg, viewpoint.vertical_deg])), 1.0])
    sight /= np.linalg.norm(sight)
    across = np.array([np.cos(angle), np.sin(angle), 0.0])
    across -= across @ sight * sight
    across /= np.linalg.norm(across)
    direction = np.cos(inclination) * sight + np.sin(inclination) * across
    return viewpoint.distance_mm * sight + length_mm / 2 * np.array([[-1.0], [1.0]]) * direction


# RECONSTRUCTION: source "fitted". The first block was chosen as plausible for 1998; the rest was then solved for.
RECONSTRUCTION = Experiment(
    focal_length_mm=4.8,  # wide C-mount lens: ss5 lies 37 degrees off the axis
    pixel_pitch_mm=0.01375,  # 2/3 inch CCD, 8.8 mm x 6.6 mm, digitized to square pixels
    resolution=(640, 480),
    translation_mm=0.2,  # a small robot's or pan-tilt head's repeatability, one standard deviation per axis
    rotation_rad=0.0012,  # 0.07 degrees
    length_mm=120.0,  # all lengths scale together: only ratios to the distances matter
    # fitted from here on
    image_angle_deg=25.7,
    viewpoints=(
        Viewpoint("ss1", 188.1, 0.0, 0.0, 13.1, 0.44),
        Viewpoint("ss2", 188.1, 0.0, 0.0, 29.8, 0.79),
        Viewpoint("ss3", 349.1, 0.0, 0.0, 90.0, 0.87),
        Viewpoint("ss4", 349.1, 32.4, 0.0, 134.5, 0.75),
        Viewpoint("ss5", 349.1, 32.4, 21.6, 142.1, 0.72),
    ),
)


@dataclass(frozen=True)
class Row:
    """What the models say of one viewpoint; lengths and spreads in px, kept tolerances relative."""

    viewpoint: Viewpoint
    off_axis_deg: float
    length_px: float
    sigma_independent_px: float
    sigma_joint_px: float
    independent: float
    joint: float
    kept_independent: float
    kept_joint: float

    @property
    def overstatement(self) -> float:
        """How many times the independent model's displacement error is the joint model's."""
        return self.sigma_independent_px / self.sigma_joint_px


@dataclass(frozen=True)
class Relation:
    """One statement of the paper's section V, whether it holds, and the numbers that say so."""

    statement: str
    holds: bool
    numbers: str


def evaluate(experiment: Experiment) -> list[Row]:
    """The five viewpoints under the independent and the joint model."""
    independent, joint = experiment.displacement_law("independent"), experiment.displacement_law("joint")
    totals = experiment.total_law("independent"), experiment.total_law("joint")
    middle, pitch = experiment.ends().mean(axis=1), experiment.pixel_pitch_mm
    columns = np.column_stack(
        [
            np.degrees(np.arctan2(np.hypot(middle[:, 0], middle[:, 1]), middle[:, 2])),
            independent.length_mm / pitch,
            independent.std() / pitch,
            joint.std() / pitch,
            experiment.probability("independent"),
            experiment.probability("joint"),
            *(total.interval(QUANTILE)[1] / independent.length_mm for total in totals),
        ]
    )
    return [Row(viewpoint, *values) for viewpoint, values in zip(experiment.viewpoints, columns.tolist(), strict=True)]


def densities(experiment: Experiment) -> NDArray[np.float64]:
    """Displacement error's pdf in the independent model, 1/px, ``(GRID_PX, viewpoints)``."""
    pitch = experiment.pixel_pitch_mm
    return experiment.displacement_law("independent").pdf(GRID_PX[:, None] * pitch) * pitch


def estimate(experiment: Experiment, draws: int) -> list[Estimate]:
    """The same probabilities by the full camera model: true rotations, euclidean length, whole pixels."""
    rng = np.random.default_rng(SEED)
    return [
        estimate_success_probability(
            start,
            end,
            experiment.camera,
            experiment.pose_error,
            RELATIVE_TOLERANCE,
            draws=draws,
            confidence=CONFIDENCE,
            rng=rng,
        )
        for start, end in experiment.ends()
    ]


def same(*values: float) -> bool:
    """Whether values agree within SAME of the largest."""
    return max(values) - min(values) <= SAME * max(values)


def numbers(form: str, values: Sequence[float]) -> str:
    """Values, each printed by the same format."""
    return ", ".join(format(value, form) for value in values)


def orientations_deg(experiment: Experiment) -> list[float]:
    """Angles between the directions of E2 in the camera frames of ss3 and ss4, ss3 and ss5, ss4 and ss5."""
    directions = np.diff(experiment.ends()[2:], axis=1)[:, 0] / experiment.length_mm
    return [float(np.degrees(np.arccos(min(1.0, abs(a @ b))))) for a, b in combinations(directions, 2)]


def relations(experiment: Experiment, rows: list[Row]) -> list[Relation]:
    """Every relation that the text of section V states, in its order."""
    return [*relations_near(experiment, rows), *relations_far(experiment, rows), *relations_of_laws(experiment, rows)]


def relations_near(experiment: Experiment, rows: list[Row]) -> list[Relation]:
    """Relations among ss1, ss2 and ss3."""
    ss1, ss2, ss3 = experiment.viewpoints[:3]
    length = [row.length_px for row in rows]
    spread = [row.sigma_independent_px for row in rows]
    peak = densities(experiment).max(axis=0).tolist()
    cdf = experiment.displacement_law("independent").cdf(GRID_PX[:, None] * experiment.pixel_pitch_mm)
    apart = float(np.abs(cdf[:, 0] - cdf[:, 1]).max())
    return [
        Relation(
            "ss1, ss2: same distance",
            same(ss1.distance_mm, ss2.distance_mm),
            numbers(".1f", (ss1.distance_mm, ss2.distance_mm)) + " mm",
        ),
        Relation(
            "ss1, ss2: E2 at the optical axis, the object turned about E2's centre",
            all(row.off_axis_deg == 0 for row in rows[:2]) and ss1.inclination_deg != ss2.inclination_deg,
            f"turned by {abs(ss2.inclination_deg - ss1.inclination_deg):.1f} deg",
        ),
        Relation("ss1: image of E2 shorter than in ss2", length[0] < length[1], numbers(".1f", length[:2]) + " px"),
        Relation(
            "ss1, ss2: same displacement law",
            same(*spread[:2]) and apart <= SAME,
            f"sigma {numbers('.4f', spread[:2])} px, cdf at most {apart:.5f} apart",
        ),
        Relation(
            "ss3: farther than ss2",
            ss3.distance_mm > ss2.distance_mm,
            numbers(".1f", (ss2.distance_mm, ss3.distance_mm)) + " mm",
        ),
        Relation(
            "ss3: E2 perpendicular to the optical axis",
            rows[2].off_axis_deg == 0 and ss3.inclination_deg == 90,
            f"{ss3.inclination_deg:.1f} deg",
        ),
        Relation("ss2, ss3: same image length", same(*length[1:3]), numbers(".1f", length[1:3]) + " px"),
        Relation(
            "ss3: displacement law narrower and higher than in ss1, ss2",
            spread[2] < min(spread[:2]) and peak[2] > max(peak[:2]),
            f"sigma {numbers('.3f', spread[:3])} px, peak {numbers('.3f', peak[:3])} /px",
        ),
    ]


def relations_far(experiment: Experiment, rows: list[Row]) -> list[Relation]:
    """Relations among ss3, ss4 and ss5."""
    ss3, ss4, ss5 = experiment.viewpoints[2:]
    length = [row.length_px for row in rows[2:]]
    spread = [row.sigma_independent_px for row in rows[2:]]
    peak = densities(experiment)[:, 2:].max(axis=0).tolist()
    turned = orientations_deg(experiment)
    return [
        Relation(
            "ss3, ss4, ss5: same distance",
            same(ss3.distance_mm, ss4.distance_mm, ss5.distance_mm),
            numbers(".1f", [s.distance_mm for s in (ss3, ss4, ss5)]) + " mm",
        ),
        Relation("ss3, ss4, ss5: same image length", same(*length), numbers(".1f", length) + " px"),
        Relation(
            "ss3 on the axis, ss4 off it horizontally, ss5 in both directions",
            ss3.horizontal_deg == ss3.vertical_deg == ss4.vertical_deg == 0
            and min(ss4.horizontal_deg, ss5.horizontal_deg, ss5.vertical_deg) > 0,
            numbers(".1f", [row.off_axis_deg for row in rows[2:]]) + " deg",
        ),
        Relation(
            "ss3, ss4, ss5: orientations of E2 differ significantly",
            min(turned) > DIFFERENT_ORIENTATION_DEG,
            numbers(".0f", turned) + " deg apart",
        ),
        Relation(
            "ss4, ss5: displacement law wider and lower than in ss3",
            spread[0] < min(spread[1:]) and peak[0] > max(peak[1:]),
            f"sigma {numbers('.3f', spread)} px, peak {numbers('.3f', peak)} /px",
        ),
    ]


def relations_of_laws(experiment: Experiment, rows: list[Row]) -> list[Relation]:
    """Relations among all five viewpoints."""
    angle = np.degrees(np.arctan(np.abs(np.tan(experiment.displacement_law("joint").angle_rad))))
    pixels = experiment.camera.to_pixels(experiment.camera.project(experiment.ends()))
    margin = float(min(pixels.min(), (np.array(experiment.resolution) - 1 - pixels).min()))
    p = [row.independent for row in rows]
    deviations = [row.independent - row.viewpoint.printed_probability for row in rows]
    return [
        Relation(
            "all: same quantization law (same angle to the pixel rows)",
            float(np.ptp(angle)) < 1e-6,
            numbers(".2f", angle.tolist()) + " deg",
        ),
        Relation("all: image of E2 inside the sensor", margin > 0, f"at least {margin:.0f} px from its border"),
        Relation(
            "ss3 the most likely accurate, then ss2, ss4, ss5, ss1",
            all(a > b for a, b in pairwise((p[2], p[1], p[3], p[4], p[0]))),
            numbers(".4f", p),
        ),
        Relation(
            f"all: probability within {LARGEST_DEVIATION} of the printed one, independent model",
            max(map(abs, deviations)) <= LARGEST_DEVIATION,
            "off by " + numbers("+.4f", deviations),
        ),
    ]


def markdown(pose_error: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    return "\n".join("| " + " | ".join(line) + " |" for line in (pose_error, ["---"] * len(pose_error), *lines))


def probability_table(rows: list[Row], exact: list[Estimate]) -> str:
    """The viewpoints and the probability of 99 % accuracy: as printed, and by the three models."""
    pose_error = [
        "viewpoint",
        "distance, mm",
        "off axis, deg",
        "beta, deg",
        "image, px",
        "paper",
        "independent",
        "joint",
    ]
    return markdown(
        [*pose_error, "full camera model", f"its {CONFIDENCE:.0%} interval"],
        [
            [
                row.viewpoint.name,
                f"{row.viewpoint.distance_mm:.1f}",
                f"{row.off_axis_deg:.1f}",
                f"{row.viewpoint.inclination_deg:.1f}",
                f"{row.length_px:.1f}",
                f"{row.viewpoint.printed_probability:.2f}",
                f"{row.independent:.4f}",
                f"{row.joint:.4f}",
                f"{camera.probability:.4f}",
                f"{camera.low:.4f} to {camera.high:.4f}",
            ]
            for row, camera in zip(rows, exact, strict=True)
        ],
    )


def spread_table(rows: list[Row]) -> str:
    """Displacement errors by both models, and the relative tolerance that 95 % of measurements keep."""
    kept = f"{QUANTILE:.0%} within"
    return markdown(
        ["viewpoint", "sigma independent, px", "sigma joint, px", "ratio", f"{kept}, independent", f"{kept}, joint"],
        [
            [
                row.viewpoint.name,
                f"{row.sigma_independent_px:.3f}",
                f"{row.sigma_joint_px:.3f}",
                f"{row.overstatement:.1f}",
                f"{row.kept_independent:.2%}",
                f"{row.kept_joint:.2%}",
            ]
            for row in rows
        ],
    )


def remedy_table(experiment: Experiment) -> str:
    """What a better edge detector or a smaller pose error would do, by both models."""
    half_pose_error = replace(
        experiment, translation_mm=experiment.translation_mm / 2, rotation_rad=experiment.rotation_rad / 2
    )
    cases = {
        "as it is": experiment,
        "edges to 0.1 px": replace(experiment, edge_resolution_px=0.1),
        "pose errors halved": half_pose_error,
    }
    return markdown(
        ["case", "model", *(viewpoint.name for viewpoint in experiment.viewpoints)],
        [
            [case, model, *(f"{p:.4f}" for p in changed.probability(model))]
            for case, changed in cases.items()
            for model in get_args(Model)
        ],
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table and the relations; 1 where one fails."""
    parser = argparse.ArgumentParser(description="A RECONSTRUCTION of the paper's five-viewpoint experiment.")
    parser.add_argument("--draws", type=int, default=DRAWS, help="draws of the full camera model per viewpoint")
    draws = parser.parse_args(arguments).draws
    rows = evaluate(RECONSTRUCTION)
    checked = relations(RECONSTRUCTION, rows)
    print("RECONSTRUCTION: the parameters are fitted, the paper prints none.\n")
    print(probability_table(rows, estimate(RECONSTRUCTION, draws)) + "\n")
    print(spread_table(rows) + "\n")
    print(remedy_table(RECONSTRUCTION) + "\n")
    for relation in checked:
        print(f"{'pass' if relation.holds else 'FAIL'}  {relation.statement}: {relation.numbers}")
    return 0 if all(relation.holds for relation in checked) else 1


if __name__ == "__main__":
    sys.exit(main())
