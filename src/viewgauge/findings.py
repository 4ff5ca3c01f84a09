"""Findings: input that can be read but that hardly any camera, robot or part has.

An input that is impossible is an :class:`~viewgauge.exceptions.InputError`. A finding is for an input that is possible
and implausible: a length of 0.07 mm where millimetres were probably metres, a principal point a quarter of the image
off the middle. Each finding has a name, under which a user accepts it: ``accept: [principal_point]`` in the inspection
file, ``--accept principal_point`` on the command line. A finding that is *refused* ends the command (exit code 2)
unless it is accepted; another is shown as a warning, and is not shown once it is accepted.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import asdict, dataclass
from typing import Any

from .exceptions import InputError

__all__ = ["NAMES", "Finding", "admit", "require_known"]

NAMES: dict[str, str] = {
    "allowed_error_above_tolerance": "the requirement allows an error larger than the tolerance",
    "allowed_error_small": "the requirement allows hardly any error",
    "angle_of_the_part": "an angle of the drawing is not the angle of the part's faces",
    "blur_limit": "a large circle of confusion counts as in focus",
    "board_scale": "the robot's travel gives the board another scale than the stated one",
    "candidate_distance": "candidates are nearer than any camera focuses, or very far",
    "colour_filter": "the colours of a Bayer pattern are not modelled",
    "covariance_axes": "a covariance is given along the axes of a fixed frame",
    "edge_detector": "the edge detector is exact, or coarse",
    "f_number": "no usual lens has this aperture",
    "far_sample": "one sample is far from all others",
    "field_limited": "the lens model holds for part of the image only",
    "field_of_view": "no usual lens has this field of view on this sensor",
    "focal_length": "no usual lens has this focal length",
    "focal_length_ratio": "the focal lengths along columns and rows are far apart",
    "focus_distance": "the lens is focused nearer than usual lenses can be",
    "frame_position": "the pose error frame is far from the camera",
    "graphical_pmi": "the file has drawn PMI without meaning",
    "grazing_angle": "faces count as seen from nearly straight above alone",
    "hand_eye": "the hand-eye calibration leaves errors that no robot has",
    "hand_eye_motion": "the robot turned too little for a hand-eye calibration",
    "image_shape": "the image is a narrow strip",
    "lens_model": "the stated lens model is not sane over the image",
    "lens_turns_back": "the lens model turns back inside the image",
    "line_scan": "the image is a line or a few",
    "margin": "the margin leaves nothing of the image",
    "minimum_length": "no image of a measurand is as long as is asked for",
    "no_distortion": "the file says nothing of distortion",
    "not_calibrated": "a calibration states no uncertainty",
    "nothing_fits": "characteristics are far larger or smaller than the field of view",
    "out_of_focus": "nothing is in focus at the distances of the candidates",
    "part_size": "the part is smaller or larger than parts that are measured by images",
    "pixel_pitch": "no usual sensor has such pixels",
    "pixel_shape": "pixels are far from square",
    "plan_inputs": "a plan was made from other files than those it is used with",
    "pmi_count": "the toleranced records that were read are not those that the text has",
    "pose_mean": "the mean of the pose errors is large",
    "pose_pairs": "commanded and measured poses do not fit each other",
    "pose_positions": "the positions of the samples are very small or very large",
    "pose_rotation": "the orientation is known exactly, or better or worse than robots and stages hold it",
    "pose_translation": "the position is known exactly, or better or worse than robots and stages hold it",
    "principal_point": "the principal point is far from the middle of the image",
    "probability": "the required probability is below that of a coin",
    "rolling_shutter": "a rolling shutter is not modelled",
    "rows_do_not_match": "rows of commanded and measured poses do not belong together",
    "sensor_size": "no usual sensor is of this size",
    "tangential_distortion": "the tangential distortion is large",
    "tolerance_size": "a tolerance is larger than its length",
    "tolerance_without_width": "a tolerance zone has no width",
    "transposed_matrix": "the camera matrix is probably transposed",
    "uncertainty_not_written": "the uncertainty of a calibration has no place in the format that is written",
    "viewpoint_inside_part": "a given viewpoint is inside the part",
    "viewpoint_looks_away": "a given viewpoint does not look at the part",
}
"""What each finding is about, by its name; the how-to page lists them."""


@dataclass(frozen=True)
class Finding:
    """Something implausible in the input.

    Parameters
    ----------
    name
        Under which it is accepted, such as ``principal_point``: lower case, words joined by ``_``.
    found
        One clause: what was found, with the figure that shows it, such as "the principal point lies 412 px (26 % of
        the width) from the middle of the image".
    usual
        What is usual, such as "at most 10 %"; empty where ``found`` says it.
    cause
        The likely cause, such as "the calibration was made at another image size"; empty where none is likely.
    where
        File and key; empty where the message is about the whole input.
    refused
        Whether the command ends with it (exit code 2) unless it is accepted.
    """

    name: str
    found: str
    usual: str = ""
    cause: str = ""
    where: str = ""
    refused: bool = False

    def __str__(self) -> str:
        """A sentence for people."""
        text = f"{self.where}: {self.found}" if self.where else self.found
        if self.usual:
            text += f"; usual is {self.usual}"
        if self.cause:
            text += f". Likely cause: {self.cause}"
        return f"{text} [{self.name}]"

    def document(self) -> dict[str, Any]:
        """The finding as plain data, with its sentence as ``message``."""
        return {**asdict(self), "message": str(self)}


def admit(findings: Iterable[Finding], accepted: Collection[str] = ()) -> tuple[Finding, ...]:
    """Those findings that are shown as warnings: not accepted, and not refused.

    Raises
    ------
    InputError
        If a finding is refused and its name is not among ``accepted``.
    """
    open_ones = [finding for finding in findings if finding.name not in accepted]
    refused = [finding for finding in open_ones if finding.refused]
    if refused:
        names = ", ".join(dict.fromkeys(finding.name for finding in refused))
        raise InputError(
            "\n".join(str(finding) for finding in refused),
            hint=f"correct the input; or, if it is meant so, accept it by name: accept: [{names}] in the inspection "
            f"file, or --accept on the command line",
        )
    return tuple(open_ones)


def require_known(accepted: Iterable[str], findings: Iterable[Finding] = ()) -> None:
    """Raise InputError if a name is accepted that no finding has: neither one of :data:`NAMES` nor one that was made.

    Parameters
    ----------
    findings
        Those that were made.
    """
    known = {*NAMES, *(finding.name for finding in findings)}
    unknown = [name for name in accepted if name not in known]
    if unknown:
        raise InputError(
            "no finding has this name",
            key="accept",
            got=", ".join(unknown),
            expected=f"names of findings: {', '.join(sorted(known))}",
            hint="a finding's name stands in brackets at the end of its warning",
        )
