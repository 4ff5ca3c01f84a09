"""The planned inspection on images: each dimension with its uncertainty and a verdict."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..exceptions import InputError
from ..io.atomic import write_text_atomically
from ..io.images import read_grey, write_overlay
from ..io.plan_reader import PlannedMeasurement, read_plan
from ..measurement.edges import EdgeFinder
from ..measurement.gauge_image import ExpectedGauge, GaugeImage, Guide, find_guide, measure_gauge
from .inspection import Inspection
from .progress import Progress, Silent
from .write import make_folder

__all__ = ["Measured", "Verdict", "measure"]

Verdict = Literal["pass", "fail", "undecided", "measured", "not measured"]

_COVERAGE_FACTOR = 2.0
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
    """One dimension in one image.

    Parameters
    ----------
    measured_mm
        None where it was not measured.
    expanded_uncertainty_mm
        U = 2 u, of the plan; None where the plan states none.
    verdict
        "pass" or "fail" where the value is inside or outside the tolerance by more than U (guarded acceptance and
        rejection, ISO 14253-1), "undecided" between; "measured" where there is no tolerance or U.
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
    progress: Progress | None = None,
) -> tuple[Measured, ...]:
    """Measure what a plan measures in images that were taken at its settings.

    Parameters
    ----------
    plan
        Folder of a plan, or its plan.json.
    images
        Folder with images ``SETTING.png`` or ``SETTING_NUMBER.png`` (or .tif, .bmp, .jpg), undistorted.
    output
        Folder for ``measurements.csv`` and a picture of each image with what was found; None for neither.

    Raises
    ------
    InputError
        If the plan cannot be read or is another part's, or there is no image of any of its settings.
    """
    planned, progress = read_plan(Path(plan)), progress or Silent()
    gauges = {(p.dimension, p.setting): _expected(p, inspection) for p in planned}
    files = _images(Path(images), sorted({p.setting for p in planned}))
    place = None if output is None else make_folder(output)
    found: list[Measured] = []
    with progress.stage(f"Measuring in {len(files)} images", len(files)) as advance:
        for file, setting in files:
            mine = [p for p in planned if p.setting == setting]
            grey = read_grey(file)
            seen, why = _seen(grey, mine, [gauges[p.dimension, p.setting] for p in mine], inspection)
            rows = [_judged(file.name, p, gauge, why) for p, gauge in zip(mine, seen, strict=True)]
            found += rows
            if place is not None:
                write_overlay(place / f"{file.stem}.png", grey, _drawn(rows, seen))
            advance(1)
    if place is not None:
        write_text_atomically(place / "measurements.csv", _table(found))
    return tuple(found)


def _expected(planned: PlannedMeasurement, inspection: Inspection) -> ExpectedGauge:
    """The gauge of the inspection's part that a plan measures."""
    for dimension in inspection.part.dimensions:
        if dimension.id == planned.dimension:
            gauge = dimension.gauge_at(planned.gauge)
            if gauge is not None:
                normals = (gauge.start_normals, gauge.end_normals)
                return ExpectedGauge(planned.gauge, normals, dimension.kind == "diameter", gauge.rim_axis)
    raise InputError(
        "the plan is of another part, or of other dimensions",
        key=planned.dimension,
        got=f"a gauge at {np.round(planned.gauge, 3).tolist()} mm",
        expected="a gauge of this part",
    )


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
    inspection: Inspection,
) -> tuple[list[GaugeImage | None], str]:
    """The gauges in an image; or none of them, and why."""
    camera, head = inspection.camera, inspection.head
    columns, rows = camera.resolution
    if grey.shape != (rows, columns):
        return [None] * len(
            planned
        ), f"the image is {grey.shape[1]} x {grey.shape[0]} px, the camera's {columns} x {rows}"
    finder, T = EdgeFinder(grey.astype(np.float64)), planned[0].T_part_camera
    guide: Guide | None = find_guide(finder, gauges, T, camera, head)
    if guide is None:
        return [None] * len(planned), "the part is not seen as planned: edges are missing or elsewhere"
    return [measure_gauge(finder, grey, gauge, T, camera, guide) for gauge in gauges], ""


def _judged(image: str, planned: PlannedMeasurement, seen: GaugeImage | None, why: str) -> Measured:
    U = None if planned.uncertainty_mm is None else _COVERAGE_FACTOR * planned.uncertainty_mm
    value = None
    if seen is not None and seen.measured_mm is not None:
        length = float(np.linalg.norm(planned.gauge[1] - planned.gauge[0]))
        value = length * seen.measured_mm / seen.nominal_mm
    reason = why if seen is None else seen.reason
    verdict = _verdict(None if value is None else value - planned.nominal_mm, planned, U)
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


def _verdict(deviation_mm: float | None, planned: PlannedMeasurement, U: float | None) -> Verdict:
    if deviation_mm is None:
        return "not measured"
    if planned.tolerance_mm is None or U is None or planned.looks > 1:  # U of several looks is that of their mean
        return "measured"
    lower, upper = planned.tolerance_mm
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
