"""The section ``pose_uncertainty``: how well the camera's pose is known, and the frame in which its error acts."""

from __future__ import annotations

from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, model_validator

from ...exceptions import InputError
from ...geometry import PoseError, pose_from_quaternion
from ...measurement.pose.pose_covariance import small_sample_factor
from ..files.physical_bounds import BOUNDS
from ..files.problems import KeyPath
from ..poses.covariance_file import read_covariance
from .inspection_text import InspectionText
from .validation import build, validate
from .values import AngleDeviations, Apart, LengthDeviations, Name, Point, Quaternion, Section

__all__ = ["PoseUncertaintySection", "read_pose_error"]


class FrameSection(Section):
    """The frame in which the pose error acts, in the camera frame: ``T_camera_frame``."""

    position: Point = Field(
        default=(0.0, 0.0, 0.0),
        description='the frame\'s origin in the camera frame: three lengths, such as "[0, 0, -16] mm"',
    )
    quaternion: Quaternion = Field(
        default=(1.0, 0.0, 0.0, 0.0),
        description="the frame's orientation: a unit quaternion [w, x, y, z], such as [1, 0, 0, 0]",
    )

    def build(self) -> NDArray[np.float64]:
        """The pose ``(4, 4)``, mm; raises InputError."""
        try:
            return pose_from_quaternion(self.position, self.quaternion)
        except InputError as error:
            raise InputError(error.problem, key="quaternion", got=error.got, expected=error.expected) from error


class ErrorSection(Section):
    """A pose error: standard deviations, or a covariance file, which is read apart."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [
                {"required": ["translation", "rotation"], "properties": {"covariance": False}},
                {"required": ["covariance"], "properties": {"translation": False, "rotation": False}},
            ]
        }
    )

    translation: LengthDeviations | None = Field(
        default=None, description="one or three standard deviations of the position, such as 0.1 mm"
    )
    rotation: AngleDeviations | None = Field(
        default=None, description="one or three standard deviations of the orientation, such as 0.02 deg"
    )
    covariance: Name | None = Field(
        default=None, description="a file of the 6x6 covariance, in place of translation and rotation"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        deviations = {"translation": self.translation, "rotation": self.rotation}
        given = [name for name, value in deviations.items() if value is not None]
        if self.covariance is not None and given:
            raise InputError(
                "the covariance takes the place of translation and rotation",
                key=given[0],
                expected="translation and rotation, or covariance",
                hint=f"remove {' and '.join(given)} or covariance",
            )
        if self.covariance is None and len(given) < 2:
            missing = [name for name in deviations if name not in given]
            raise InputError(
                f"required key{'s' * (len(missing) > 1)} {' and '.join(missing)} missing",
                expected="translation and rotation (standard deviations), or covariance (a file)",
                hint="write 0 mm or 0 deg where there is no such error",
            )
        return self

    def from_deviations(self) -> NDArray[np.float64]:
        """Covariance ``(6, 6)``, translation first, of the standard deviations."""
        assert self.translation is not None
        assert self.rotation is not None
        deviations = np.empty(6)
        deviations[:3], deviations[3:] = self.translation, self.rotation
        return np.diag(deviations**2)


class PoseUncertaintySection(ErrorSection):
    """The uncertainty of the camera's pose; ``common`` and ``frame`` are read apart."""

    common: Annotated[Any, Apart(ErrorSection)] = Field(
        default=None,
        description="the part of the error that all acquisitions share, beside the part drawn anew at each",
    )
    frame: Annotated[Any, Apart(FrameSection)] = Field(
        default=None, description="the frame in which the error acts; by default the camera frame"
    )

    def build(
        self,
        covariance: NDArray[np.float64],
        T_camera_frame: NDArray[np.float64] | None,
        common: NDArray[np.float64] | None = None,
    ) -> PoseError:
        """The pose error of one acquisition from what the section itself states and what is common."""
        total = covariance if common is None else covariance + common
        return PoseError(total, T_camera_frame=T_camera_frame, common_covariance=common)


def read_pose_error(text: InspectionText, probability: float | None) -> PoseError | None:
    """The pose error that the section states; None, and the reasons in the problems, if it cannot be.

    Parameters
    ----------
    probability
        The required one: a covariance estimated from few samples is enlarged as far as it asks for; None if unknown.
    """
    if "pose_uncertainty" not in text.sections:
        return None
    where, stated, problems = ("pose_uncertainty",), text.sections["pose_uncertainty"], text.problems
    section = validate(PoseUncertaintySection, stated, where, problems)
    covariance = _covariance(section, where, text, probability)
    below = stated if isinstance(stated, dict) else {}
    pose, common = None, None
    if "frame" in below:
        frame = validate(FrameSection, below["frame"], (*where, "frame"), problems)
        pose = build(frame.build, (*where, "frame"), problems) if frame else None
    if "common" in below:
        shared = validate(ErrorSection, below["common"], (*where, "common"), problems)
        common = _covariance(shared, (*where, "common"), text, probability)
    unusable = ("frame" in below and pose is None) or ("common" in below and common is None)
    if section is None or covariance is None or unusable:
        return None
    return build(section.build, where, problems, covariance, pose, common)


def _checked(covariance: NDArray[np.float64]) -> PoseError:
    """The pose error of a covariance ``(6, 6)`` that a file states; raises InputError where nothing has it."""
    with np.errstate(invalid="ignore"):
        deviations = np.sqrt(covariance.diagonal())
    for name, values in (("translation", deviations[:3]), ("rotation", deviations[3:])):
        bounds = BOUNDS[f"pose_uncertainty.{name}"]
        if (values > bounds.most).any():
            raise InputError(
                f"a standard deviation of the {name} is out of range: {bounds.reason}",
                got=f"{values.max():.3g} {bounds.unit}",
                expected=f"at most {bounds.most:.3g} {bounds.unit}",
                hint="variances are squares: of mm and rad, or of the units that the file names",
            )
    return PoseError(covariance)


def _covariance(
    section: ErrorSection | None, where: KeyPath, text: InspectionText, probability: float | None
) -> NDArray[np.float64] | None:
    """The covariance ``(6, 6)`` of a section's pose error; None, and the reason in the problems."""
    if section is None:
        return None
    if section.covariance is None:
        return section.from_deviations()
    where = (*where, "covariance")
    file = text.read_beside(read_covariance, section.covariance, where)
    checked = None if file is None else build(_checked, where, text.problems, file.covariance)
    if file is None or checked is None:
        return None
    if file.degrees_of_freedom is None or probability is None:
        return checked.covariance
    return np.asarray(checked.covariance * small_sample_factor(file.degrees_of_freedom, probability) ** 2)
