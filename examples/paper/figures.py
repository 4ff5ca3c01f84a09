"""Draw the paper's Fig. 3, 4 and 8 and the statements of its section III.

Usage: python figures.py [FOLDER]

Fig. 8 is drawn for the RECONSTRUCTION in five_viewpoints.py. Writes PNG files to docs/pictures/paper.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import matplotlib as mpl
import numpy as np
from five_viewpoints import RECONSTRUCTION, RELATIVE_TOLERANCE, Experiment, Model, estimate
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from viewgauge.errors import NormalRatio, PointDisplacement, SpatialQuantization, covariance_numerator_denominator
from viewgauge.errors.law import Law

mpl.use("Agg")

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "pictures" / "paper"
# Okabe and Ito's palette, distinct for the colour-blind; line styles and widths besides
COLOURS = ("#000000", "#E69F00", "#0072B2", "#009E73", "#D55E00", "#CC79A7")
STYLES = ("-", (0, (4, 2)), "-", (0, (6, 1.5, 1.5, 1.5)), (0, (2, 1.2)), (0, (1, 1)))
WIDTHS = (2.6, 1.6, 1.6, 1.6, 1.6, 1.6)
STYLE = {
    "font.size": 9,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "axes.titlesize": 9.5,
    "savefig.dpi": 110,
}
PALETTE = 96  # colours of a PNG
EXACT_DRAWS = 200_000


def line(axes: Axes, k: int, x: NDArray[np.float64], y: NDArray[np.float64], label: str) -> None:
    """The k-th curve of a panel."""
    axes.plot(x, y, color=COLOURS[k], linestyle=STYLES[k], linewidth=WIDTHS[k], label=label)


def draw_images(axes: Axes, experiment: Experiment) -> None:
    """E2 as the five sensors see it (the place of Fig. 7)."""
    pixels = experiment.camera.to_pixels(experiment.camera.project(experiment.ends()))
    for k, viewpoint in enumerate(experiment.viewpoints):
        line(axes, k, pixels[k, :, 0], pixels[k, :, 1], viewpoint.name)
        axes.plot(*pixels[k].T, "o", color=COLOURS[k], markersize=4)
    axes.set(
        xlim=(0, experiment.resolution[0]),
        ylim=(experiment.resolution[1], 0),
        aspect="equal",
        xlabel="u, px",
        ylabel="v, px",
        title="E2 in the five images (ss1 to ss3 overlap)",
    )
    axes.legend(loc="upper left", ncols=2)


def draw_densities(axes: Axes, law: Law, pitch_mm: float, names: Sequence[str], reach_px: float) -> None:
    """Densities of a law of five viewpoints, error in px."""
    x = np.linspace(-reach_px, reach_px, 801)
    density = law.pdf(x[:, None] * pitch_mm) * pitch_mm
    for k, name in enumerate(names):
        line(axes, k, x, density[:, k], name)
    axes.set(xlim=(-reach_px, reach_px), ylim=(0, None), xlabel="error of the image length, px", ylabel="pdf, 1/px")


def figure_8(experiment: Experiment) -> Figure:
    """Fig. 8 a to d: independent model on the left, joint model on the right."""
    figure, axes = plt.subplots(4, 2, figsize=(9, 11.5), layout="constrained")
    pitch, names = experiment.pixel_pitch_mm, [viewpoint.name for viewpoint in experiment.viewpoints]
    angle = experiment.displacement_law("joint").angle_rad
    draw_densities(axes[0, 0], SpatialQuantization(pitch, angle), pitch, names, 2)
    axes[0, 0].set_title("(a) quantization error, both models: one law for all viewpoints")
    axes[0, 0].legend()
    draw_images(axes[0, 1], experiment)
    for column, method in enumerate(("independent", "joint")):
        note = ": another scale" if method == "joint" else ""
        draw_densities(axes[1, column], experiment.displacement_law(method), pitch, names, 4)
        axes[1, column].set_title(f"(b) displacement error, {method} model{note}")
        draw_densities(axes[2, column], experiment.total_law(method), pitch, names, 4)
        axes[2, column].set_title(f"(c) total error, {method} model")
        draw_accuracy(axes[3, column], experiment, method)
    figure.suptitle("Fig. 8 for the RECONSTRUCTION (fitted parameters)")
    return figure


def draw_accuracy(axes: Axes, experiment: Experiment, method: Model) -> None:
    """Probability to keep an accuracy; the paper's numbers, or the full camera model's, at 99 %."""
    tolerance = np.linspace(0, 0.05, 301)
    length = experiment.displacement_law("joint").length_mm
    probability = experiment.total_law(method).central_probability(tolerance[:, None] * length)
    for k, viewpoint in enumerate(experiment.viewpoints):
        line(axes, k, 100 * (1 - tolerance), probability[:, k], viewpoint.name)
    if method == "independent":
        marks, label = [viewpoint.printed_probability for viewpoint in experiment.viewpoints], "printed in the paper"
    else:
        marks, label = [e.probability for e in estimate(experiment, EXACT_DRAWS)], "full camera model"
    at = 100 * (1 - RELATIVE_TOLERANCE)
    axes.axvline(at, color="0.6", linewidth=0.8)
    axes.plot([at] * len(marks), marks, "o", markerfacecolor="none", color="0.2", label=label)
    axes.set(xlim=(95, 100), ylim=(0, 1.03), xlabel="accuracy a, %", ylabel="Pr{Accuracy ≥ a}")
    axes.set_title(f"(d) probability of an accuracy, {method} model")
    axes.legend(loc="lower left")


def figure_3() -> Figure:
    """Fig. 3 with sigma = 2 (its caption) and with sigma² = 2 (its text)."""
    figure, panels = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True, layout="constrained")
    x = np.linspace(-1.5, 1.5, 1201)
    for axes, sigma, title in zip(
        panels, (2.0, np.sqrt(2.0)), ("σ = 2, as the caption says", "σ² = 2, as the text says"), strict=True
    ):
        for k, mean in enumerate((1.0, 5.0, 10.0, 20.0)):
            law = NormalRatio(sigma, sigma, 0.5, mean)
            line(axes, k, x, law.pdf(x), f"μ = {mean:g}, mode {law.mode():.3f}")
        axes.set(xlabel="error ζ/χ (unit of the ratio)", title=title, xlim=(-1.5, 1.5))
        axes.legend()
    panels[0].set(ylim=(0, None), ylabel="pdf (1/unit of the ratio)")
    figure.suptitle("Fig. 3: displacement error at four mean denominators, r = 0.5")
    return figure


def figure_4() -> Figure:
    """Fig. 4 a and b: the correlation moves the mode and raises it."""
    figure, panels = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True, layout="constrained")
    x = np.linspace(-2, 2, 1201)
    for axes, sign, title in zip(panels, (1, -1), ("(a) r ≥ 0", "(b) r ≤ 0"), strict=True):
        for k, size in enumerate((0.0, 0.2, 0.4, 0.6, 0.8, 0.9)):
            law = NormalRatio(1.0, 1.0, sign * size, 2.0)
            line(axes, k, x, law.pdf(x), f"r = {sign * size + 0.0:g}")
            axes.plot(law.mode(), law.pdf(law.mode()), "o", markersize=4, color=COLOURS[k])
        axes.set(xlabel="error ζ/χ (unit of the ratio)", title=title, xlim=(-2, 2), ylim=(0, None))
        axes.legend()
    panels[0].set_ylabel("pdf (1/unit of the ratio)")
    figure.suptitle("Fig. 4: displacement error, μ = 2, σ = 1; dots: modes")
    return figure


def draw_modes(axes: Axes) -> None:
    """The sign of the mode is the sign of the correlation."""
    correlation = np.linspace(-0.95, 0.95, 191)
    for k, mean in enumerate((2.0, 5.0, 10.0)):
        line(axes, k, correlation, NormalRatio(1.0, 1.0, correlation, mean).mode(), f"μ = {mean:g}")
    axes.set(xlabel="correlation r of ζ and χ", ylabel="mode of ζ/χ", title="The mode follows the correlation (σ = 1)")
    axes.legend()


def draw_correlation(axes: Axes, experiment: Experiment) -> None:
    """Cov(zeta, chi) is 0 on the axis; eq. 13 as printed errs in size, and at close range in sign."""
    across = np.linspace(-150, 150, 301)
    f, pose_error = experiment.focal_length_mm, (experiment.rotation_rad, experiment.translation_mm)
    for k, depth in enumerate((350.0, 130.0)):
        points = np.stack([across, np.zeros_like(across), np.full_like(across, depth)], axis=-1)
        law = PointDisplacement(points, f, experiment.pose_error.camera_covariance)
        for j, label in enumerate(("", ", eq. 13 as printed")):
            covariance, _ = covariance_numerator_denominator(across, 0, depth + f, f, *pose_error, printed=j == 1)
            line(axes, 2 * k + j, across, covariance / (law.sigma_zeta * law.sigma_chi), f"Z = {depth:.0f} mm{label}")
    axes.set(xlabel="C1, mm off the axis (paper's sign)", ylabel="correlation of ζ and χ", title="Cov = 0 on the axis")
    axes.set_ylim(-1, 1.9)
    axes.set_yticks([-1, -0.5, 0, 0.5, 1])
    axes.legend(fontsize=8, loc="upper left")


def draw_spread(axes: Axes, experiment: Experiment) -> None:
    """The horizontal displacement error grows with the angle off the axis."""
    angle = np.linspace(0, 40, 201)
    tangent, distance = np.tan(np.radians(angle)), experiment.viewpoints[2].distance_mm
    equal_depth = distance * np.stack([tangent, np.zeros_like(angle), np.ones_like(angle)], axis=-1)
    equal_distance = equal_depth * np.cos(np.radians(angle))[:, None]
    for k, (points, label) in enumerate(((equal_depth, "equal depth"), (equal_distance, "equal distance"))):
        law = PointDisplacement(points, experiment.focal_length_mm, experiment.pose_error.camera_covariance).u
        line(axes, 2 * k, angle, law.std() / experiment.pixel_pitch_mm, f"{label}, {distance:.0f} mm")
    axes.set(
        xlabel="off the axis, degrees",
        ylabel="σ of the error of u, px",
        ylim=(0, None),
        title="The spread grows off the axis",
    )
    axes.legend(loc="lower right")


def section_3(experiment: Experiment) -> Figure:
    """What section III says of the law of a point's horizontal displacement error."""
    figure, panels = plt.subplots(1, 3, figsize=(10.5, 3.6), layout="constrained")
    draw_modes(panels[0])
    draw_correlation(panels[1], experiment)
    draw_spread(panels[2], experiment)
    return figure


def write(figure: Figure, path: Path) -> None:
    """Write a PNG with a palette: small, and without date and version the same bytes for the same figure."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png")
    plt.close(figure)
    with Image.open(buffer) as image:
        image.convert("RGB").quantize(PALETTE, dither=Image.Dither.NONE).save(path, optimize=True)


def main(arguments: Sequence[str]) -> None:
    """Write all figures to a folder."""
    folder = Path(arguments[0]) if arguments else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    with plt.rc_context(STYLE):
        write(figure_3(), folder / "figure_3.png")
        write(figure_4(), folder / "figure_4.png")
        write(section_3(RECONSTRUCTION), folder / "section_3.png")
        write(figure_8(RECONSTRUCTION), folder / "figure_8.png")


if __name__ == "__main__":
    main(sys.argv[1:])
