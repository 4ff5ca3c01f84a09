"""The command that makes images."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .options import DONE, Json, PartFile, count, whole_number
from .output import print_json
from .progress import Bars

__all__ = ["simulate"]


def simulate(
    file: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    settings: Path | None = None,
    looks: Annotated[int, Parameter(converter=count)] = 1,
    blur: float = 0.6,
    noise: float = 0.01,
    bits: Annotated[int, Parameter(converter=whole_number)] = 8,
    black_and_white: Annotated[bool, Parameter(negative="")] = False,
    rays: Annotated[int, Parameter(converter=whole_number)] = 34,
    seed: Annotated[int | None, Parameter(converter=whole_number)] = None,
    part: PartFile = None,
    json: Json = False,
) -> int:
    """Make images of the part from settings that the head does not quite reach.

    A simulation that was stopped goes on when the same command is given again.

    Parameters
    ----------
    file
        The inspection file (YAML).
    output
        Folder for the images, looks.csv (where the camera really stood) and simulation.json.
    settings
        Settings file (CSV), such as a plan's; by default the one that the inspection file names.
    looks
        Images of each setting, each with errors of its own.
    blur
        Standard deviation of the lens's blur, px.
    noise
        Standard deviation of a pixel's noise, as a share of full scale.
    bits
        8 or 12.
    black_and_white
        A pixel is on when the part covers more than half of it; no blur, no noise.
    rays
        Rays through each pixel that holds an edge: 8, 13, 21, 34, 55, 89, 144, 233, 377 or 610.
    """
    from .. import workflow

    bars = Bars()
    with workflow.output_folder(output):
        with bars.stage("Reading the inspection and its part"):
            inspection = workflow.load(file, part=part)
        sensor = workflow.Sensor(blur_px=blur, noise=noise, bits=bits, black_and_white=black_and_white)
        images = workflow.simulate(
            inspection, output, settings, looks=looks, sensor=sensor, rays_per_pixel=rays, seed=seed, progress=bars
        )
    if json:
        print_json({"images": images, "folder": str(output)})
    else:
        print(f"{images} images written to {output}, with looks.csv and simulation.json")
    return DONE
