"""The command that shows a camera's calibration and writes it for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .options import DONE, Json
from .terminal.output import print_json
from .terminal.reading import print_findings

__all__ = ["camera"]


def camera(
    file: Path,
    /,
    *,
    name: str | None = None,
    model: str | None = None,
    size: str | None = None,
    accept: tuple[str, ...] = (),
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    json: Json = False,
) -> int:
    """Show a camera's calibration, and write it for OpenCV.

    Parameters
    ----------
    file
        Read this calibration of OpenCV, ROS, Kalibr, COLMAP, MATLAB, RealSense, ZED, HALCON or mrcal, or this
        inspection file.
    name
        Take the camera of this name, such as cam1, from a file that has several.
    model
        State the lens model that the file does not say: fisheye, radial-tangential or none.
    size
        State the image's columns and rows that the file does not say, such as 1920x1080.
    accept
        Accept the finding of this name; the option may be given several times.
    output
        Write the calibration to this file as OpenCV's YAML, every digit kept.
    """
    from ..jobs.calibration import Stated, describe_calibration, parse_size, read_calibration, write_opencv_camera

    stated = Stated(name, model, None if size is None else parse_size(size))
    calibration = read_calibration(file, stated, accept)
    print_findings(calibration.findings)
    if output is not None:
        write_opencv_camera(output, calibration)
    document = describe_calibration(calibration)
    if json:
        print_json(document)
    else:
        _print_calibration(document)
        if output is not None:
            print(f"written to {output}")
    return DONE


def _print_calibration(document: dict[str, Any]) -> None:
    size = document["resolution"]
    print(f"{document['format']}: " + ("size not stated" if size is None else f"{size[0]} x {size[1]} px"))
    uncertainty = document["standard_uncertainty"] or {}
    pairs = zip(("fx", "fy", "cx", "cy"), [*document["focal_length_px"], *document["principal_point_px"]], strict=True)
    for name, value in pairs:
        print(f"  {name}  {value:.3f}{f' ± {uncertainty[name]:.3f}' if uncertainty else ''} px")
    if document["distortion_model"] is None:
        print("  no distortion")
    else:
        corner = document["distortion_at_corner_px"]
        most = "" if corner is None else f", {corner:.1f} px at the corner that it moves most"
        print(f"  {document['distortion_model']}{most}")
        for name, value in document["distortion"].items():
            print(f"  {name}  {value:.6g}{f' ± {uncertainty[name]:.2g}' if uncertainty else ''}")
    for note in document["notes"]:
        print(f"  {note}")
    print("  standard uncertainties: " + ("after the ±" if uncertainty else "not stated, so not calibrated"))
