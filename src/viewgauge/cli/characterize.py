"""The command that estimates the pose uncertainty from measurements of poses."""

from __future__ import annotations

import math
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from .options import DONE, Json
from .terminal.output import print_json
from .terminal.progress import Bars
from .terminal.reading import print_findings

__all__ = ["characterize"]

_SHOWN = 5  # poses
_AXES = ("x", "y", "z", "rx", "ry", "rz")


def characterize(
    samples: Path,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    camera: Path | None = None,
    with_mean: Annotated[bool, Parameter(negative="")] = False,
    in_hand: Literal["camera", "board"] | None = None,
    kind: Annotated[str | None, Parameter(name="--from")] = None,
    unit: str | None = None,
    angle: str | None = None,
    rotation: str | None = None,
    quaternion: str | None = None,
    accept: tuple[str, ...] = (),
    json: Json = False,
) -> int:
    """Estimate the pose uncertainty from measurements, and write the covariance file that a plan reads.

    A file of poses alone is read and shown.

    Parameters
    ----------
    samples
        Read this CSV of commanded and measured poses, visits or errors, or this YAML of joints, board images or pairs.
    output
        Write the covariance to this file (YAML), for pose_uncertainty.covariance of an inspection file.
    camera
        Write the camera that images of a board gave to this file (OpenCV's YAML), with its uncertainty, for
        camera.calibration of an inspection file.
    with_mean
        Count the systematic part with the rest, because it is not calibrated away.
    in_hand
        State what the robot carries, where the file does not say it.
    kind
        Read the poses as this format, such as ur.
    unit
        State the unit of lengths that the file does not say: mm, cm, m or inch.
    angle
        State the unit of angles that the file does not say: deg or rad.
    rotation
        State what three angles mean: rotation-vector, fixed-xyz (roll, pitch, yaw), turning-zyx or other axes.
    quaternion
        State the order of quaternions whose parts have no names: wxyz or xyzw.
    accept
        Accept the finding of this name; the option may be given several times.
    """
    from ..jobs.characterize import characterize, describe_characterization, write_calibration, write_covariance_of
    from ..jobs.conversion.pose_conversion import conventions_of
    from ..jobs.conversion.pose_reading import read_poses_alone

    said = {"kind": kind, "unit": unit, "angle": angle, "rotation": rotation, "quaternion": quaternion}
    conventions = conventions_of(said)
    if (poses := read_poses_alone(samples, conventions)) is not None:
        return _show_poses(poses, samples, output, accept, json)
    bars = Bars()
    character = characterize(samples, progress=bars, conventions=conventions, in_hand=in_hand, accept=accept)
    print_findings(character.findings)
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


def _show_poses(poses: Any, source: Path, output: Path | None, accept: tuple[str, ...], as_json: bool) -> int:
    """What a file of poses alone holds; a covariance that it states is written."""
    from ..findings import admit
    from ..jobs.conversion.pose_conversion import describe_poses
    from ..jobs.conversion.pose_reading import covariance_findings, write_stated_covariance

    print_findings(admit(covariance_findings(poses), accept))
    if output is not None:
        with _folder_of(output):
            write_stated_covariance(poses, source, output)
    document = describe_poses(poses)
    if as_json:
        print_json(document)
        return DONE
    print(f"{len(poses.names)} poses ({document['format']}); {'; '.join(document['notes'])}")
    for name, pose in list(zip(document["names"], document["poses"], strict=True))[:_SHOWN]:
        print(f"  {name}: position {', '.join(f'{row[3]:.3f}' for row in pose[:3])} mm")
    if len(poses.names) > _SHOWN:
        print(f"  and {len(poses.names) - _SHOWN} more (--json prints all)")
    if document["covariance"] is None:
        print("  no measured poses beside them: viewgauge convert writes them as viewpoints")
    else:
        _print_stated(document["covariance"])
    if output is not None:
        print(f"written to {output}")
    return DONE


def _print_stated(covariance: list[list[float]]) -> None:
    """Standard deviations and correlations of a covariance that a file states."""
    deviations = [math.sqrt(row[k]) for k, row in enumerate(covariance)]
    print("  standard deviations: " + ", ".join(f"{value:.4g}" for value in deviations[:3]) + " mm; ", end="")
    print(", ".join(f"{1e3 * value:.4g}" for value in deviations[3:]) + " mrad")
    for k, row in enumerate(covariance):
        for m in range(k):
            if row[m]:
                share = row[m] / (deviations[k] * deviations[m])
                print(f"  correlation of {_AXES[m]} and {_AXES[k]}: {share:.3g}")


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
    elif document["hand_eye"]:
        print("  camera: not calibrated here; the errors of its calibration are part of the figures")
    if document["hand_eye"]:
        _print_hand_eye(document["hand_eye"])
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


def _print_hand_eye(hand_eye: dict[str, Any]) -> None:
    for name in ("camera_on_flange", "board_in_base", "board_on_flange", "camera_in_base"):
        if name in hand_eye:
            print(f"  {name}: {_placed(hand_eye[name])}")
    if hand_eye["frame"]:
        print(f"  pose_uncertainty.frame: {_placed(hand_eye['frame'])}")
    for reported in hand_eye["left_out"]:
        print(f"  left out  {reported}")


def _placed(pose: dict[str, list[float]]) -> str:
    """As a plan's YAML has it."""
    position = ", ".join(f"{value:.3f}" for value in pose["position_mm"])
    quaternion = ", ".join(f"{value:.6f}" for value in pose["quaternion"])
    return f'{{position: "[{position}] mm", quaternion: [{quaternion}]}}'
