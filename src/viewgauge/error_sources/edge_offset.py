"""An offset that all edges have in common: of a bright part all lie further out, or further in, than they seem."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..geometry import PoseError
from ..sensors import Camera
from .base import Component, DrawnView, ErrorSource, LinearTerms, SourceKind

__all__ = ["EdgeOffset"]


class EdgeOffset(ErrorSource):
    """The same offset of both ends, outwards, at every acquisition (exposure, blooming, focus)."""

    name = "edge_offset"
    kind = SourceKind.COMMON
    components = (Component("edge_offset", "edges", "edge location"),)
    groups = ("camera",)
    knobs = ("pixel",)

    def size(self, camera: Camera, pose_error: PoseError) -> float:  # noqa: ARG002
        """Standard uncertainty of the offset, px."""
        return 0.0 if camera.edge_detector is None else camera.edge_detector.bias_px

    def scaled(self, camera: Camera, pose_error: PoseError, factor: float) -> tuple[Camera, PoseError]:
        """An edge detector with the offset multiplied."""
        detector = camera.edge_detector
        if detector is None:
            return camera, pose_error
        return replace(camera, edge_detector=replace(detector, bias_px=detector.bias_px * factor)), pose_error

    def standard_uncertainty(self, camera: Camera, pose_error: PoseError) -> NDArray[np.float64]:
        """``(1,)`` px."""
        return np.array([self.size(camera, pose_error)])

    def sensitivity(self, terms: LinearTerms, camera: Camera) -> NDArray[np.float64]:  # noqa: ARG002
        """``(..., 1)``: mm of image length per px of the offset."""
        return terms.gradient.get(self.name, np.zeros((*terms.pose.shape[:-1], 1)))

    def draw_width(self, camera: Camera) -> int:
        """One, for both ends and all acquisitions."""
        return int(camera.edge_detector is not None and camera.edge_detector.bias_px > 0)

    def displaced(self, px: NDArray[np.float64], drawn: NDArray[np.float64], view: DrawnView) -> NDArray[np.float64]:
        """Both ends moved outwards along the segment's image in the pixels."""
        camera, nominal = view.camera, view.images
        assert camera.edge_detector is not None  # else nothing is drawn
        outwards = camera.pixel_jacobian(nominal) @ (nominal[1] - nominal[0]) * [[-1], [1]]  # of start and end
        outwards = outwards / np.linalg.norm(outwards, axis=1, keepdims=True)
        return np.asarray(px + camera.edge_detector.bias_px * drawn[:, 0, None, None] * outwards)
