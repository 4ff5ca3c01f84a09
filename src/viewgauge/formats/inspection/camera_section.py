"""The section ``camera``: its optics, stated or by a calibration file, and the sections below it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, ClassVar, Literal, Self, TypeVar

import numpy as np
from pydantic import Field, model_validator

from ...exceptions import InputError
from ...geometry import Lens
from ...sensors import Camera, EdgeDetector
from ..cameras.camera_file import CameraFile, Stated
from ..cameras.camera_formats import read_camera_file
from .edge_detector_section import EdgeDetectorSection
from .inspection_text import InspectionText
from .optics.optics_findings import camera_findings
from .optics.usable_region_section import UsableRegionSection, read_usable_region
from .validation import build, validate
from .values import (
    Apart,
    Coefficients,
    Elsewhere,
    Length,
    Name,
    Pitch,
    PixelPair,
    Pixels,
    PixelsOrZeros,
    PositiveNumber,
    Resolution,
    Section,
)

__all__ = ["CalibratedCameraSection", "CameraSection", "read_camera"]

_PITCH = 0.02  # how far the shape of the pixels may be from what the calibration says


@dataclass(frozen=True)
class Optics:
    """The imaging of points, in the units of :class:`Camera`."""

    focal_length_mm: float
    pixel_pitch_mm: tuple[float, float]
    principal_point_px: tuple[float, float] | None
    lens: Lens | None
    covariance: tuple[tuple[float, ...], ...] | None


class UncertaintySection(Section):
    """Standard uncertainties of the calibration; without correlations, which a calibration file may state."""

    focal_length: PixelsOrZeros = Field(
        description="the standard uncertainty of the focal length: one or two numbers of pixels, such as 0.5 px"
    )
    principal_point: PixelsOrZeros = Field(
        description="the standard uncertainty of the principal point: one or two numbers of pixels, such as 0.8 px"
    )
    distortion: Coefficients = Field(
        default=(), description="the standard uncertainty of each distortion coefficient: plain numbers; by default 0"
    )

    def covariance(self, coefficients: int) -> tuple[tuple[float, ...], ...]:
        """The covariance of fx, fy, cx, cy and the given number of coefficients; raises InputError."""
        given = self.distortion or (0.0,) * coefficients
        if len(given) != coefficients or min(given, default=0.0) < 0:
            raise InputError(
                "not a standard uncertainty of each coefficient",
                key="calibration_uncertainty.distortion",
                got=list(given),
                expected=f"{coefficients} numbers, not negative",
            )
        pairs = [(pair[0], pair[-1]) for pair in (self.focal_length, self.principal_point)]
        deviations = np.array([*pairs[0], *pairs[1], *given])
        return tuple(tuple(row) for row in np.diag(deviations**2).tolist())


class _CameraSection(Section):
    """The keys that every camera has; ``edge_detector`` and ``calibration_uncertainty`` are read apart."""

    pixel_pitch: Pitch = Field(
        description='the width of a pixel, or width and height: a length, such as 3.45 um, or "[3.45, 3.45] um"'
    )
    calibration_uncertainty: Annotated[Any, Apart(UncertaintySection)] = Field(
        default=None, description="standard uncertainties of the calibration; by default it counts as exact"
    )
    edge_detector: Annotated[Any, Apart(EdgeDetectorSection)] = Field(
        default=None, description="how accurately edges are located; by default quantization: 1 px"
    )
    f_number: PositiveNumber | None = Field(
        default=None, description="the aperture, such as 8; with focus_distance. By default all is in focus"
    )
    focus_distance: Length | None = Field(
        default=None,
        description="the distance in focus, from the lens, such as 300 mm; the principal distance follows from it",
    )
    blur_limit: Pixels = Field(
        default=1.0, description="the largest circle of confusion that counts as in focus, by default 1 px"
    )
    usable_region: Annotated[Any, Apart(UsableRegionSection)] = Field(
        default=None, description="the part of the image that is used; by default all of it"
    )
    shutter: Literal["global", "rolling"] = Field(
        default="global", description="global (the default); rolling is not modelled, and a warning says so"
    )
    colour_filter: Literal["none", "bayer"] = Field(
        default="none", description="none (the default); bayer is not modelled, and a warning says so"
    )
    telecentric: Annotated[Any, Elsewhere()] = None  # a message says that it is not modelled

    _key_of: ClassVar[dict[str, str]]
    """The keys of the file for what :class:`Camera` calls otherwise."""

    def _camera(
        self,
        optics: Optics,
        resolution: tuple[int, int],
        uncertainty: UncertaintySection | None,
        edge_detector: EdgeDetector | float | None,
    ) -> Camera:
        covariance = optics.covariance
        if uncertainty is not None:
            covariance = uncertainty.covariance(0 if optics.lens is None else len(optics.lens.coefficients))
        try:
            return Camera(
                focal_length_mm=optics.focal_length_mm,
                pixel_pitch_mm=optics.pixel_pitch_mm,
                resolution=resolution,
                edge_resolution_px=edge_detector if isinstance(edge_detector, float) else 1.0,
                principal_point_px=optics.principal_point_px,
                f_number=self.f_number,
                focus_distance_mm=self.focus_distance,
                blur_limit_px=self.blur_limit,
                lens=optics.lens,
                intrinsics_covariance=covariance,
                edge_detector=edge_detector if isinstance(edge_detector, EdgeDetector) else None,
            )
        except InputError as error:
            key = self._key_of.get(error.key or "", error.key)
            raise InputError(error.problem, key=key, got=error.got, expected=error.expected, hint=error.hint) from error


class CameraSection(_CameraSection):
    """A camera whose optics the section itself states."""

    _key_of: ClassVar[dict[str, str]] = {"lens": "distortion"}

    focal_length: Length = Field(description="the lens's nominal focal length: a length, such as 16 mm")
    resolution: Resolution = Field(description="the image's columns and rows, such as [2448, 2048]")
    principal_point: PixelPair | None = Field(
        default=None,
        description='column and row of the principal point, such as "[1224, 1024] px"; by default the image\'s centre',
    )
    distortion: Coefficients | None = Field(
        default=None, description="distortion coefficients as OpenCV orders them, such as [-0.1, 0.02, 0, 0, 0]"
    )
    distortion_model: str = Field(
        default="radial-tangential", description="the lens model: radial-tangential (the default) or equidistant"
    )
    calibration: Annotated[None, Elsewhere()] = None  # with it the section is a CalibratedCameraSection

    def build(self, uncertainty: UncertaintySection | None, edge_detector: EdgeDetector | float | None) -> Camera:
        """The camera; raises InputError."""
        pitch = (self.pixel_pitch[0], self.pixel_pitch[-1])
        optics = Optics(self.focal_length, pitch, self.principal_point, self._lens(), None)
        return self._camera(optics, self.resolution, uncertainty, edge_detector)

    def _lens(self) -> Lens | None:
        if self.distortion is None:
            return None
        try:
            return Lens(self.distortion_model, self.distortion)
        except InputError as error:
            key = "distortion_model" if error.key == "model" else "distortion"
            raise InputError(error.problem, key=key, got=error.got, expected=error.expected) from error


class CalibratedCameraSection(_CameraSection):
    """A camera whose optics a calibration file states."""

    _key_of: ClassVar[dict[str, str]] = {"lens": "calibration", "intrinsics_covariance": "calibration"}

    calibration: Name = Field(
        description="a calibration file of OpenCV, ROS, Kalibr, COLMAP, MATLAB or another program, beside this one"
    )
    calibration_camera: Name | None = Field(
        default=None, description="which camera of a file that has several, such as cam0"
    )
    model: str | None = Field(
        default=None,
        description="the calibration's lens model, where its file does not say: fisheye, radial-tangential",
    )
    resolution: Resolution | None = Field(
        default=None,
        description="the image's columns and rows, such as [2448, 2048]; where the calibration does not say",
    )
    focal_length: Annotated[Any, Elsewhere()] = None
    principal_point: Annotated[Any, Elsewhere()] = None
    distortion: Annotated[Any, Elsewhere()] = None
    distortion_model: Annotated[Any, Elsewhere()] = None

    @model_validator(mode="after")
    def _once(self) -> Self:
        stated = ("focal_length", "principal_point", "distortion", "distortion_model")
        given = [name for name in stated if getattr(self, name) is not None]
        if given:
            raise InputError(
                "the calibration file says it",
                key=given[0],
                expected="calibration, or the camera's own keys",
                hint=f"remove {' and '.join(given)}, or calibration",
            )
        return self

    def build(
        self, file: CameraFile, uncertainty: UncertaintySection | None, edge_detector: EdgeDetector | float | None
    ) -> Camera:
        """The camera; raises InputError."""
        return self._camera(self._optics(file), self._resolution(file), uncertainty, edge_detector)

    def _optics(self, file: CameraFile) -> Optics:
        # the pixels' width is as stated; their height is what makes fy that of the calibration
        width, height = self.pixel_pitch[0], self.pixel_pitch[-1]
        fx, fy = file.focal_length_px
        if abs(fy * height / (fx * width) - 1) > _PITCH:
            raise InputError(
                "the pixels are of another shape than the calibration says",
                key="pixel_pitch",
                got=f"{width:g} x {height:g} mm, with fx {fx:g} px and fy {fy:g} px",
                expected=f"fx times the width within {_PITCH:.0%} of fy times the height",
            )
        pitch = (width, width * fx / fy)
        distance = fx * width  # of the image plane: the calibration's own, which focusing does not change again
        if self.focus_distance is not None:  # the nominal focal length by which the lens has it, focused there
            distance = distance / (1 + distance / self.focus_distance)
        return Optics(distance, pitch, file.principal_point_px, file.lens, file.covariance)

    def _resolution(self, file: CameraFile) -> tuple[int, int]:
        resolution = file.resolution or self.resolution
        if resolution is None:
            raise InputError(
                "the calibration file does not say it",
                key="resolution",
                expected="columns and rows, such as [2448, 2048]",
            )
        if self.resolution is not None and resolution != self.resolution:
            raise InputError(
                "the calibration is of images of another size",
                key="resolution",
                got=list(self.resolution),
                expected=f"{list(resolution)}, as the calibration file says",
            )
        return resolution


_Apart = TypeVar("_Apart", UncertaintySection, EdgeDetectorSection)


def read_camera(text: InspectionText) -> Camera | None:
    """The camera that the section states; None, and the reasons in the problems, if it cannot be."""
    if "camera" not in text.sections:
        return None
    where, value, problems = ("camera",), text.sections["camera"], text.problems
    if isinstance(value, dict) and "telecentric" in value:
        problems.add(
            (*where, "telecentric"),
            "a telecentric lens is not modelled",
            expected="a lens with a centre of projection: focal_length, or calibration",
            hint="its image scale does not change with distance, so that depth errors of the pose would count for less "
            "than with any focal length, and tilt errors for more; take what is predicted with a long focal length "
            "and a long distance as a guide only",
        )
        return None
    uncertainty = _apart(text, "calibration_uncertainty", UncertaintySection)
    stated = _apart(text, "edge_detector", EdgeDetectorSection)
    edge_detector = build(stated.build, (*where, "edge_detector"), problems) if stated else None
    unread = len(problems.found)
    make: Callable[..., Camera]
    if isinstance(value, dict) and "calibration" in value:
        calibrated = validate(CalibratedCameraSection, value, where, problems)
        if calibrated is None:
            return None
        beside = Stated(calibrated.calibration_camera, calibrated.model, calibrated.resolution)
        file = text.read_beside(read_camera_file, calibrated.calibration, (*where, "calibration"), beside)
        if file is None:
            return None
        # that the lens turns back is said below, with the field that is left
        text.findings.extend(finding for finding in file.findings if finding.name != "lens_turns_back")
        make = partial(calibrated.build, file)
    else:
        section = validate(CameraSection, value, where, problems)
        if section is None:
            return None
        make = section.build
    if len(problems.found) > unread:
        return None
    camera = build(make, where, problems, uncertainty, edge_detector)
    if camera is None:
        return None
    region = read_usable_region(text, camera)
    text.findings.extend(camera_findings(camera, value if isinstance(value, dict) else {}))
    return replace(camera, usable_region=region) if region is not None else camera


def _apart(text: InspectionText, name: str, model: type[_Apart]) -> _Apart | None:
    """A section below the camera's as its model; None where it is not stated, or not as it must be."""
    value = text.below("camera", name)
    return None if value is None else validate(model, value, ("camera", name), text.problems)
