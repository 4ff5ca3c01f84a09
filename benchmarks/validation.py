"""Are the predictions true of images? The example's characteristics, the paper's five viewpoints, and where the model
ends.

Usage: python benchmarks/validation.py FOLDER [--repeats N] [--viewpoints N] [--part
images|quantization|paper|robot]

N images of each of the viewpoints in the first run, a third as many in the others (100 and 20 by default). Writes
Markdown and pictures into FOLDER; without ``--part`` all parts. What is there of a part's runs is kept: a study that
was stopped goes on.

images: displaced acquisitions of the slotted block, rendered and measured, against the law, for noise, pixels and
edges; quantization: where whole pixels are not the uniform errors that the model takes them for; paper: images and edge
maps of the reconstructed five-viewpoint experiment (the paper's Fig. 7); robot: real images (``real_robot.py``).
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np

import viewgauge as vg
from viewgauge.geometry import invert, transform
from viewgauge.jobs.images.validation_tables import describe_validation
from viewgauge.measurement.image.edges import EdgeFinder
from viewgauge.measurement.image.expected_edges import ExpectedMeasurand
from viewgauge.measurement.image.image_pose import find_image_pose
from viewgauge.measurement.image.measurand_image import measurand_windows, measure_in_image
from viewgauge.sensors import Window
from viewgauge.simulation import Estimate
from viewgauge.simulation.displaced_poses import displaced_poses
from viewgauge.simulation.image_sensor import ImageSensor
from viewgauge.simulation.partial_image import partial_image
from viewgauge.simulation.renderer import Renderer

BLOCK = Path(__file__).resolve().parents[1] / "examples" / "slotted_block" / "inspection.yaml"
CHORD_ERROR_MM = 0.001
RUNS: dict[str, dict[str, Any]] = {
    "3.45 µm, noise 0.5 %": {"noise": 0.005},
    "3.45 µm, noise 1 %": {"noise": 0.01, "share": 0.3},
    "6.9 µm, noise 0.2 %": {"noise": 0.002, "pixels": 2, "share": 0.3},
}


def images(folder: Path, viewpoints: int, acquisitions: int) -> list[str]:
    """Part images: Markdown."""
    inspection = vg.load(BLOCK, chord_error_mm=CHORD_ERROR_MM)
    documents = {}
    for number, (name, run) in enumerate(RUNS.items()):
        kept = folder / f"images_{number}_{viewpoints}_{acquisitions}.json"
        if not kept.exists():
            camera = inspection.camera
            pitch, (columns, rows) = run.get("pixels", 1) * camera.pixel_pitch_mm[0], camera.resolution
            size = (columns // run.get("pixels", 1), rows // run.get("pixels", 1))
            mine = replace(inspection, camera=replace(camera, pixel_pitch_mm=(pitch, pitch), resolution=size))
            sensor = ImageSensor(blur_px=0.6, noise=run["noise"])
            with vg.open_executor(workers=2) as executor:
                found = vg.validate(
                    mine,
                    sample=viewpoints,
                    repeats=max(round(run.get("share", 1) * acquisitions), 1),
                    sensor=sensor,
                    edges=("sub-pixel", "whole-pixel"),
                    seed=inspection.seed + number,
                    executor=executor,
                )
            kept.write_text(json.dumps(describe_validation(found)))
        documents[name] = json.loads(kept.read_text())
    return [*_pooled(documents), "", *_by_characteristic(documents)]


def _pooled(documents: dict[str, list[dict[str, Any]]]) -> list[str]:
    lines = [
        "| images | edges | acquisitions | inside 68 % | 95 % | 99 % |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name, found in documents.items():
        for one in found:
            shares = []
            for c in one["coverage"]:
                n = c["acquisitions"]
                limits = f"{100 * c['low'] / n:.1f} to {100 * c['high'] / n:.1f}"
                share = f"{100 * c['inside'] / n:.1f}"
                shares.append(f"{share if c['holds'] else f'**{share}**'} ({limits})")
            lines.append(
                f"| {name} | {one['edges']} | {one['coverage'][0]['acquisitions']} | " + " | ".join(shares) + " |"
            )
    return lines


def _by_characteristic(documents: dict[str, list[dict[str, Any]]]) -> list[str]:
    names = sorted({d["id"] for found in documents.values() for d in found[0]["characteristics"]}, key=_order)
    lines = [
        "| characteristic | " + " | ".join(documents) + " |",
        "| --- |" + " --- |" * len(documents),
    ]
    for name in names:
        cells = []
        for found in documents.values():
            row = next((d for d in found[0]["characteristics"] if d["id"] == name), None)
            if row is None or row["rms_ratio"] is None:
                cells.append("not visible")
                continue
            shares = (100 * c["inside"] / max(c["acquisitions"], 1) for c in row["coverage"])
            reported = " / ".join(
                f"{s:.1f}{'' if c['holds'] else '*'}" for s, c in zip(shares, row["coverage"], strict=True)
            )
            cells.append(f"{row['rms_ratio']:.2f}; {reported} ({row['acquisitions']})")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return lines


def _order(name: str) -> tuple[int, str]:
    digits = "".join(c for c in name.split("/")[0] if c.isdigit())
    return int(digits or 0), name


def quantization(folder: Path, viewpoints: int, acquisitions: int) -> list[str]:  # noqa: ARG001 - as all parts
    """Part quantization: two pictures and a table."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
    lines = ["| the ends move apart by | spread, least and most over lengths | by the formula |", "| --- | --- | --- |"]
    fractions = np.linspace(0, 1, 41)
    for sigma in (0.0, 0.1, 0.2, 0.3, 0.5):
        ratios = np.array([spread_of_rounding(f, sigma) for f in fractions]) / np.sqrt(1 / 6)
        reported = f"{sigma:g} px"
        (curve,) = left.plot(fractions, ratios, "o", markersize=3, label=reported)
        formula = np.sqrt(np.maximum(rounding_variance(fractions, sigma), 0) * 6)
        left.plot(fractions, formula, color=curve.get_color(), linewidth=1)
        lines.append(
            f"| {reported} | {ratios.min():.2f} to {ratios.max():.2f} | {formula.min():.2f} to {formula.max():.2f} |"
        )
    left.axhline(1, color="black", linewidth=0.8, linestyle=":")
    left.set(xlabel="fraction of a pixel in the length", ylabel="spread / that of the uniform model", ylim=(0, 1.3))
    left.set_title("A length along the rows, whole pixels", fontsize=10)
    left.legend(title="ends move apart by (σ)", fontsize=8)
    angles = np.concatenate([np.linspace(0, 5, 21), np.linspace(6, 45, 79)])
    found = np.array([edge_error(angle) for angle in angles])
    right.plot(angles, found, linewidth=1)
    right.axhline(np.sqrt(1 / 12), color="black", linewidth=0.8, linestyle=":")
    right.set(xlabel="angle between edge and rows, °", ylabel="rms error of the edge, px", ylim=(0, 0.32))
    right.set_title("An edge of 19 px in a black-and-white image", fontsize=10)
    figure.savefig(folder / "quantization.png", dpi=120)
    at = {angle: float(np.interp(angle, angles, found)) for angle in (0, 1, 2, 5, 20, 45)}
    lines += ["", "| angle between edge and rows | rms error of the edge |", "| --- | --- |"]
    return lines + [f"| {angle}° | {value:.3f} px |" for angle, value in at.items()]


def spread_of_rounding(fraction: float, sigma: float, draws: int = 200_000) -> float:
    """Standard deviation, px, of a length along the rows, 120 px and a fraction, whose ends are rounded to the grid.

    The pose error shifts both by pixels, and moves them apart by sigma.
    """
    rng = np.random.default_rng(1998)
    start = 20 * rng.standard_normal(draws)
    true = 120 + fraction + sigma * rng.standard_normal(draws)
    return float((np.floor(start + true) - np.floor(start) - true).std())


def rounding_variance(fraction: np.ndarray, sigma: float) -> np.ndarray:
    """Of the same along the rows, px²: ``1/6 - sum_k cos(2 pi k f) exp(-2 pi² k² sigma²) / (pi k)²``.

    ``f (1 - f)`` of a length with the fraction f, by its Fourier series, averaged over a normal law.
    """
    k = np.arange(1, 4000)[:, None]
    return 1 / 6 - (np.cos(2 * np.pi * k * fraction) * np.exp(-2 * (np.pi * k * sigma) ** 2) / (np.pi * k) ** 2).sum(0)


def edge_error(angle_deg: float, phases: int = 64) -> float:
    """Root mean square over phases, px, of where an edge is found of which each pixel shows more or less than half."""
    turn = np.radians(angle_deg)
    along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    v, u = np.mgrid[0:64, 0:64]
    found = []
    for phase in (np.arange(phases) + 0.5) / phases:
        offset = phase - 0.5
        inside = (u - 32) * across[0] + (v - 32) * across[1] > offset
        finder = EdgeFinder(inside.astype(float), 0.01)
        t = np.arange(-9.0, 10.0)
        places, normal = 32 + t[:, None] * along, np.broadcast_to(across, (19, 2))
        edge, _ = finder.offsets(places, normal, 3.0)
        found.append(float(np.nanmean(edge)) - offset)
    return float(np.sqrt(np.mean(np.square(found))))


def paper(folder: Path, viewpoints: int, acquisitions: int) -> list[str]:  # noqa: ARG001 - as all parts
    """Part paper: images and edge maps like Fig. 7, and Pr{accuracy >= 99 %} counted in displaced acquisitions."""
    import cv2

    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples" / "paper"))
    from five_viewpoints import RECONSTRUCTION, RELATIVE_TOLERANCE

    experiment, n = RECONSTRUCTION, 10 * acquisitions
    camera, pose_error, sensor = experiment.camera, experiment.pose_error, ImageSensor(blur_px=0.6, noise=0.01)
    figure, axes = plt.subplots(2, 5, figsize=(13, 4.2), layout="constrained")
    lines = [
        "| viewpoint | paper | independent | joint | ends rounded | counted in images | 99 % interval | measured |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    models = [experiment.probability(model) for model in ("independent", "joint")]
    T = np.eye(4)  # the part stands in the camera's frame
    for k, (viewpoint, ends) in enumerate(zip(experiment.viewpoints, experiment.ends(), strict=True)):
        vertices, triangles, measurands = block_of_edge(ends)
        renderer = Renderer(vertices, triangles)
        whole = [Window.whole(camera)]
        grey = partial_image(renderer, sensor, T, camera, whole, np.random.default_rng(k))
        edges = cv2.Canny(grey.astype(np.uint8), 45, 110)
        places = camera.to_pixels(camera.project(ends))
        shown = camera.to_pixels(camera.project(vertices))
        u, v = np.clip((shown.min(axis=0) + shown.max(axis=0)) / 2, [100, 75], np.array(camera.resolution) - [101, 76])
        for row, picture in enumerate((grey, 255 - edges)):
            axes[row, k].imshow(picture, cmap="gray", vmin=0, vmax=255, interpolation="none")
            axes[row, k].set(xticks=[], yticks=[], xlim=(u - 100, u + 100), ylim=(v + 75, v - 75))
        axes[0, k].plot(*places.T, color="#e69f00", linewidth=1)
        axes[0, k].set_title(f"{viewpoint.name}: E2 {np.linalg.norm(places[1] - places[0]):.0f} px", fontsize=9)
        windows = [window for measurand in measurands for window in measurand_windows(measurand, T, camera, pose_error)]
        errors = []
        for acquisition, pose in enumerate(displaced_poses(T, pose_error, n, np.random.default_rng([1998, k]))):
            rng = np.random.default_rng([1998, k, acquisition])
            image = partial_image(renderer, sensor, pose, camera, windows, rng) / 255
            finder = EdgeFinder(image, 0.0101, windows)
            image_pose = find_image_pose(finder, measurands, T, camera, pose_error)
            if image_pose is not None:
                seen = measure_in_image(finder, image, measurands[0], T, camera, image_pose)
                found = seen.length_mm(camera, whole_pixels=True)
                if found is not None:
                    errors.append(found / seen.nominal_mm - 1)
        moved = transform(invert(displaced_poses(T, pose_error, 200_000, np.random.default_rng(k)))[:, None], ends)
        corners = np.floor(camera.to_pixels(camera.project(moved)))
        length = np.linalg.norm(places[1] - places[0])
        rounded = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1) / length - 1
        inside = int((np.abs(errors) <= RELATIVE_TOLERANCE).sum())
        counted = Estimate.of(inside, len(errors), 0.99)
        cells = [f"{viewpoint.printed_probability:.2f}", *(f"{model[k]:.3f}" for model in models)]
        cells += [f"{(np.abs(rounded) <= RELATIVE_TOLERANCE).mean():.3f}", f"{counted.probability:.3f}"]
        cells += [f"{counted.low:.3f} to {counted.high:.3f}", f"{len(errors)} of {n}"]
        lines.append(f"| {viewpoint.name} | " + " | ".join(cells) + " |")
    figure.savefig(folder / "paper_figure_7.png", dpi=110)
    return lines


def robot(folder: Path, viewpoints: int, acquisitions: int) -> list[str]:  # noqa: ARG001 - as all parts
    """Part robot: lengths on a board that a real robot carries, in views that nothing was fitted to."""
    from real_robot import report

    data = Path(__file__).resolve().parents[2] / "shared" / "data" / "abb_charuco"
    return report(data, 10, 0) if data.is_dir() else [f"left out: {data} is not there"]


def block_of_edge(ends: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[ExpectedMeasurand]]:
    """A block of which E2 is the edge that is turned to the camera, and its edges along E2, E2 first; camera frame."""
    middle, along = ends.mean(axis=0), ends[1] - ends[0]
    length = np.linalg.norm(along)
    along = along / length
    away = middle - middle @ along * along  # from the camera, square to E2
    away = away / np.linalg.norm(away)
    side = np.cross(along, away)
    first, second = (away + side) / np.sqrt(2), (away - side) / np.sqrt(2)  # into the block
    a, b = 0.45 * length * first, 0.35 * length * second
    corners = np.array([end + i * a + j * b for end in ends for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])
    faces = [[0, 1, 2, 3], [7, 6, 5, 4], [4, 5, 1, 0], [7, 4, 0, 3], [5, 6, 2, 1], [6, 7, 3, 2]]
    triangles = np.array([t for p, q, r, s in faces for t in ([p, q, r], [p, r, s])])
    normal = np.cross(
        corners[triangles[:, 1]] - corners[triangles[:, 0]], corners[triangles[:, 2]] - corners[triangles[:, 0]]
    )
    outward = np.einsum("ij,ij->i", normal, corners[triangles].mean(axis=1) - corners.mean(axis=0))
    triangles[outward < 0] = triangles[outward < 0][:, ::-1]
    sides = [(-first, -second), (first, -second), (-first, second)]
    starts = [corners[0], corners[1], corners[3]]
    measurands = [
        ExpectedMeasurand(
            np.stack([start, start + length * along]),
            (np.stack([*normals, -along]), np.stack([*normals, along])),
        )
        for start, normals in zip(starts, sides, strict=True)
    ]
    return corners, triangles, measurands


PARTS: dict[str, Callable[[Path, int, int], list[str]]] = {
    "images": images,
    "quantization": quantization,
    "paper": paper,
    "robot": robot,
}


def main() -> int:
    """Run the parts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--repeats", type=int, default=100)
    parser.add_argument("--viewpoints", type=int, default=20)
    parser.add_argument("--part", choices=list(PARTS))
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for name, part in PARTS.items():
        if given.part in (None, name):
            lines = part(given.folder, given.viewpoints, given.repeats)
            (given.folder / f"{name}.md").write_text("\n".join(lines) + "\n")
            print("\n".join([f"## {name}", "", *lines, ""]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
