"""The keys of the inspection file's camera section."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import BeforeValidator, Field, StrictInt, model_validator

from ...errors import edge_point_deviation
from ...exceptions import InputError
from ...geometry import Lens
from ...sensors import Camera, EdgeDetector
from ..cameras.camera_file import CameraFile
from .sections import FNumber, Length, Name, Pitch, PixelPair, Pixels, PixelsOrZero, PixelsOrZeros, Resolution, Section

__all__ = ["CalibratedCameraSection", "CameraSection", "EdgeDetectorSection", "UncertaintySection"]


def _read_coefficients(value: object) -> tuple[float, ...]:
    expected = "plain numbers, such as [-0.1, 0.02, 0, 0, 0]"
    if not isinstance(value, list) or not all(isinstance(v, int | float) and not isinstance(v, bool) for v in value):
        raise InputError("not a list of numbers", got=value, expected=expected)
    return tuple(float(v) for v in value)


def _read_ratio(value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not 0 < value < float("inf"):
        raise InputError("not a positive number", got=value, expected="a plain number, such as 50")
    return float(value)


_PITCH = 0.02  # how far the shape of the pixels may be from what the calibration says

Coefficients = Annotated[tuple[float, ...], BeforeValidator(_read_coefficients)]


@dataclass(frozen=True)
class Optics:
    """Where a camera sees points: the units are those of :class:`Camera`."""

    focal_length_mm: float
    pixel_pitch_mm: tuple[float, float]
    principal_point_px: tuple[float, float] | None
    lens: Lens | None
    covariance: tuple[tuple[float, ...], ...] | None


class EdgeDetectorSection(Section):
    """How edges are found: by quantization (the paper's), or sub-pixel, with the noise of an edge point."""

    quantization: PixelsOrZero | None = None
    noise: PixelsOrZero | None = None
    signal_to_noise: Annotated[float, BeforeValidator(_read_ratio)] | None = None
    blur: PixelsOrZero | None = None
    samples: Annotated[StrictInt, Field(ge=1, le=1000)] = 1
    smoothing: Pixels | None = None
    offset: PixelsOrZero = 0.0
    edge_points: Annotated[StrictInt, Field(ge=2, le=10_000)] | None = None
    clear_of_corner: PixelsOrZero = 0.0

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.quantization is not None:
            others = [name for name in self.model_fields_set if name != "quantization"]
            if others:
                raise InputError(
                    "a sub-pixel edge detector takes the place of quantization",
                    key="quantization",
                    expected=f"quantization, or {', '.join(sorted(others))}",
                )
            return self
        if (self.noise is None) == (self.signal_to_noise is None):
            raise InputError(
                "the noise of an edge point is stated once",
                key="noise" if self.noise is not None else None,
                expected="noise (px), or signal_to_noise with blur; or quantization (px) alone",
            )
        if self.signal_to_noise is not None and self.blur is None:
            raise InputError("required key missing", key="blur", expected="the lens's blur, such as 0.7 px")
        if self.noise is not None and (self.blur is not None or self.smoothing is not None or self.samples != 1):
            raise InputError("noise stands for blur, samples and smoothing", key="noise", expected="it alone")
        return self

    def build(self) -> EdgeDetector | float:
        """The edge detector, or the quantization step, px; raises InputError."""
        if self.quantization is not None:
            return self.quantization
        noise = self.noise
        if noise is None:
            assert self.signal_to_noise is not None and self.blur is not None  # noqa: PT018  # see _one_way
            noise = float(edge_point_deviation(self.signal_to_noise, self.blur, self.samples, self.smoothing))
        return EdgeDetector(noise, self.offset, self.edge_points, self.clear_of_corner)


class UncertaintySection(Section):
    """Standard uncertainties of the calibration; without correlations, which a calibration file may state."""

    focal_length: PixelsOrZeros = Field(description="one or two numbers of pixels, such as 0.5 px")
    principal_point: PixelsOrZeros = Field(description="one or two numbers of pixels, such as 0.8 px")
    distortion: Coefficients = ()

    def covariance(self, coefficients: int) -> tuple[tuple[float, ...], ...]:
        """Of fx, fy, cx, cy and so many coefficients; raises InputError."""
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
    """What every camera has; ``edge_detector`` and ``calibration_uncertainty`` are read apart."""

    pixel_pitch: Pitch = Field(description="a length, such as 3.45 um")
    calibration_uncertainty: Any = None
    edge_detector: Any = None
    f_number: FNumber | None = None
    focus_distance: Length | None = None
    blur_limit: Pixels = 1.0

    _key_of: ClassVar[dict[str, str]]
    """Which key states what the camera calls otherwise."""

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

    focal_length: Length = Field(description="a length, such as 16 mm")
    resolution: Resolution = Field(description="columns and rows, such as [2448, 2048]")
    principal_point: PixelPair | None = None
    distortion: Coefficients | None = None
    distortion_model: str = "radial-tangential"
    calibration: None = None  # with it the section is a CalibratedCameraSection

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

    calibration: Name
    calibration_camera: Name | None = None
    resolution: Resolution | None = None
    focal_length: Any = None
    principal_point: Any = None
    distortion: Any = None
    distortion_model: Any = None

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
        return Optics(fx * width, pitch, file.principal_point_px, file.lens, file.covariance)

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
