"""A camera that is not quite what its calibration says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..error_sources.calibration import covariance_factor
from ..geometry import Lens
from ..sensors import Camera

__all__ = ["true_camera"]


def true_camera(camera: Camera, rng: np.random.Generator) -> Camera:
    """The camera with intrinsics drawn from their covariance; itself, exactly known, where it states none."""
    if camera.intrinsics_covariance is None:
        return camera
    factor = covariance_factor(np.array(camera.intrinsics_covariance))
    drawn = factor @ rng.standard_normal(len(factor))
    focal = camera.principal_distance_mm / np.asarray(camera.pixel_pitch_mm) + drawn[:2]
    pitch_u, pitch_v = camera.principal_distance_mm / focal
    centre_u, centre_v = np.asarray(camera.principal_point) + drawn[2:4]
    lens = camera.lens
    if lens is not None:
        lens = Lens(lens.model, tuple((np.asarray(lens.coefficients) + drawn[4:]).tolist()))
    return replace(
        camera,
        pixel_pitch_mm=(float(pitch_u), float(pitch_v)),
        principal_point_px=(float(centre_u), float(centre_v)),
        lens=lens,
        intrinsics_covariance=None,
    )
