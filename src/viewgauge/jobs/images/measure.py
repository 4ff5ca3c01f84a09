"""The planned inspection on images: each dimension with its uncertainty and a verdict."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...execution.chunks import EvaluationJob, evaluator_of
from ...execution.progress import Progress, Silent
from ...formats.files.atomic import write_text_atomically
from ...formats.files.images import read_grey, write_overlay
from ...formats.plan.plan_reader import PlannedMeasurement, read_plan
from ...measurement.image.edges import EdgeFinder
from ...measurement.image.expected_edges import ExpectedGauge
from ...measurement.image.image_pose import Guide, find_guide
from ...measurement.image.length_law import length_law
from ...measurement.image.measurand_image import GaugeImage, gauge_windows, measure_gauge, rehearsed
from ...part import Dimension, Gauge
from ...planning import without_allowed_error
from ...planning.inspection import ExplicitSettings, Inspection
from ...simulation.image_sensor import ImageSensor
from ...simulation.partial_image import partial_image
from ...simulation.renderer import Renderer
from ..write import make_folder

__all__ = ["Edges", "Measured", "Verdict", "expected_gauge", "measure", "require_edges", "seen_gauges"]

Verdict = Literal["pass", "fail", "undecided", "measured", "not measured"]
Edges = Literal["sub-pixel", "whole-pixel"]

_COVERAGE_FACTOR = 2.0
_BLUR_PX, _NO_NOISE = 0.6, 5e-4  # of the image of a rehearsal
_COLOURS = {
    "pass": (106, 160, 0),
    "fail": (0, 0, 208),
    "undecided": (0, 159, 230),
    "measured": (178, 114, 0),
    "not measured": (160, 160, 160),
}
_SUFFIXES = r"\.(png|tif|tiff|bmp|jpg|jpeg)"


@dataclass(frozen=True)
class Measured:
    """One dimension in one image, or the mean of its looks in several.

    Parameters
    ----------
    image, setting
        Of the mean of several looks all of them, joined by " + ".
    measured_mm
        None where it was not measured.
    expanded_uncertainty_mm
        U = 2 u by the errors of head and calibration, and by the noise and contrast of this image; of a mean the
        plan's. None where it was not measured.
    verdict
        "pass" or "fail" where the value is inside or outside the tolerance by more than U (guarded acceptance and
        rejection, ISO 14253-1), "undecided" between; "measured" where there is no tolerance, or of one look of several.
    reason
        Why it was not measured; else empty.
    """

    image: str
    setting: str
    dimension: str
    nominal_mm: float
    measured_mm: float | None
    expanded_uncertainty_mm: float | None
    tolerance_mm: tuple[float, float] | None
    verdict: Verdict
    reason: str = ""


def measure(
    inspection: Inspection,
    plan: str | PathLike[str],
    images: str | PathLike[str],
    output: str | PathLike[str] | None = None,
    *,
    edges: Edges = "sub-pixel",
    progress: Progress | None = None,
) -> tuple[Measured, ...]:
    """Measure what a plan measures in images that were taken at its settings.

    Parameters
    ----------
    plan
        Folder of a plan, or its plan.json.
    images
        Folder with images ``SETTING.png`` or ``SETTING_NUMBER.png`` (or .tif, .bmp, .jpg), as the camera gives them:
        distorted, where the inspection's camera is. Images of the same number are looks of one part.
    edges
        "whole-pixel": ends are put to the nearest corner of pixels, as by the 1998 paper's locator.
    output
        Folder for ``measurements.csv`` and a picture of each image with what was found; None for neither.

    Raises
    ------
    InputError
        If the plan cannot be read or is another part's, or there is no image of any of its settings.
    """
    require_edges(edges)
    planned, progress = read_plan(Path(plan)), progress or Silent()
    poses = {p.setting: p.T_part_camera for p in planned}
    known = _all_seen(inspection, poses)
    gauges = {(p.dimension, p.setting): _expected(p, inspection) for p in planned}
    with progress.stage("Looking at the part from the planned settings"):
        for setting, T in poses.items():
            keys = [key for key in gauges if key[1] == setting]
            sure = _rehearsed([*(gauges[key] for key in keys), *known[setting]], T, inspection)
            gauges.update(zip(keys, sure, strict=False))
            known[setting] = sure[len(keys) :]
    files = _images(Path(images), sorted({p.setting for p in planned}))
    place = None if output is None else make_folder(output)
    found: list[Measured] = []
    with progress.stage(f"Measuring in {len(files)} images", len(files)) as advance:
        for file, setting in files:
            mine = [p for p in planned if p.setting == setting]
            grey = read_grey(file)
            expected = [gauges[p.dimension, p.setting] for p in mine]
            seen, why = _seen(grey, mine, expected, known[setting], inspection)
            rows = [_judged(file.name, p, gauge, why, inspection, edges) for p, gauge in zip(mine, seen, strict=True)]
            found += rows
            if place is not None:
                write_overlay(place / f"{file.stem}.png", grey, _drawn(rows, seen))
            advance(1)
    found += _means(found, planned)
    if place is not None:
        write_text_atomically(place / "measurements.csv", _table(found))
    return tuple(found)


def require_edges(edges: str) -> None:
    """Raise InputError for what is neither "sub-pixel" nor "whole-pixel"."""
    if edges not in ("sub-pixel", "whole-pixel"):
        raise InputError("unknown way to find edges", key="edges", got=edges, expected="sub-pixel or whole-pixel")


def expected_gauge(dimension: Dimension, gauge: Gauge) -> ExpectedGauge:
    """What is looked for in an image."""
    points, normals = np.stack([gauge.start, gauge.end]), (gauge.start_normals, gauge.end_normals)
    return ExpectedGauge(points, normals, dimension.kind == "diameter", gauge.rim_axis)


def seen_gauges(evaluation: EvaluationJob, T_part_camera: NDArray[np.float64]) -> dict[str, ExpectedGauge]:
    """The best gauge of each dimension that a setting sees, by the dimension's id."""
    table = evaluator_of(evaluation).table(T_part_camera[None])
    dimensions = [(evaluation.dimensions[d], int(table.gauge[0, d])) for d in np.flatnonzero(table.visible[0])]
    return {dimension.id: expected_gauge(dimension, dimension.gauges[gauge]) for dimension, gauge in dimensions}


def _expected(planned: PlannedMeasurement, inspection: Inspection) -> ExpectedGauge:
    """The gauge of the inspection's part that a plan measures."""
    for dimension in inspection.part.dimensions:
        if dimension.id == planned.dimension:
            gauge = dimension.gauge_at(planned.gauge)
            if gauge is not None:
                return expected_gauge(dimension, gauge)
    raise InputError(
        "the plan is of another part, or of other dimensions",
        key=planned.dimension,
        got=f"a gauge at {np.round(planned.gauge, 3).tolist()} mm",
        expected="a gauge of this part",
    )


def _all_seen(inspection: Inspection, settings: Mapping[str, NDArray[np.float64]]) -> dict[str, list[ExpectedGauge]]:
    """Of each setting the gauges of all dimensions that it sees, planned or not: they tell where it was taken from."""
    dimensions, _ = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    chosen = ExplicitSettings(tuple(settings), np.array(list(settings.values())))
    evaluation = EvaluationJob.of(inspection, dimensions, chosen)
    return {name: list(seen_gauges(evaluation, T).values()) for name, T in settings.items()}


def _rehearsed(
    gauges: Sequence[ExpectedGauge], T_part_camera: NDArray[np.float64], inspection: Inspection
) -> list[ExpectedGauge]:
    """Gauges with the edges that are where they should be in a rendered image without noise."""
    camera, mesh = inspection.camera, inspection.part.mesh
    windows = [window for g in gauges for window in gauge_windows(g, T_part_camera, camera, inspection.head)]
    sensor, renderer = ImageSensor(blur_px=_BLUR_PX, bits=12), Renderer(mesh.vertices, mesh.triangles)
    image = partial_image(renderer, sensor, T_part_camera, camera, windows, np.random.default_rng(0)) / 4095
    finder = EdgeFinder(image, _NO_NOISE, windows)
    return [rehearsed(finder, gauge, T_part_camera, camera) for gauge in gauges]


def _images(folder: Path, settings: Sequence[str]) -> list[tuple[Path, str]]:
    """Images of the settings, by name."""
    if not folder.is_dir():
        raise InputError("the folder of images does not exist", file=folder, hint="check the path")
    found = []
    for file in sorted(folder.iterdir()):
        for setting in settings:
            if re.fullmatch(re.escape(setting) + r"(_\d+)?" + _SUFFIXES, file.name, re.IGNORECASE):
                found.append((file, setting))
    if not found:
        names = ", ".join(f"{setting}.png or {setting}_0001.png" for setting in settings[:2])
        raise InputError("no image of any setting of the plan", file=folder, expected=names)
    return found


def _seen(
    grey: NDArray[np.float64],
    planned: Sequence[PlannedMeasurement],
    gauges: Sequence[ExpectedGauge],
    known: Sequence[ExpectedGauge],
    inspection: Inspection,
) -> tuple[list[GaugeImage | None], str]:
    """The gauges in an image, found with the help of all that is known to be seen; or none of them, and why."""
    camera, head = inspection.camera, inspection.head
    columns, rows = camera.resolution
    if grey.shape != (rows, columns):
        why = f"the image is {grey.shape[1]} x {grey.shape[0]} px, the camera's {columns} x {rows}"
        return [None] * len(planned), why
    T = planned[0].T_part_camera
    windows = [window for gauge in (*gauges, *known) for window in gauge_windows(gauge, T, camera, head)]
    finder = EdgeFinder(grey, windows=windows)
    guide: Guide | None = find_guide(finder, known, T, camera, head)
    if guide is None:
        return [None] * len(planned), "the part is not seen as planned: edges are missing or elsewhere"
    return [measure_gauge(finder, grey, gauge, T, camera, guide) for gauge in gauges], ""


def _judged(
    image: str, planned: PlannedMeasurement, seen: GaugeImage | None, why: str, inspection: Inspection, edges: Edges
) -> Measured:
    U = value = None
    whole = edges == "whole-pixel"
    length = None if seen is None else seen.length_mm(inspection.camera, whole)
    if seen is not None and length is not None:
        per_image_mm = float(np.linalg.norm(planned.gauge[1] - planned.gauge[0])) / seen.nominal_mm
        value = per_image_mm * length
        law = length_law(
            planned.gauge,
            planned.T_part_camera,
            inspection.camera,
            inspection.head,
            seen.deviation_mm,
            whole_pixels=whole,
        )
        U = _COVERAGE_FACTOR * per_image_mm * float(law.std())
    reason = why if seen is None else seen.reason
    one_of_several = planned.looks > 1
    verdict = _verdict(value, planned, None if one_of_several else U)
    return Measured(
        image,
        planned.setting,
        planned.dimension,
        planned.nominal_mm,
        value,
        U,
        planned.tolerance_mm,
        verdict,
        reason,
    )


def _means(rows: Sequence[Measured], planned: Sequence[PlannedMeasurement]) -> list[Measured]:
    """Of each dimension of several looks the mean in images of the same number, where all its settings are there."""
    found = []
    for name in dict.fromkeys(p.dimension for p in planned if p.looks > 1):
        mine = [p for p in planned if p.dimension == name]
        by_number: dict[str, dict[str, Measured]] = {}
        for row in rows:
            if row.dimension == name:
                number = Path(row.image).stem.removeprefix(row.setting)
                by_number.setdefault(number, {})[row.setting] = row
        for looks in by_number.values():
            if looks.keys() != {p.setting for p in mine}:
                continue
            of_each = [looks[p.setting] for p in mine]
            values = [row.measured_mm for row in of_each if row.measured_mm is not None]
            complete = len(values) == len(of_each)
            value = sum(values) / len(values) if complete else None
            u = mine[0].uncertainty_mm
            U = None if u is None or value is None else _COVERAGE_FACTOR * u
            found.append(
                replace(
                    of_each[0],
                    image=" + ".join(row.image for row in of_each),
                    setting=" + ".join(row.setting for row in of_each),
                    measured_mm=value,
                    expanded_uncertainty_mm=U,
                    verdict=_verdict(value, mine[0], U),
                    reason="" if complete else "not measured in all its looks",
                )
            )
    return found


def _verdict(value_mm: float | None, planned: PlannedMeasurement, U: float | None) -> Verdict:
    if value_mm is None:
        return "not measured"
    if planned.tolerance_mm is None or U is None:
        return "measured"
    (lower, upper), deviation_mm = planned.tolerance_mm, value_mm - planned.nominal_mm
    if lower + U <= deviation_mm <= upper - U:
        return "pass"
    return "fail" if deviation_mm < lower - U or deviation_mm > upper + U else "undecided"


def _drawn(
    rows: Sequence[Measured], seen: Sequence[GaugeImage | None]
) -> list[tuple[str, NDArray[np.float64], tuple[int, int, int]]]:
    lines = []
    for row, gauge in zip(rows, seen, strict=True):
        if gauge is not None:
            ends = np.array([end.expected if end.found is None else end.found for end in gauge.ends])
            lines.append((row.dimension, ends, _COLOURS[row.verdict]))
    return lines


def _table(rows: Sequence[Measured]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    columns = ["image", "setting", "dimension", "nominal_mm", "measured_mm", "deviation_mm", "U_mm"]
    writer.writerow([*columns, "lower_mm", "upper_mm", "verdict", "reason"])
    for row in rows:
        deviation = None if row.measured_mm is None else row.measured_mm - row.nominal_mm
        numbers = [row.nominal_mm, row.measured_mm, deviation, row.expanded_uncertainty_mm]
        numbers += [None, None] if row.tolerance_mm is None else list(row.tolerance_mm)
        told = ["" if value is None else repr(float(value)) for value in numbers]
        writer.writerow([row.image, row.setting, row.dimension, *told, row.verdict, row.reason])
    return text.getvalue()
