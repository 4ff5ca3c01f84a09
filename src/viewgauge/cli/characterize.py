"""The command that estimates the pose uncertainty from measurements of poses."""

from __future__ import annotations

import math
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .options import DONE, Json
from .output import print_json
from .progress import Bars

__all__ = ["characterize"]


def characterize(
    samples: Path,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    camera: Path | None = None,
    with_mean: Annotated[bool, Parameter(negative="")] = False,
    json: Json = False,
) -> int:
    """Estimate the pose uncertainty from measurements, and write the covariance file that a plan reads.

    Parameters
    ----------
    samples
        Read this CSV of commanded and measured poses, visits or errors, or this YAML of joints or board images.
    output
        Write the covariance to this file (YAML), for pose_uncertainty.covariance of an inspection file.
    camera
        Write the camera that images of a board gave to this file (OpenCV's YAML), with its uncertainty, for
        camera.calibration of an inspection file.
    with_mean
        Count the systematic part with the rest, because it is not calibrated away.
    """
    from ..jobs.characterize import characterize, describe_characterization, write_calibration, write_covariance_of

    character = characterize(samples, progress=Bars())
    document = describe_characterization(character)
    if camera is not None:
        with _folder_of(camera):
            write_calibration(character, camera)
    if output is not None:
        with _folder_of(output):
            write_covariance_of(character, output, with_mean=with_mean)
    if json:
        print_json(document)
    else:
        _print_character(document)
        written = [str(path) for path in (output, camera) if path is not None]
        if written:
            print(f"written to {' and '.join(written)}")
    return DONE


def _folder_of(path: Path) -> AbstractContextManager[Any]:
    from ..jobs.write import output_folder

    return output_folder(path.parent) if str(path.parent) != "." else nullcontext()


def _print_character(document: dict[str, Any]) -> None:
    print(f"{document['samples']} samples ({document['kind']}), {document['degrees_of_freedom']} degrees of freedom")
    print("  axis  standard deviation, 95 % interval     mean, 95 % interval            normal?")
    for axis in document["axes"]:
        angle = axis["axis"].startswith("r")
        scale, unit = (180e3 / math.pi, "mdeg") if angle else (1e3, "um")
        spread = [scale * v for v in (axis["standard_deviation"], *axis["standard_deviation_interval"])]
        mean = [scale * v for v in (axis["mean"], *axis["mean_interval"])]
        verdict = f"p = {axis['normality_p']:.2g}" + (" no" if axis["normality_p"] < 0.05 else "")
        deviation = f"{spread[0]:8.4g} {unit:4} [{spread[1]:.4g}, {spread[2]:.4g}]"
        centre = f"{mean[0]:8.3g} [{mean[1]:.3g}, {mean[2]:.3g}]"
        print(f"  {axis['axis']:4}  {deviation:36}  {centre:29}  {verdict}")
    together = {name: document[f"{name}_p"] for name in ("skewness", "kurtosis")}
    if all(value is not None for value in together.values()):
        said = ", ".join(f"{name} p = {value:.2g}" for name, value in together.items())
        print(f"  all six together (Mardia): {said}")
    if document["outliers"]:
        print(f"  far from the others: {', '.join(document['outliers'])}; they are part of the figures")
    if document["board"]:
        _print_board(document["board"])
    factor = document["factor_at_95"]
    print(f"  few samples: a plan at 0.95 counts standard deviations {factor:.3f} times as large")


def _print_board(board: dict[str, Any]) -> None:
    (fx, _, cx), (_, fy, cy), _ = board["camera_matrix_px"]
    print(f"  camera: fx {fx:.1f}, fy {fy:.1f}, cx {cx:.1f}, cy {cy:.1f} px; corners left {board['rms_px']:.2f} px rms")
    uncertainty = board["standard_uncertainty"]
    print(
        "  standard uncertainty: "
        + ", ".join(f"{name} {uncertainty[name]:.2g}" for name in ("fx", "fy", "cx", "cy"))
        + " px"
    )
    if board["pivot"]:
        position = ", ".join(f"{value:.3f}" for value in board["pivot"]["position_mm"])
        quaternion = ", ".join(f"{value:.6f}" for value in board["pivot"]["quaternion"])
        print(f"  pose_uncertainty.frame: {{position: [{position}] mm, quaternion: [{quaternion}]}}")
    for reported in board["left_out"]:
        print(f"  left out  {reported}")
