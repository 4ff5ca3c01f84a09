"""Is what is predicted true of a real robot? Lengths on a board, in views that nothing was fitted to.

Usage: python benchmarks/real_robot.py FOLDER [--folds N] [--seed N]

FOLDER has ``cal_data.yaml``, images of a ChArUco board and robot poses (ROS-Industrial's abb example). For each fold of
the views camera, hand-eye, pose covariance and corner noise are found from the others alone, the covariance by leaving
each of those out in turn, as ``viewgauge characterize`` does. Then, in each view of the fold, every pair of corners is
a length: its image at the pose that the robot was commanded to, with its predicted standard deviation, against the
image that OpenCV's detector measures. Prints Markdown.
"""

from __future__ import annotations

import argparse
import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import viewgauge as vg
from viewgauge.evaluation import image_segment
from viewgauge.formats.poses.board_views_file import read_board_views
from viewgauge.geometry import invert, transform
from viewgauge.measurement import PoseSamples, estimate_pose_error, small_sample_factor
from viewgauge.measurement.pose.board import Intrinsics
from viewgauge.measurement.pose.robot_calibration import BoardViews, RobotCalibration, folds_of

BINS = (36.0, 75.0, 110.0, 150.0, 215.0)
PROBABILITY = 0.95


@dataclass(frozen=True)
class Lengths:
    """Of n pairs of corners: length, error measured and standard deviation predicted, mm; and the view."""

    length: np.ndarray
    error: np.ndarray
    sigma: np.ndarray
    view: np.ndarray


def predicted_and_measured(
    views: BoardViews, k: int, camera: Intrinsics, robot: RobotCalibration, covariance: np.ndarray
) -> Lengths:
    """All pairs of corners in view k."""
    T = views.T_base_flange[k]
    seen = robot.predicted(T[None])[0]
    T_camera_board, T_camera_flange = (
        (seen, invert(robot.Y) @ T) if views.in_hand == "board" else (invert(seen), invert(robot.X))
    )
    fx, fy = camera.matrix[0, 0], camera.matrix[1, 1]
    step = camera.rms_px * np.sqrt(12)  # an even error of this step has the corners' standard deviation
    pinhole = vg.Camera(1.0, (1 / fx, 1 / fy), views.resolution, edge_resolution_px=step)
    pose_error = vg.PoseError(covariance, T_camera_frame=T_camera_flange)
    corners = transform(T_camera_board, views.points_mm[k])
    places = (camera.undistorted(views.places_px[k]) - camera.matrix[:2, 2]) / [fx, fy]
    pairs = np.array(list(itertools.combinations(range(len(corners)), 2)))
    start, end = corners[pairs[:, 0]], corners[pairs[:, 1]]
    image = image_segment(start, end, pinhole, pose_error)
    length = np.linalg.norm(end - start, axis=1)
    measured = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1)
    a, b = np.abs(np.cos(image.angle_rad)), np.abs(np.sin(image.angle_rad))
    steps = np.asarray(pinhole.quantization_step_mm)
    pixels = ((a * steps[0]) ** 2 + (b * steps[1]) ** 2) / 6
    scale = length / image.length_mm
    sigma = np.sqrt(image.sigma_displacement_mm**2 + pixels) * scale
    return Lengths(length, (measured - image.length_mm) * scale, sigma, np.full(len(length), k))


def study(folder: Path, folds: int, seed: int) -> tuple[Lengths, float, int]:
    """The lengths of all held-out views, the factor for few samples (mean over folds), and how many views there are."""
    found = read_board_views(folder / "cal_data.yaml")
    views, start = found.views, found.intrinsics
    every = list(range(len(views.names)))
    results, factors = [], []
    for fold in folds_of(len(every), folds, seed):
        kept = [k for k in every if k not in fold]
        training = part_of(views, kept)
        camera, robot = training.calibrated(list(range(len(kept))), start=start)
        errors = training.held_out([[k] for k in range(len(kept))], start=start)
        noise = training.noise(camera, robot)
        character = estimate_pose_error(PoseSamples(errors, training.names, parameters=12, noise=noise))
        factors.append(small_sample_factor(character.degrees_of_freedom, PROBABILITY))
        results += [predicted_and_measured(views, k, camera, robot, character.covariance) for k in fold]
    names = ("length", "error", "sigma", "view")
    joined = Lengths(*(np.concatenate([getattr(of_view, name) for of_view in results]) for name in names))
    return joined, float(np.mean(factors)), len(every)


def part_of(views: BoardViews, rows: list[int]) -> BoardViews:
    """Some of the views, as if there were no others."""
    return BoardViews(
        tuple(views.names[k] for k in rows),
        views.T_base_flange[rows],
        tuple(views.points_mm[k] for k in rows),
        tuple(views.places_px[k] for k in rows),
        views.resolution,
        views.in_hand,
    )


def row(name: str, of: Lengths, factor: float) -> str:
    """One line of the table."""
    z = np.abs(of.error) / (of.sigma * factor)
    predicted, measured = (np.sqrt((v**2).mean()) for v in (of.sigma * factor, of.error))
    shares = " | ".join(f"{(z <= k).mean():.1%}" for k in (1, 2, 3))
    return f"| {name} | {len(z)} | {predicted:.2f} | {measured:.2f} | {predicted / measured:.2f} | {shares} |"


def report(folder: Path, folds: int, seed: int) -> list[str]:
    """Markdown of the study."""
    lengths, factor, views = study(folder, folds, seed)
    columns = (
        "length / mm",
        "lengths",
        "predicted rms / mm",
        "measured rms / mm",
        "ratio",
        "within 1 σ",
        "2 σ",
        "3 σ",
    )
    lines = [
        f"{views} views, {folds} folds, {len(lengths.length)} lengths",
        "",
        "| " + " | ".join(columns) + " |",
        "|" + " --- |" * len(columns),
        "| of a normal law | | | | | 68.3% | 95.4% | 99.7% |",
    ]
    for low, high in itertools.pairwise(BINS):
        some = (lengths.length >= low) & (lengths.length < high)
        part = Lengths(*(getattr(lengths, n)[some] for n in ("length", "error", "sigma", "view")))
        lines.append(row(f"{low:g} to {high:g}", part, 1.0))
    lines.append(row("all", lengths, 1.0))
    lines.append(row(f"all, few samples counted (× {factor:.2f})", lengths, factor))
    lines += ["", "| view | predicted rms / mm | measured rms / mm |", "| --- | --- | --- |"]
    for k in np.unique(lengths.view):
        some = lengths.view == k
        predicted, measured = (np.sqrt((v[some] ** 2).mean()) for v in (lengths.sigma, lengths.error))
        lines.append(f"| {k} | {predicted:.2f} | {measured:.2f} |")
    return lines


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--folds", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    print("\n".join(report(given.folder, given.folds, given.seed)))


if __name__ == "__main__":
    main()
