"""The planned inspection on images: each characteristic with its uncertainty and a verdict."""

from __future__ import annotations

import csv
import io
import json
import logging
import os
import re
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...execution.chunks import EvaluationJob, evaluator_of
from ...execution.progress import Progress, Silent
from ...formats.files.atomic import replaced_in_one_step, write_text_atomically
from ...formats.files.images import image_size, read_grey, write_overlay
from ...formats.files.spreadsheet_text import to_cell
from ...formats.plan.plan_reader import PlannedMeasurement, read_plan, read_whole_plan
from ...measurement.image.edges import EdgeFinder
from ...measurement.image.expected_edges import ExpectedMeasurand
from ...measurement.image.image_pose import ImagePose, find_image_pose
from ...measurement.image.length_law import length_law
from ...measurement.image.measurand_image import MeasurandImage, measurand_windows, measure_in_image, rehearsed
from ...part import Characteristic, PointPair
from ...planning import without_allowed_error
from ...planning.inspection import ExplicitViewpoints, Inspection
from ...simulation.image_sensor import ImageSensor
from ...simulation.partial_image import partial_image
from ...simulation.renderer import Renderer
from ..read_plan import require_plan_of
from ..write import make_folder

__all__ = ["Edges", "Measured", "Verdict", "expected_measurand", "measure", "require_edges", "seen_measurands"]

Verdict = Literal["pass", "fail", "undecided", "measured", "not measured"]
Edges = Literal["sub-pixel", "whole-pixel"]

_log = logging.getLogger(__name__)

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
    """One characteristic in one image, or the mean of its acquisitions in several.

    Parameters
    ----------
    image, viewpoint
        Of the mean of several viewpoints all of them, joined by " + ".
    measured_mm
        None where it was not measured.
    expanded_uncertainty_mm
        U = 2 u by the errors of pose and calibration, and by the noise and contrast of this image; of a mean the
        plan's. None where it was not measured.
    verdict
        "pass" or "fail" where the value is inside or outside the tolerance by more than U (guarded acceptance and
        rejection, ISO 14253-1), "undecided" between; "measured" where there is no tolerance, or of one acquisition of
        several.
    reason
        Why it was not measured; else empty.
    """

    image: str
    viewpoint: str
    characteristic: str
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
    """Measure what a plan measures in images that were taken at its viewpoints.

    Parameters
    ----------
    plan
        Folder of a plan, or its plan.json.
    images
        Folder with images ``VIEWPOINT.png`` or ``VIEWPOINT_NUMBER.png`` (or .tif, .bmp, .jpg), as the camera takes
        them: distorted, where the inspection's camera is. Images of the same number are acquisitions of one part.
    edges
        "whole-pixel": ends are put to the nearest corner of pixels, as by the 1998 paper's edge detector.
    output
        Folder for ``measurements.csv`` and a picture of each image with what was found; None for neither.

    Raises
    ------
    InputError
        If the plan cannot be read or is another part's, or there is no image of any of its viewpoints.
    """
    require_edges(edges)
    require_plan_of(read_whole_plan(Path(plan)), inspection)
    planned, progress = read_plan(Path(plan)), progress or Silent()
    if only := _rendered_only(Path(images)):
        planned = tuple(p for p in planned if p.characteristic in only)
    poses = {p.viewpoint: p.T_part_camera for p in planned}
    known = _all_seen(inspection, poses)
    measurands = {(p.characteristic, p.viewpoint): _expected(p, inspection) for p in planned}
    with progress.stage("Looking at the part from the planned viewpoints"):
        for viewpoint, T in poses.items():
            keys = [key for key in measurands if key[1] == viewpoint]
            sure = _rehearsed([*(measurands[key] for key in keys), *known[viewpoint]], T, inspection)
            measurands.update(zip(keys, sure, strict=False))
            known[viewpoint] = sure[len(keys) :]
    files = _images(Path(images), sorted({p.viewpoint for p in planned}))
    found: list[Measured] = []
    nowhere: AbstractContextManager[Path | None] = nullcontext()
    folder = nowhere if output is None else replaced_in_one_step(make_folder(output))
    with folder as place:
        with progress.stage(f"Measuring in {len(files)} images", len(files)) as advance:
            for file, viewpoint in files:
                mine = [p for p in planned if p.viewpoint == viewpoint]
                why = _other_size(file, inspection)
                if why:
                    _log.warning("%s: %s", file, why)
                    found += [_judged(file.name, p, None, why, inspection, edges) for p in mine]
                    advance(1)
                    continue
                grey = read_grey(file)
                expected = [measurands[p.characteristic, p.viewpoint] for p in mine]
                seen, why = _seen(grey, mine, expected, known[viewpoint], inspection)
                rows = [
                    _judged(file.name, p, measurand, why, inspection, edges)
                    for p, measurand in zip(mine, seen, strict=True)
                ]
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


def expected_measurand(characteristic: Characteristic, measurand: PointPair) -> ExpectedMeasurand:
    """What is looked for in an image."""
    points, normals = np.stack([measurand.start, measurand.end]), (measurand.start_normals, measurand.end_normals)
    return ExpectedMeasurand(points, normals, characteristic.kind == "diameter", measurand.rim_axis)


def seen_measurands(evaluation: EvaluationJob, T_part_camera: NDArray[np.float64]) -> dict[str, ExpectedMeasurand]:
    """The best measurand of each characteristic that a viewpoint sees, by the characteristic's id."""
    table = evaluator_of(evaluation).table(T_part_camera[None])
    characteristics = [
        (evaluation.characteristics[d], int(table.measurand[0, d])) for d in np.flatnonzero(table.visible[0])
    ]
    return {
        characteristic.id: expected_measurand(characteristic, characteristic.measurands[measurand])
        for characteristic, measurand in characteristics
    }


def _expected(planned: PlannedMeasurement, inspection: Inspection) -> ExpectedMeasurand:
    """The measurand of the inspection's part that a plan measures."""
    for characteristic in inspection.part.characteristics:
        if characteristic.id == planned.characteristic:
            measurand = characteristic.measurand_at(planned.measurand)
            if measurand is not None:
                return expected_measurand(characteristic, measurand)
    raise InputError(
        "the plan is of another part, or of other characteristics",
        key=planned.characteristic,
        got=f"a measurand at {np.round(planned.measurand, 3).tolist()} mm",
        expected="a measurand of this part",
    )


def _rendered_only(folder: Path) -> frozenset[str]:
    """The characteristics for which simulated images were rendered; none where whole images are there."""
    try:
        only = json.loads((folder / "simulation.json").read_text(encoding="utf-8"))["only"]
        return frozenset(map(str, only))
    except (OSError, ValueError, KeyError, TypeError):
        return frozenset()


def _all_seen(
    inspection: Inspection, viewpoints: Mapping[str, NDArray[np.float64]]
) -> dict[str, list[ExpectedMeasurand]]:
    """Of each viewpoint the measurands of all characteristics that it sees, planned or not: they tell where it was
    taken from.
    """
    characteristics, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    chosen = ExplicitViewpoints(tuple(viewpoints), np.array(list(viewpoints.values())))
    evaluation = EvaluationJob.of(inspection, characteristics, chosen)
    return {name: list(seen_measurands(evaluation, T).values()) for name, T in viewpoints.items()}


def _rehearsed(
    measurands: Sequence[ExpectedMeasurand], T_part_camera: NDArray[np.float64], inspection: Inspection
) -> list[ExpectedMeasurand]:
    """Measurands with the edges that are where they should be in a rendered image without noise."""
    camera, mesh = inspection.camera, inspection.part.mesh
    windows = [
        window for g in measurands for window in measurand_windows(g, T_part_camera, camera, inspection.pose_error)
    ]
    sensor, renderer = ImageSensor(blur_px=_BLUR_PX, bits=12), Renderer(mesh.vertices, mesh.triangles)
    image = partial_image(renderer, sensor, T_part_camera, camera, windows, np.random.default_rng(0)) / 4095
    finder = EdgeFinder(image, _NO_NOISE, windows)
    return [rehearsed(finder, measurand, T_part_camera, camera) for measurand in measurands]


def _images(folder: Path, viewpoints: Sequence[str]) -> list[tuple[Path, str]]:
    """Images of the viewpoints, by name."""
    if not os.path.isdir(folder):
        raise InputError("the folder of images does not exist", file=folder, hint="check the path")
    found = []
    for file in sorted(folder.iterdir()):
        if not os.path.isfile(file):  # nor a pipe, which may never be written to
            continue
        for viewpoint in viewpoints:
            if re.fullmatch(re.escape(viewpoint) + r"(_\d+)?" + _SUFFIXES, file.name, re.IGNORECASE):
                found.append((file, viewpoint))
    if not found:
        names = ", ".join(f"{viewpoint}.png or {viewpoint}_0001.png" for viewpoint in viewpoints[:2])
        raise InputError("no image of any viewpoint of the plan", file=folder, expected=names)
    return found


def _other_size(file: Path, inspection: Inspection) -> str:
    """Why an image is not one of the camera's, by the size that its header states; empty where it is."""
    (columns, rows), of_camera = image_size(file), inspection.camera.resolution
    if (columns, rows) == tuple(of_camera):
        return ""
    return f"the image is {columns} x {rows} px, the camera's {of_camera[0]} x {of_camera[1]}"


def _seen(
    grey: NDArray[np.float64],
    planned: Sequence[PlannedMeasurement],
    measurands: Sequence[ExpectedMeasurand],
    known: Sequence[ExpectedMeasurand],
    inspection: Inspection,
) -> tuple[list[MeasurandImage | None], str]:
    """The measurands in an image, found with the help of all that is known to be seen; or none of them, and why."""
    camera, pose_error = inspection.camera, inspection.pose_error
    T = planned[0].T_part_camera
    windows = [
        window for measurand in (*measurands, *known) for window in measurand_windows(measurand, T, camera, pose_error)
    ]
    finder = EdgeFinder(grey, windows=windows)
    image_pose: ImagePose | None = find_image_pose(finder, known, T, camera, pose_error)
    if image_pose is None:
        return [None] * len(planned), "the part is not seen as planned: edges are missing or elsewhere"
    return [measure_in_image(finder, grey, measurand, T, camera, image_pose) for measurand in measurands], ""


def _judged(
    image: str, planned: PlannedMeasurement, seen: MeasurandImage | None, why: str, inspection: Inspection, edges: Edges
) -> Measured:
    U = value = None
    whole = edges == "whole-pixel"
    length = None if seen is None else seen.length_mm(inspection.camera, whole)
    if seen is not None and length is not None:
        per_image_mm = float(np.linalg.norm(planned.measurand[1] - planned.measurand[0])) / seen.nominal_mm
        value = per_image_mm * length
        law = length_law(
            planned.measurand,
            planned.T_part_camera,
            inspection.camera,
            inspection.pose_error,
            seen.deviation_mm,
            whole_pixels=whole,
        )
        U = _COVERAGE_FACTOR * per_image_mm * float(law.std())
    reason = why if seen is None else seen.reason
    one_of_several = planned.acquisitions > 1
    verdict = _verdict(value, planned, None if one_of_several else U)
    return Measured(
        image,
        planned.viewpoint,
        planned.characteristic,
        planned.nominal_mm,
        value,
        U,
        planned.tolerance_mm,
        verdict,
        reason,
    )


def _means(rows: Sequence[Measured], planned: Sequence[PlannedMeasurement]) -> list[Measured]:
    """Of each characteristic of several viewpoints the mean in images of the same number, where all its viewpoints are
    there.
    """
    found = []
    for name in dict.fromkeys(p.characteristic for p in planned if p.acquisitions > 1):
        mine = [p for p in planned if p.characteristic == name]
        by_number: dict[str, dict[str, Measured]] = {}
        for row in rows:
            if row.characteristic == name:
                number = Path(row.image).stem.removeprefix(row.viewpoint)
                by_number.setdefault(number, {})[row.viewpoint] = row
        for acquisitions in by_number.values():
            if acquisitions.keys() != {p.viewpoint for p in mine}:
                continue
            of_each = [acquisitions[p.viewpoint] for p in mine]
            values = [row.measured_mm for row in of_each if row.measured_mm is not None]
            complete = len(values) == len(of_each)
            value = sum(values) / len(values) if complete else None
            u = mine[0].uncertainty_mm
            U = None if u is None or value is None else _COVERAGE_FACTOR * u
            found.append(
                replace(
                    of_each[0],
                    image=" + ".join(row.image for row in of_each),
                    viewpoint=" + ".join(row.viewpoint for row in of_each),
                    measured_mm=value,
                    expanded_uncertainty_mm=U,
                    verdict=_verdict(value, mine[0], U),
                    reason="" if complete else "not measured in all its acquisitions",
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
    rows: Sequence[Measured], seen: Sequence[MeasurandImage | None]
) -> list[tuple[str, NDArray[np.float64], tuple[int, int, int]]]:
    lines = []
    for row, measurand in zip(rows, seen, strict=True):
        if measurand is not None:
            ends = np.array([end.expected if end.found is None else end.found for end in measurand.ends])
            lines.append((row.characteristic, ends, _COLOURS[row.verdict]))
    return lines


def _table(rows: Sequence[Measured]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    columns = ["image", "viewpoint", "characteristic", "nominal_mm", "measured_mm", "deviation_mm", "U_mm"]
    writer.writerow([*columns, "lower_mm", "upper_mm", "verdict", "reason"])
    for row in rows:
        deviation = None if row.measured_mm is None else row.measured_mm - row.nominal_mm
        numbers = [row.nominal_mm, row.measured_mm, deviation, row.expanded_uncertainty_mm]
        numbers += [None, None] if row.tolerance_mm is None else list(row.tolerance_mm)
        reported = ["" if value is None else repr(float(value)) for value in numbers]
        names = [to_cell(name) for name in (row.image, row.viewpoint, row.characteristic)]
        writer.writerow([*names, *reported, row.verdict, row.reason])
    return text.getvalue()
