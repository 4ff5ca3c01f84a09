"""What is implausible in how part, camera and the places of the camera go together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ...findings import Finding
from ...part import Characteristic, Mesh
from ...sensors import Camera
from ...visibility.limits import ObservationLimits
from ..candidates.candidate_grid import default_distance_range
from ..candidates.candidate_options import CandidateOptions
from .usual_range import UsualRange

__all__ = ["distance_findings", "limits_findings", "measurand_points", "part_findings"]

_PART = UsualRange(
    "part_size",
    "the part's diagonal",
    1.0,
    30_000.0,
    "mm",
    1.0,
    "metres or inches read as mm: a mesh file names no unit",
    "um read as mm: a mesh file names no unit",
)
_DISTANCE = UsualRange(
    "candidate_distance",
    "the distance of the candidates",
    10.0,
    30_000.0,
    "mm",
    1.0,
    "metres or cm written as mm",
    "um written as mm",
)
_STEEPEST_RAD = math.radians(60.0)


def measurand_points(characteristics: Sequence[Characteristic]) -> NDArray[np.float64]:
    """The points of all measurands, ``(n, 3)`` mm, part frame."""
    points = [measurand.points for characteristic in characteristics for measurand in characteristic.measurands]
    return np.concatenate([np.asarray(p, dtype=float).reshape(-1, 3) for p in points]) if points else np.empty((0, 3))


def part_findings(mesh: Mesh) -> Iterator[Finding]:
    """Whether the part is of a size that a camera sees."""
    if len(mesh.vertices):
        low, high = mesh.bounds
        yield from _PART.judge(float(np.linalg.norm(high - low)), "part.file")


def limits_findings(limits: ObservationLimits, camera: Camera) -> Iterator[Finding]:
    """Whether the limits of observation leave anything to be observed."""
    if 2 * limits.margin_px >= min(camera.resolution):
        yield Finding(
            "margin",
            f"a margin of {limits.margin_px:.4g} px leaves nothing of {camera.resolution[0]} x "
            f"{camera.resolution[1]} px",
            "4 to 50 px",
            where="observation.margin",
        )
    if limits.minimum_length_px > math.hypot(*camera.resolution):
        yield Finding(
            "minimum_length",
            f"no image in {camera.resolution[0]} x {camera.resolution[1]} px is {limits.minimum_length_px:.4g} px long",
            "10 to 100 px",
            where="observation.minimum_length",
        )
    if limits.grazing_angle_rad > _STEEPEST_RAD:
        yield Finding(
            "grazing_angle",
            f"a face counts as seen from {math.degrees(limits.grazing_angle_rad):.4g} deg on: from nearly "
            "straight above alone",
            "5 to 30 deg",
            "the angle from the face's normal in place of that from the face",
            "observation.grazing_angle",
        )


def distance_findings(
    options: CandidateOptions, camera: Camera, limits: ObservationLimits, characteristics: Sequence[Characteristic]
) -> Iterator[Finding]:
    """Whether anything fits the image, and is in focus, at the distances at which candidates are sampled."""
    points = measurand_points(characteristics)
    if not len(points):
        return
    near, far = options.distance_mm or default_distance_range(points, camera)
    where = "candidates.distance" if options.distance_mm else "camera.focus_distance"
    for distance in dict.fromkeys((near, far)):
        found = list(_DISTANCE.judge(distance, where))
        yield from found
        if found:
            break
    if far < 2 * camera.focal_length_mm:
        yield Finding(
            "candidate_distance",
            f"candidates are at most {far:.4g} mm from what they look at, with a focal length of "
            f"{camera.focal_length_mm:.4g} mm",
            "at least twice the focal length",
            "a distance in cm or m, or a focal length in um",
            where,
        )
    yield from _image_lengths(near, far, camera, limits, characteristics, where)
    span = float(np.linalg.norm(np.ptp(points, axis=0)))
    focus = camera.focus_distance_mm
    if focus is not None:
        nearest_to_focus = float(np.clip(focus, max(near - span, 1e-3), far + span))
        blur = float(camera.blur_px(nearest_to_focus))
        if blur > camera.blur_limit_px:
            yield Finding(
                "out_of_focus",
                f"nothing is in focus: at {nearest_to_focus:.4g} mm, the nearest to the focus distance of "
                f"{focus:.4g} mm, the circle of confusion is {blur:.3g} px",
                f"at most {camera.blur_limit_px:.3g} px",
                "the distances of candidates and the focus distance are in different units, or from different places",
                where,
            )


def _image_lengths(
    near: float,
    far: float,
    camera: Camera,
    limits: ObservationLimits,
    characteristics: Sequence[Characteristic],
    where: str,
) -> Iterator[Finding]:
    lengths = [
        min(float(np.linalg.norm(np.ptp(np.asarray(m.points), axis=0))) for m in characteristic.measurands)
        for characteristic in characteristics
        if characteristic.measurands
    ]
    if not lengths:
        return
    pitch = max(camera.pixel_pitch_mm)
    field_px, scale_px = math.hypot(*camera.resolution), camera.focal_length_mm / min(camera.pixel_pitch_mm)
    if camera.lens is None and min(lengths) * scale_px / (far + max(lengths)) > 2 * field_px:
        yield Finding(
            "nothing_fits",
            f"the shortest characteristic, {min(lengths):.4g} mm, is {min(lengths) * scale_px / far:.4g} px long in an "
            f"image of {camera.resolution[0]} x {camera.resolution[1]} px from {far:.4g} mm",
            "half of the image's width",
            "part, distance and camera are in different units",
            where,
        )
    longest_px = max(lengths) * camera.focal_length_mm / pitch / near
    if longest_px < limits.minimum_length_px:
        yield Finding(
            "nothing_fits",
            f"the longest characteristic, {max(lengths):.4g} mm, is {longest_px:.3g} px long in an image from "
            f"{near:.4g} mm",
            f"at least {limits.minimum_length_px:.4g} px",
            "part, distance and camera are in different units",
            where,
        )
