"""A set-up as it is turned by hand: the values of its knobs, and the set-up that has them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...error_sources import scaled_pose_error
from ...evaluation import Requirement, Setup
from ...exceptions import InputError
from ...sensors import Camera
from .knobs import KNOBS, Rig

__all__ = ["KnobValues", "moved_along_axis", "with_pixel_pitch"]


@dataclass(frozen=True)
class KnobValues:
    """Where the knobs stand.

    Parameters
    ----------
    pixel_pitch_mm
        Width of a pixel; on a sensor of the same size.
    edge_px
        Step of the edge detector, or its noise (the larger of noise and offset, which go together), px.
    focal_length_mm
        Distances stay as they are.
    distance
        Of the viewpoints from what they look at, as a multiple of the planned one.
    translation_mm, rotation_rad
        Largest of the three standard deviations of the pose error; the whole covariance goes with it.
    required
        Value of the requirement: accuracy, error in mm, or share of the tolerance; None where it is stated by other
        figures, which stay as they are.
    probability
        Required (the paper's Th).

    Raises
    ------
    InputError
        If a value is not finite, or negative, or 0 where it must be positive.
    """

    pixel_pitch_mm: float
    edge_px: float
    focal_length_mm: float
    distance: float
    translation_mm: float
    rotation_rad: float
    required: float | None
    probability: float

    def __post_init__(self) -> None:
        for name in ("pixel_pitch_mm", "focal_length_mm", "distance"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise InputError("must be a finite positive number", key=name, got=value)
        for name in ("edge_px", "translation_mm", "rotation_rad"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise InputError("must be finite and not negative", key=name, got=value)

    @classmethod
    def of(cls, setup: Setup) -> KnobValues:
        """Where the knobs of a set-up stand."""
        camera, requirement = setup.camera, setup.requirement
        rig = Rig(camera, setup.pose_error, (0.0, 0.0))
        return cls(
            camera.pixel_pitch_mm[0],
            KNOBS["pixel"].today(rig),
            camera.focal_length_mm,
            1.0,
            KNOBS["translation"].today(rig),
            float(np.radians(KNOBS["rotation"].today(rig))),
            requirement.value if requirement.is_adjustable else None,
            requirement.probability,
        )

    def applied(self, setup: Setup) -> Setup:
        """The set-up with these values; what is 0 today stays 0.

        Raises
        ------
        InputError
            If a value is out of range, such as an accuracy above 1.
        """
        today, pose_error = KnobValues.of(setup), setup.pose_error

        def factor(name: str) -> float:
            now, was = getattr(self, name), getattr(today, name)
            return 1.0 if now == was or was == 0 else now / was

        rig = KNOBS["pixel"].turned(Rig(setup.camera, pose_error, (0.0, 0.0)), factor("edge_px"))
        camera = with_pixel_pitch(rig.camera, factor("pixel_pitch_mm"))
        camera = replace(camera, focal_length_mm=self.focal_length_mm)
        translation, rotation = factor("translation_mm"), factor("rotation_rad")
        if (translation, rotation) != (1.0, 1.0):
            pose_error = scaled_pose_error(pose_error, translation, rotation)
        return replace(setup, camera=camera, pose_error=pose_error, requirement=self._requirement(setup.requirement))

    def _requirement(self, requirement: Requirement) -> Requirement:
        changes: dict[str, Any] = {}
        if self.required is not None and self.required != requirement.value:
            changes["value"] = self.required
        if self.probability != requirement.probability and requirement.is_adjustable:
            changes["probability"] = self.probability
        return replace(requirement, **changes) if changes else requirement


def with_pixel_pitch(camera: Camera, factor: float) -> Camera:
    """Pixels larger by a factor on a sensor of the same size; the same errors of edge location in px."""
    if factor == 1.0:
        return camera
    columns, rows = camera.resolution
    u, v = camera.principal_point
    covariance = camera.intrinsics_covariance
    if covariance is not None:
        scale = np.append(np.full(4, 1 / factor), np.ones(len(covariance) - 4))
        covariance = tuple(map(tuple, (np.asarray(covariance) * np.outer(scale, scale)).tolist()))
    region = camera.usable_region
    return replace(
        camera,
        usable_region=None if region is None else region.scaled(factor),
        pixel_pitch_mm=(camera.pixel_pitch_mm[0] * factor, camera.pixel_pitch_mm[1] * factor),
        resolution=(max(round(columns / factor), 1), max(round(rows / factor), 1)),
        principal_point_px=((u + 0.5) / factor - 0.5, (v + 0.5) / factor - 0.5),
        intrinsics_covariance=covariance,
    )


def moved_along_axis(
    T_part_camera: NDArray[np.float64], target_mm: NDArray[np.float64], factor: float
) -> NDArray[np.float64]:
    """Poses ``(n, 4, 4)`` moved along their optical axes until the depth of what they look at is multiplied.

    Parameters
    ----------
    target_mm
        ``(n, 3)`` mm, part frame.
    """
    moved = np.array(T_part_camera, dtype=float)
    axis = moved[:, :3, 2]
    depth = np.einsum("ni,ni->n", target_mm - moved[:, :3, 3], axis)
    moved[:, :3, 3] += ((1 - factor) * depth)[:, None] * axis
    return moved
