"""Quantization of the ends' places in the image: the paper's whole-pixel edge detector, or a finer step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..geometry import PoseError
from ..sensors import Camera
from .base import Component, DrawnView, ErrorSource, LinearTerms, SourceKind

__all__ = ["Quantization"]


class Quantization(ErrorSource):
    """Each end is located within half a step along u and v, uniformly; a sub-pixel edge detector has none."""

    name = "quantization"
    kind = SourceKind.TRIANGULAR
    components = (Component("pixel_u", "u", "pixels along u"), Component("pixel_v", "v", "pixels along v"))
    groups = ("pixels", "camera")
    knobs = ("pixel",)

    def size(self, camera: Camera, pose_error: PoseError) -> float:  # noqa: ARG002
        """The step, px."""
        return 0.0 if camera.edge_detector is not None else camera.edge_resolution_px

    def scaled(self, camera: Camera, pose_error: PoseError, factor: float) -> tuple[Camera, PoseError]:
        """A step that is multiplied."""
        if camera.edge_detector is not None:
            return camera, pose_error
        return replace(camera, edge_resolution_px=camera.edge_resolution_px * factor), pose_error

    def standard_uncertainty(self, camera: Camera, pose_error: PoseError) -> NDArray[np.float64]:
        """``(2,)`` px: of the difference of two uniform errors."""
        return np.full(2, self.size(camera, pose_error) / np.sqrt(6))

    def sensitivity(self, terms: LinearTerms, camera: Camera) -> NDArray[np.float64]:
        """``(..., 2)``: mm of image length per px of the ends' difference."""
        step = 0.0 if camera.edge_detector is not None else camera.edge_resolution_px
        return np.asarray(np.sign(terms.direction) * terms.half_widths_mm / (step or 1.0))

    def draw_width(self, camera: Camera) -> int:
        """Four: start and end along u and v."""
        return 4 * (max(camera.quantization_step_mm) > 0)

    def drawn(self, uniform: NDArray[np.float64]) -> NDArray[np.float64]:
        """``(n, 2, 2)``: of start and end along u and v, in steps, within half a step."""
        return uniform.reshape(len(uniform), 2, 2) - 0.5

    def displaced(self, px: NDArray[np.float64], drawn: NDArray[np.float64], view: DrawnView) -> NDArray[np.float64]:
        """Ends that are off by the drawn shares of a step."""
        return np.asarray(px + drawn * view.camera.edge_resolution_px)
