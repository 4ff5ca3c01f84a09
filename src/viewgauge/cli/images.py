"""The commands that make images and measure in them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

import viewgauge as vg

from .options import DONE, NOT_MET, Json, PartFile, Seed, Workers, count, whole_number
from .terminal.output import print_json
from .terminal.progress import Bars
from .terminal.reading import read_inspection, read_to_render

__all__ = ["measure", "simulate", "validate"]


def simulate(
    file: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    viewpoints: Path | None = None,
    repeats: Annotated[int, Parameter(converter=count)] = 1,
    blur: float = 0.6,
    noise: float = 0.01,
    bits: Annotated[int, Parameter(converter=whole_number)] = 8,
    black_and_white: Annotated[bool, Parameter(negative="")] = False,
    rays: Annotated[int, Parameter(converter=whole_number)] = 34,
    only: str | None = None,
    chord_error: float | None = None,
    seed: Seed = None,
    part: PartFile = None,
    json: Json = False,
) -> int:
    """Render images of the part from the viewpoints, each displaced by a drawn pose error.

    A simulation that was stopped goes on when the same command is given again.

    Parameters
    ----------
    file
        Read this inspection file (YAML).
    output
        Write the images, acquisitions.csv (the true poses of the camera) and simulation.json to this folder.
    viewpoints
        Read viewpoints from this CSV file, such as a plan's; by default from the inspection file's.
    repeats
        Render this many images of each viewpoint, each with errors of its own.
    blur
        Blur the image by a Gaussian of this standard deviation, px.
    noise
        Add noise of this standard deviation to each pixel, as a share of full scale.
    bits
        Write pixels of 8 or of 12 bits.
    black_and_white
        Switch a pixel on when the part covers more than half of it, without blur and noise.
    rays
        Cast this many rays through each pixel that holds an edge: 8, 13, 21, 34, 55, 89, 144, 233, 377 or 610.
    only
        Render only what is needed to measure the characteristics of these ids, separated by commas.
    chord_error
        Keep the mesh within this distance of curved faces, mm; by default a twentieth of the smallest allowed error.
    """
    from ..jobs.write import output_folder

    bars = Bars()
    with output_folder(output, alone=True):
        inspection = read_to_render(file, part, chord_error)
        sensor = vg.ImageSensor(blur_px=blur, noise=noise, bits=bits, black_and_white=black_and_white)
        images = vg.simulate(
            inspection,
            output,
            viewpoints,
            repeats=repeats,
            sensor=sensor,
            rays_per_pixel=rays,
            only=[name.strip() for name in only.split(",")] if only is not None else (),
            seed=seed,
            progress=bars,
        )
    if json:
        print_json({"images": images, "folder": str(output)})
    else:
        print(f"{images} images written to {output}, with acquisitions.csv and simulation.json")
    return DONE


def measure(
    file: Path,
    plan: Path,
    images: Path,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    edges: Literal["sub-pixel", "whole-pixel"] = "sub-pixel",
    part: PartFile = None,
    json: Json = False,
) -> int:
    """Measure the planned characteristics in images that were taken at the plan's viewpoints.

    Exit code 0 if every characteristic passes, 1 if some fails, is undecided or could not be measured.

    Parameters
    ----------
    file
        Read this inspection file (YAML).
    plan
        Read the plan from this folder.
    images
        Read the images, VIEWPOINT.png or VIEWPOINT_NUMBER.png as the camera gives them, from this folder.
    output
        Write measurements.csv and pictures of what was found to this folder.
    edges
        Locate edges to sub-pixel, or at the nearest corner of pixels (whole-pixel) as the 1998 paper does.
    """
    from ..jobs.write import output_folder

    bars = Bars()
    with output_folder(output, alone=True) if output is not None else nullcontext():
        inspection = read_inspection(file, part)
        rows = vg.measure(inspection, plan, images, output, edges=edges, progress=bars)
    if json:
        print_json([asdict(row) for row in rows])
    else:
        _print_measured(rows)
        if output is not None:
            print(f"written to {output}: measurements.csv, and a picture of each image")
    return DONE if all(row.verdict in ("pass", "measured") for row in rows) else NOT_MET


def validate(
    file: Path,
    /,
    *,
    viewpoints: Path | None = None,
    sample: Annotated[int, Parameter(converter=count)] = 20,
    repeats: Annotated[int, Parameter(converter=count)] = 100,
    edges: Literal["sub-pixel", "whole-pixel", "both"] = "sub-pixel",
    blur: float = 0.6,
    noise: float = 0.005,
    bits: Annotated[int, Parameter(converter=whole_number)] = 8,
    rays: Annotated[int, Parameter(converter=whole_number)] = 34,
    chord_error: float | None = None,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    seed: Seed = None,
    workers: Workers = None,
    part: PartFile = None,
    json: Json = False,
) -> int:
    """Compare the predicted distribution of the error with errors measured in simulated images.

    Exit code 0 if the shares of errors inside the 68, 95 and 99 % intervals are as predicted, 1
    if not.

    Parameters
    ----------
    file
        Read this inspection file (YAML).
    viewpoints
        Read viewpoints from this CSV file, such as a plan's; by default the inspection file's, or candidates.
    sample
        Draw this many candidates where no viewpoints are given.
    repeats
        Simulate this many images of each viewpoint, each with errors of its own.
    edges
        Locate edges to sub-pixel, to whole pixels, or both ways.
    blur
        Blur the image by a Gaussian of this standard deviation, px.
    noise
        Add noise of this standard deviation to each pixel, as a share of full scale.
    bits
        Write pixels of 8 or of 12 bits.
    rays
        Cast this many rays through each pixel that holds an edge: 8, 13, 21, 34, 55, 89, 144, 233, 377 or 610.
    chord_error
        Keep the mesh within this distance of curved faces, mm; by default a twentieth of the smallest allowed error.
    output
        Write all pairs of viewpoints and characteristics to this file (CSV).
    """
    from ..jobs.images.validation_tables import describe_validation, write_validation

    bars = Bars()
    inspection = read_to_render(file, part, chord_error)
    sensor = vg.ImageSensor(blur_px=blur, noise=noise, bits=bits)
    with vg.open_executor(None, workers) as executor:
        found = vg.validate(
            inspection,
            viewpoints,
            sample=sample,
            repeats=repeats,
            sensor=sensor,
            edges=("sub-pixel", "whole-pixel") if edges == "both" else (edges,),
            rays_per_pixel=rays,
            seed=seed,
            progress=bars,
            executor=executor,
        )
    if output is not None:
        write_validation(found, output)
    document = describe_validation(found)
    if json:
        print_json(document)
    else:
        for one in document:
            _print_validation(one)
        if output is not None:
            print(f"written to {output}")
    return DONE if all(level["holds"] for one in document for level in one["coverage"]) else NOT_MET


def _print_validation(document: dict[str, Any]) -> None:
    acquisitions = document["viewpoints"] * document["acquisitions"]
    where = "1 viewpoint" if document["viewpoints"] == 1 else f"{document['viewpoints']} viewpoints"
    print(f"{document['edges']} edges: {acquisitions} acquisitions from {where}, one characteristic of each")
    if not document["characteristics"]:
        print("  nothing could be measured, not even in clear images")
    for level in document["coverage"] if document["characteristics"] else []:
        share = level["inside"] / level["acquisitions"] if level["acquisitions"] else float("nan")
        limits = " to ".join(f"{100 * level[name] / max(level['acquisitions'], 1):.1f}" for name in ("low", "high"))
        reported = "" if level["holds"] else "  NOT as predicted"
        print(
            f"  inside the {100 * level['level']:.0f} % interval: {100 * share:.1f} % ({limits} % expected){reported}"
        )
    if document["characteristics"]:
        print("  characteristic  acquisitions  measured/predicted  inside 68, 95, 99 %")
    for row in document["characteristics"]:
        shares = ", ".join(
            f"{100 * level['inside'] / max(level['acquisitions'], 1):.1f}{'' if level['holds'] else '*'}"
            for level in row["coverage"]
        )
        print(f"  {row['id']:14}  {row['acquisitions']:12}  {row['rms_ratio']:18.2f}  {shares}")
    if any(not level["holds"] for row in document["characteristics"] for level in row["coverage"]):
        print("  * not as predicted")
    if document["refused"]:
        print(
            f"  {len(document['refused'])} pairs of viewpoint and characteristic cannot be measured in clear "
            "images, such as"
        )
        for viewpoint, characteristic, reason in document["refused"][:3]:
            print(f"    {characteristic} from {viewpoint}: {reason}")


def _print_measured(rows: Sequence[Any]) -> None:
    """For each characteristic the mean, the largest expanded uncertainty, and how often each verdict was given."""
    images = len({row.image for row in rows})
    print(f"{len(rows)} measurements in {'1 image' if images == 1 else f'{images} images'}")
    for name in dict.fromkeys(row.characteristic for row in rows):
        mine = [row for row in rows if row.characteristic == name]
        values = [row.measured_mm for row in mine if row.measured_mm is not None]
        verdicts = ", ".join(f"{count} {verdict}" for verdict, count in Counter(r.verdict for r in mine).items())
        reported = f"{sum(values) / len(values):.4f}" if values else "-"
        largest = max((r.expanded_uncertainty_mm for r in mine if r.expanded_uncertainty_mm is not None), default=None)
        uncertainty = "" if largest is None else f" ± {largest:.4f}"
        print(f"  {name}: {reported}{uncertainty} mm (nominal {mine[0].nominal_mm:g}); {verdicts}")
        for reason in dict.fromkeys(row.reason for row in mine if row.reason):
            print(f"    not measured: {reason}")
