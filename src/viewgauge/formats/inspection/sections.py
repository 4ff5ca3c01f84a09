"""The top level of the inspection file, and its smallest sections."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, StrictInt

from ...visibility.limits import ObservationLimits
from .camera_section import CameraSection
from .part_section import PartSection
from .pose_uncertainty_section import PoseUncertaintySection
from .region_section import candidates_section
from .requirement_section import requirement_model
from .values import AngleOrZero, Apart, CountOrZero, Name, PixelsOrZero, Section

__all__ = ["AveragingSection", "InspectionSections", "ObservationSection"]


class ObservationSection(Section):
    """When a measurand counts as observable."""

    margin: PixelsOrZero | None = Field(
        default=None, description="border of the image where no end of a measurand may lie, by default 8 px"
    )
    minimum_length: PixelsOrZero | None = Field(
        default=None, description="shortest image of a measurand, by default 16 px"
    )
    grazing_angle: AngleOrZero | None = Field(
        default=None,
        description="least angle between the line of sight and a face that counts as seen, by default 10 deg",
    )

    def build(self) -> ObservationLimits:
        """The limits, with the defaults for what is not given; raises InputError."""
        given = {
            "margin_px": self.margin,
            "minimum_length_px": self.minimum_length,
            "grazing_angle_rad": self.grazing_angle,
        }
        return ObservationLimits(**{name: value for name, value in given.items() if value is not None})


class AveragingSection(Section):
    """Whether a characteristic may be measured from several viewpoints and averaged."""

    viewpoints: Annotated[StrictInt, Field(ge=2, le=16)] = Field(
        description="from how many viewpoints a characteristic may be measured: a whole number from 2 to 16"
    )


class InspectionSections(Section):
    """The top level; the sections are read one by one."""

    part: Annotated[Any, Apart(PartSection, optional=True)] = Field(
        default=None, description="the part, and characteristics beside those of its PMI"
    )
    camera: Annotated[Any, Apart(CameraSection)] = Field(
        description="the camera: a section with focal_length, pixel_pitch and resolution"
    )
    pose_uncertainty: Annotated[Any, Apart(PoseUncertaintySection)] = Field(
        description="the uncertainty of the camera's pose: a section with translation and rotation, or covariance"
    )
    requirement: Annotated[Any, Apart(requirement_model())] = Field(
        description="how accurately to measure: a section with accuracy, error or fraction_of_tolerance, and "
        "probability; or with another kind"
    )
    candidates: Annotated[Any, Apart(candidates_section(), optional=True)] = Field(
        default=None, description="where the camera may stand, and how viewpoints are sampled there"
    )
    observation: Annotated[Any, Apart(ObservationSection, optional=True)] = Field(
        default=None, description="when a measurand counts as observable"
    )
    averaging: Annotated[Any, Apart(AveragingSection)] = Field(
        default=None, description="averages over several viewpoints; by default none"
    )
    accept: list[Name] = Field(
        default=[], description="names of findings that are meant as they are, such as [line_scan]; by default none"
    )
    seed: CountOrZero = Field(
        default=0, description="the seed of all sampling: the same seed gives the same plan; by default 0"
    )
