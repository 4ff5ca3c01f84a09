"""The inspection file: what is inspected, with which camera, how its pose is known, and what is required."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...evaluation import Setup
from ...findings import Finding
from ...part import Part
from ...planning.inspection import ExplicitViewpoints, Inspection
from ...visibility.limits import ObservationLimits
from .camera_section import read_camera
from .inspection_text import InspectionText, read_inspection_text
from .part_section import CharacteristicEntry, PartSection, read_characteristics
from .pose_uncertainty_section import read_pose_error
from .region_section import read_options
from .requirement_section import read_requirement
from .sections import AveragingSection, InspectionSections, ObservationSection
from .validation import build, validate

__all__ = ["CharacteristicEntry", "InspectionFile", "read_inspection_file"]


@dataclass(frozen=True)
class InspectionFile:
    """What an inspection file says, all in mm, rad and px; with a part it gives an :class:`Inspection`.

    Parameters
    ----------
    path
        The file itself.
    part_file
        CAD file or mesh; None where the file names none. This and the other paths are as written where absolute,
        else from the folder of the inspection file; whether they exist is found when they are read.
    characteristics
        Measurands of the user's own and changes to characteristics of the PMI.
    datums
        Ids of the features that are datums, by the datums' letters.
    general_tolerance_mm
        (lower, upper) deviation, mm, of characteristics that have none of their own; None where not given. It is not
        yet applied to ``characteristics``.
    viewpoints_file
        Explicit viewpoints, which take the place of sampled ones; None where not given.
    other_files
        Files that were read along with this one: covariance, common covariance, calibration.
    setup
        Camera, pose error, requirement and limits.
    accepted
        Names of findings that the user accepts.
    findings
        What is implausible in the files that this one names.
    calibration_file
        Of the camera; None where the file itself states the optics.
    """

    path: Path
    part_file: Path | None
    characteristics: tuple[CharacteristicEntry, ...]
    datums: Mapping[str, str]
    general_tolerance_mm: tuple[float, float] | None
    viewpoints_file: Path | None
    other_files: tuple[Path, ...]
    setup: Setup
    accepted: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    calibration_file: Path | None = None
    _planning: Mapping[str, Any] = field(default_factory=dict)  # fields of Inspection that are not of the set-up

    @property
    def distance_mm(self) -> tuple[float, float] | None:
        """Nearest and farthest distance at which candidates are sampled, mm; None where it is not stated."""
        distances: tuple[float, float] | None = self._planning["candidates"].distance_mm
        return None if self.viewpoints_file is not None else distances

    @property
    def is_calibrated(self) -> bool:
        """Whether a calibration file states the camera's optics."""
        return self.calibration_file is not None

    def inspection(
        self,
        part: Part,
        *,
        name: str = "inspection",
        viewpoints: ExplicitViewpoints | None = None,
        inputs: Mapping[str, str] | None = None,
    ) -> Inspection:
        """The inspection of a part as this file states it.

        Parameters
        ----------
        viewpoints
            What ``viewpoints_file`` holds.
        inputs
            SHA-256 of each input file, by its name.
        """
        return Inspection(
            part=part,
            camera=self.setup.camera,
            pose_error=self.setup.pose_error,
            requirement=self.setup.requirement,
            limits=self.setup.limits,
            viewpoints=viewpoints,
            name=name,
            inputs=inputs or {},
            **self._planning,
        )


def read_inspection_file(path: str | os.PathLike[str] | InspectionText) -> InspectionFile:
    """Read and check an inspection file, or one whose text is read already.

    Raises
    ------
    InspectionFileError
        With everything that is wrong with it: file, line, dotted key, what was got and what was expected.
    """
    text = path if isinstance(path, InspectionText) else read_inspection_text(path)
    problems = text.problems
    top = validate(InspectionSections, text.sections, (), problems)
    part = validate(PartSection, _section(text, "part"), ("part",), problems)
    characteristics = read_characteristics(text.below("part", "characteristics"), problems)
    camera = read_camera(text)
    requirement = read_requirement(text.sections["requirement"], problems) if "requirement" in text.sections else None
    pose_error = read_pose_error(text, None if requirement is None else requirement.probability)
    candidates = read_options(_section(text, "candidates"), problems)
    limits, averaged_viewpoints = _limits(text), _averaged_viewpoints(text)
    problems.raise_if_any()
    # nothing is None now: each would have left a problem
    assert top and part and camera and pose_error and requirement and candidates  # noqa: PT018
    assert limits and averaged_viewpoints  # noqa: PT018
    section, options = candidates
    named = [_file(text, "pose_uncertainty", "covariance")]
    calibration = _file(text, "camera", "calibration")
    named += [_file(text, "pose_uncertainty", "common", "covariance"), calibration]
    return InspectionFile(
        path=text.path,
        part_file=None if part.file is None else text.beside(part.file, "part.file"),
        characteristics=characteristics,
        datums=part.datums or {},
        general_tolerance_mm=part.general_tolerance,
        viewpoints_file=None
        if section.viewpoints is None
        else text.beside(section.viewpoints, "candidates.viewpoints"),
        other_files=tuple(file for file in named if file is not None),
        setup=Setup(camera, pose_error, requirement, limits),
        accepted=tuple(top.accept),
        findings=tuple(text.findings),
        calibration_file=calibration,
        _planning={"candidates": options, "seed": top.seed, "averaged_viewpoints": averaged_viewpoints},
    )


def _section(text: InspectionText, name: str) -> object:
    """An optional section: absent or with nothing below it is the same as one without keys."""
    value = text.sections.get(name)
    return {} if value is None else value


def _file(text: InspectionText, *keys: str) -> Path | None:
    """The file that a key of sections found right names; None where it is not given."""
    value: Any = text.sections
    for key in keys:
        value = value.get(key)
        if value is None:
            return None
    return text.beside(value, ".".join(keys))


def _limits(text: InspectionText) -> ObservationLimits | None:
    section = validate(ObservationSection, _section(text, "observation"), ("observation",), text.problems)
    return build(section.build, ("observation",), text.problems) if section else None


def _averaged_viewpoints(text: InspectionText) -> int | None:
    """The number of viewpoints over which a characteristic may be averaged; None where it cannot be used."""
    if "averaging" not in text.sections:
        return 1
    section = validate(AveragingSection, _section(text, "averaging"), ("averaging",), text.problems)
    pose_error = text.sections.get("pose_uncertainty")
    if isinstance(pose_error, dict) and "common" not in pose_error:
        text.problems.add(
            ("pose_uncertainty", "common"),
            "averaging several viewpoints helps only against what is drawn anew at each",
            expected="pose_uncertainty.common: the part of the error that all acquisitions share (calibration, "
            "hand-eye)",
            hint="state it; write translation: 0 mm and rotation: 0 deg there if there is none",
        )
    return section.viewpoints if section else None
