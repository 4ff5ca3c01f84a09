"""Images of the part as a camera takes them that is sent to viewpoints and does not quite get there."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...execution.chunks import EvaluationJob
from ...execution.progress import Progress, Silent
from ...formats.files.atomic import write_text_atomically
from ...formats.files.images import write_png
from ...formats.files.spreadsheet_text import to_cell
from ...geometry import quaternion_from_pose
from ...measurement.image.measurand_image import measurand_windows
from ...planning import without_allowed_error
from ...planning.inspection import ExplicitViewpoints, Inspection
from ...sensors import Camera, Window
from ...simulation.displaced_poses import displaced_poses
from ...simulation.image_sensor import ImageSensor
from ...simulation.partial_image import partial_image
from ...simulation.renderer import Renderer
from ...simulation.true_camera import true_camera
from ..given_viewpoints import ViewpointsLike, viewpoints_of
from ..write import make_folder
from .measure import seen_measurands

__all__ = ["simulate"]

_CALIBRATION = 1 << 31  # of the seed of the true camera, beside those of the viewpoints


def simulate(
    inspection: Inspection,
    folder: str | PathLike[str],
    viewpoints: ViewpointsLike = None,
    *,
    repeats: int = 1,
    sensor: ImageSensor | None = None,
    rays_per_pixel: int = 34,
    only: Sequence[str] = (),
    seed: int | None = None,
    progress: Progress | None = None,
) -> int:
    """Write images ``VIEWPOINT_REPEAT.png`` of displaced cameras, and ``acquisitions.csv`` with where the camera
    really stood.

    Where the inspection states how well its camera is calibrated, one true camera is drawn, with which all images are
    made; ``simulation.json`` has it.

    What was written before by the same call is kept: a simulation that was stopped goes on.

    Parameters
    ----------
    folder
        For images, ``acquisitions.csv`` (the truth, which no measurement may read) and ``simulation.json``.
    viewpoints
        As of :func:`~viewgauge.evaluate`, such as a plan's ``viewpoints.csv``.
    repeats
        Images of each viewpoint; the pose error is drawn anew for each.
    rays_per_pixel
        Of :data:`~viewgauge.simulation.renderer.FIBONACCI`.
    only
        Ids of characteristics: only what is looked at to measure them is rendered, the rest of the image is black.
        That includes the edges of all other characteristics, which tell where an image was taken from. None for all of
        the image.

    Returns
    -------
    The number of images.

    Raises
    ------
    InputError
        If a number is out of range, or the folder holds another simulation.
    """
    if repeats < 1:
        raise InputError("must be at least 1", key="repeats", got=repeats)
    chosen, sensor, progress = viewpoints_of(inspection, viewpoints), sensor or ImageSensor(), progress or Silent()
    seed = inspection.seed if seed is None else seed
    if seed < 0:
        raise InputError("the seed must not be negative", key="seed", got=seed, expected="a whole number from 0 on")
    windows = _windows(inspection, chosen, only)
    camera = true_camera(inspection.camera, np.random.default_rng([seed, _CALIBRATION]))
    place, mesh = make_folder(folder), inspection.part.mesh
    renderer = Renderer(mesh.vertices, mesh.triangles, rays_per_pixel=rays_per_pixel)
    simulation = _Simulation(renderer, sensor, camera, seed, place)
    about = {
        "inputs": dict(inspection.inputs),
        "viewpoints": {name: T.tolist() for name, T in zip(chosen.ids, chosen.T_part_camera, strict=True)},
        "repeats": repeats,
        "sensor": asdict(sensor),
        "rays_per_pixel": rays_per_pixel,
        "chord_error_mm": mesh.chord_error_mm,
        "only": list(only),
        "true_camera": _intrinsics(camera),
        "seed": seed,
    }
    _claim(place / "simulation.json", about)
    rows = []
    with progress.stage(f"Simulating {len(chosen) * repeats} images", len(chosen) * repeats) as advance:
        for number, (name, T) in enumerate(zip(chosen.ids, chosen.T_part_camera, strict=True)):
            poses = displaced_poses(T, inspection.pose_error, repeats, np.random.default_rng([seed, number]))
            for repeat, pose in enumerate(poses, start=1):
                file = f"{name}_{repeat:04d}.png"
                rows.append([file, name, repeat, *map(_text, pose[:3, 3]), *map(_text, quaternion_from_pose(pose))])
                simulation.write(file, pose, windows[number], (number, repeat))
                advance(1)
    write_text_atomically(place / "acquisitions.csv", _true_poses(rows))
    return len(rows)


@dataclass(frozen=True)
class _Simulation:
    """What all images of a simulation share."""

    renderer: Renderer
    sensor: ImageSensor
    camera: Camera
    seed: int
    folder: Path

    def write(self, file: str, pose: NDArray[np.float64], windows: Sequence[Window], number: tuple[int, int]) -> None:
        """Write the image from a pose, unless it is there; its noise depends on its number alone."""
        if not (self.folder / file).exists():
            rng = np.random.default_rng([self.seed, *number])
            grey = partial_image(self.renderer, self.sensor, pose, self.camera, windows, rng)
            write_png(self.folder / file, grey, self.sensor.bits)


def _intrinsics(camera: Camera) -> dict[str, Any]:
    return {
        "focal_length_px": [camera.principal_distance_mm / pitch for pitch in camera.pixel_pitch_mm],
        "principal_point_px": list(camera.principal_point),
        "distortion": None if camera.lens is None else list(camera.lens.coefficients),
    }


def _true_poses(rows: Sequence[Sequence[object]]) -> str:
    """The text of a CSV with where the camera stood in each image."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["image", "viewpoint", "repeat", "x", "y", "z", "qw", "qx", "qy", "qz"])
    writer.writerows([to_cell(str(cell)) for cell in row[:2]] + list(row[2:]) for row in rows)
    return text.getvalue()


def _windows(inspection: Inspection, viewpoints: ExplicitViewpoints, only: Sequence[str]) -> list[list[Window]]:
    """What is rendered of each viewpoint's image."""
    camera, pose_error = inspection.camera, inspection.pose_error
    if not only:
        return [[Window.whole(camera)]] * len(viewpoints)
    known = {characteristic.id: characteristic for characteristic in inspection.part.characteristics}
    for name in only:
        if name not in known:
            raise InputError("no such characteristic", key="only", got=name, expected=", ".join(known))
    judged, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    looked_at = {characteristic.id: characteristic for characteristic in (*judged, *(known[name] for name in only))}
    evaluation = EvaluationJob.of(inspection, list(looked_at.values()), viewpoints)
    return [
        [
            window
            for measurand in seen_measurands(evaluation, T).values()
            for window in measurand_windows(measurand, T, camera, pose_error)
        ]
        for T in viewpoints.T_part_camera
    ]


def _claim(path: Path, about: dict[str, Any]) -> None:
    """Note what is simulated, or raise InputError if the folder holds something else."""
    text = json.dumps(about, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    if not path.exists():
        write_text_atomically(path, text)
    elif path.read_text(encoding="utf-8") != text:
        raise InputError(
            "the folder holds images of another simulation", file=path.parent, hint="choose another folder, or empty it"
        )


def _text(value: float) -> str:
    return repr(float(value))
