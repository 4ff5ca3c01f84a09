"""Images of the part as the camera sees it when the head is sent to settings and does not quite get there."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import asdict
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..exceptions import InputError
from ..geometry import quaternion_from_pose
from ..io.atomic import write_text_atomically
from ..io.images import write_png
from ..simulation.displaced_poses import displaced_poses
from ..simulation.renderer import Renderer
from ..simulation.sensor import Sensor
from .evaluate import SettingsLike, settings_of
from .inspection import Inspection
from .progress import Progress, Silent
from .write import make_folder

__all__ = ["simulate"]


def simulate(
    inspection: Inspection,
    folder: str | PathLike[str],
    settings: SettingsLike = None,
    *,
    looks: int = 1,
    sensor: Sensor | None = None,
    rays_per_pixel: int = 34,
    seed: int | None = None,
    progress: Progress | None = None,
) -> int:
    """Write images ``SETTING_LOOK.png`` of displaced looks, and ``looks.csv`` with where the camera really stood.

    What was written before by the same call is kept: a simulation that was stopped goes on.

    Parameters
    ----------
    folder
        For images, ``looks.csv`` (the truth, which no measurement may read) and ``simulation.json``.
    settings
        As of :func:`~viewgauge.evaluate`, such as a plan's ``settings.csv``.
    looks
        Of each setting; the head's errors are drawn anew for each.
    rays_per_pixel
        Of :data:`~viewgauge.simulation.renderer.FIBONACCI`.

    Returns
    -------
    The number of images.

    Raises
    ------
    InputError
        If a number is out of range, or the folder holds another simulation.
    """
    if looks < 1:
        raise InputError("at least one look", key="looks", got=looks)
    chosen, sensor, progress = settings_of(inspection, settings), sensor or Sensor(), progress or Silent()
    seed = inspection.seed if seed is None else seed
    if seed < 0:
        raise InputError("the seed must not be negative", key="seed", got=seed, expected="a whole number from 0 on")
    mesh = inspection.part.mesh
    renderer = Renderer(mesh.vertices, mesh.triangles, rays_per_pixel=rays_per_pixel)
    place = make_folder(folder)
    about = {
        "inputs": dict(inspection.inputs),
        "settings": {name: T.tolist() for name, T in zip(chosen.ids, chosen.T_part_camera, strict=True)},
        "looks": looks,
        "sensor": asdict(sensor),
        "rays_per_pixel": rays_per_pixel,
        "seed": seed,
    }
    _claim(place / "simulation.json", about)
    rows = []
    with progress.stage(f"Simulating {len(chosen) * looks} images", len(chosen) * looks) as advance:
        for number, (name, T) in enumerate(zip(chosen.ids, chosen.T_part_camera, strict=True)):
            poses = displaced_poses(T, inspection.head, looks, np.random.default_rng([seed, number]))
            for look, pose in enumerate(poses, start=1):
                file = f"{name}_{look:04d}.png"
                rows.append([file, name, look, *map(_text, pose[:3, 3]), *map(_text, quaternion_from_pose(pose))])
                if not (place / file).exists():
                    light = (renderer.coverage if sensor.black_and_white else renderer.radiance)(
                        pose, inspection.camera
                    )
                    grey = sensor.grey(light, np.random.default_rng([seed, number, look]))
                    write_png(place / file, grey, sensor.bits)
                advance(1)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["image", "setting", "look", "x", "y", "z", "qw", "qx", "qy", "qz"])
    writer.writerows(rows)
    write_text_atomically(place / "looks.csv", text.getvalue())
    return len(rows)


def _claim(path: Path, about: dict[str, Any]) -> None:
    """Note what is simulated, or see that it is the same as before."""
    text = json.dumps(about, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    if not path.exists():
        write_text_atomically(path, text)
    elif path.read_text(encoding="utf-8") != text:
        raise InputError(
            "the folder holds images of another simulation", file=path.parent, hint="choose another folder, or empty it"
        )


def _text(value: float) -> str:
    return repr(float(value))
