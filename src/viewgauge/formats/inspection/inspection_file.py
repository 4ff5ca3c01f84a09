"""The inspection file: what is inspected, with which camera and head, and what is required."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from ...evaluation.requirement.allowed_error import Requirement
from ...exceptions import InspectionFileError
from ...geometry import PoseError
from ...measurement.pose.pose_covariance import small_sample_factor
from ...part.characteristic import Observed
from ...planning.candidates.candidate_options import CandidateOptions
from ...sensors import Camera
from ...visibility.limits import ObservationLimits
from ..cameras.camera_file import CameraFile, read_camera_file
from ..files.problems import KeyPath
from ..poses.covariance_file import CovarianceFile, read_covariance
from .camera_section import CalibratedCameraSection, CameraSection, EdgeDetectorSection, UncertaintySection
from .inspection_text import InspectionText, read_inspection_text
from .region_section import BoxSection, HemisphereSection
from .requirement_section import read_requirement
from .sections import (
    AveragingSection,
    CandidatesSection,
    CharacteristicSection,
    ConeSection,
    ErrorSection,
    FrameSection,
    InspectionSections,
    ObservationSection,
    PartSection,
    PoseUncertaintySection,
)
from .validation import build, validate

__all__ = ["CharacteristicEntry", "InspectionFile", "read_inspection_file"]


@dataclass(frozen=True)
class CharacteristicEntry:
    """An entry of ``part.characteristics``.

    Parameters
    ----------
    id
        Unique within the file.
    ends_mm
        The two points of a measurand, mm, part frame; None where the entry changes the characteristic of this id
        that was read from the part's PMI.
    tolerance_mm
        (lower, upper) deviation, mm; None where not given.
    observed
        What must be seen; None where not given ("ends" for a measurand, unchanged for a characteristic of the PMI).
    line
        1-based line in the inspection file, for messages.
    """

    id: str
    ends_mm: tuple[tuple[float, ...], tuple[float, ...]] | None
    tolerance_mm: tuple[float, float] | None
    observed: Observed | None
    line: int

    @property
    def is_override(self) -> bool:
        """The entry changes a characteristic of the PMI instead of adding one."""
        return self.ends_mm is None


_Place = TypeVar("_Place", BoxSection, HemisphereSection)
_File = TypeVar("_File", CameraFile, CovarianceFile)
_Apart = TypeVar("_Apart", UncertaintySection, EdgeDetectorSection)


@dataclass(frozen=True)
class InspectionFile:
    """An inspection file, all in mm, rad and px.

    Parameters
    ----------
    path
        The file itself.
    part_file
        CAD file or mesh; None where the file names none. This and the other paths are as written where absolute,
        else from the folder of the inspection file; whether they exist is found when they are read.
    characteristics
        Measurands of the user's own and changes to characteristics of the PMI.
    general_tolerance_mm
        (lower, upper) deviation, mm, of characteristics that have none of their own; None where not given. It is not
        yet applied to ``characteristics``.
    viewpoints_file
        Explicit viewpoints, which take the place of sampled ones; None where not given.
    covariance_file
        Where the covariance of ``pose_error`` was read from; None where the file states standard deviations.
    common_covariance_file
        The same for ``pose_uncertainty.common``.
    calibration_file
        Where the camera's calibration was read from; None where the file states it.
    averaged_viewpoints
        From how many viewpoints a characteristic may be measured and averaged; 1 where the file does not allow several.
    """

    path: Path
    part_file: Path | None
    characteristics: tuple[CharacteristicEntry, ...]
    general_tolerance_mm: tuple[float, float] | None
    camera: Camera
    pose_error: PoseError
    requirement: Requirement
    candidates: CandidateOptions
    viewpoints_file: Path | None
    covariance_file: Path | None
    limits: ObservationLimits
    seed: int
    common_covariance_file: Path | None = None
    calibration_file: Path | None = None
    averaged_viewpoints: int = 1


def read_inspection_file(path: str | os.PathLike[str] | InspectionText) -> InspectionFile:
    """Read and check an inspection file, or one whose text is read already.

    Raises
    ------
    InspectionFileError
        With everything that is wrong with it: file, line, dotted key, what was got and what was expected.
    """
    text = path if isinstance(path, InspectionText) else read_inspection_text(path)
    return _Reader(text).read()


class _Reader:
    """Reads the sections one by one, gathering the problems of all of them."""

    def __init__(self, text: InspectionText) -> None:
        self.text, self.path, self.sections, self.problems = text, text.path, text.sections, text.problems

    def read(self) -> InspectionFile:
        """The whole file; raises InspectionFileError."""
        top = validate(InspectionSections, self.sections, (), self.problems)
        part = validate(PartSection, self._section("part"), ("part",), self.problems)
        characteristics = self._characteristics()
        camera, requirement = self._camera(), self._requirement()
        pose_error = self._pose_error(None if requirement is None else requirement.probability)
        candidates = validate(CandidatesSection, self._section("candidates"), ("candidates",), self.problems)
        options = self._options(candidates)
        limits, averaged_viewpoints = self._limits(), self._averaged_viewpoints()
        self.problems.raise_if_any()
        # nothing is None now: each would have left a problem
        assert top and part and camera and pose_error and requirement and candidates  # noqa: PT018
        assert options and limits and averaged_viewpoints  # noqa: PT018
        stated = cast(dict[str, Any], self.sections["pose_uncertainty"])
        return InspectionFile(
            path=self.path,
            part_file=self._path(part.file, "part.file"),
            characteristics=characteristics,
            general_tolerance_mm=part.general_tolerance,
            camera=camera,
            pose_error=pose_error,
            requirement=requirement,
            candidates=options,
            viewpoints_file=self._path(candidates.viewpoints, "candidates.viewpoints"),
            covariance_file=self._path(stated.get("covariance"), "pose_uncertainty.covariance"),
            limits=limits,
            seed=top.seed,
            common_covariance_file=self._path(
                stated.get("common", {}).get("covariance"), "pose_uncertainty.common.covariance"
            ),
            calibration_file=self._path(
                cast(dict[str, Any], self.sections["camera"]).get("calibration"), "camera.calibration"
            ),
            averaged_viewpoints=averaged_viewpoints,
        )

    def _section(self, name: str) -> object:
        """An optional section: absent or with nothing below it is the same as one without keys."""
        value = self.sections.get(name)
        return {} if value is None else value

    def _below(self, section: str, key: str) -> object:
        """A value below a section, read apart so that its problems are told even where the section has others."""
        value = self.sections.get(section)
        return value.get(key) if isinstance(value, dict) else None

    def _path(self, name: str | None, key: str) -> Path | None:
        return None if name is None else self.text.beside(name, key)

    def _camera(self) -> Camera | None:
        if "camera" not in self.sections:
            return None
        where = ("camera",)
        uncertainty = self._apart("calibration_uncertainty", UncertaintySection)
        of_edge_detector = self._apart("edge_detector", EdgeDetectorSection)
        edge_detector = (
            build(of_edge_detector.build, (*where, "edge_detector"), self.problems) if of_edge_detector else None
        )
        unread = len(self.problems.found)
        value = self.sections["camera"]
        make: Callable[..., Camera]
        if isinstance(value, dict) and "calibration" in value:
            calibrated = validate(CalibratedCameraSection, value, where, self.problems)
            if calibrated is None:
                return None
            path = self.text.beside(calibrated.calibration, "camera.calibration")
            name = calibrated.calibration_camera
            file = self._file(read_camera_file, path, (*where, "calibration"), name)
            if file is None:
                return None
            make = partial(calibrated.build, file)
        else:
            section = validate(CameraSection, value, where, self.problems)
            if section is None:
                return None
            make = section.build
        return (
            build(make, where, self.problems, uncertainty, edge_detector)
            if len(self.problems.found) == unread
            else None
        )

    def _apart(self, name: str, model: type[_Apart]) -> _Apart | None:
        """A part of the camera section as its model; None where it is not stated, or not as it must be."""
        value = self._below("camera", name)
        return None if value is None else validate(model, value, ("camera", name), self.problems)

    def _requirement(self) -> Requirement | None:
        if "requirement" not in self.sections:
            return None
        return read_requirement(self.sections["requirement"], self.problems)

    def _limits(self) -> ObservationLimits | None:
        section = validate(ObservationSection, self._section("observation"), ("observation",), self.problems)
        return build(section.build, ("observation",), self.problems) if section else None

    def _options(self, section: CandidatesSection | None) -> CandidateOptions | None:
        cone = None
        if (value := self._below("candidates", "cone")) is not None:
            cone = validate(ConeSection, value, ("candidates", "cone"), self.problems)
        box = self._place(BoxSection, self._below("candidates", "box"), "box")
        hemisphere = self._place(HemisphereSection, self._below("candidates", "hemisphere"), "hemisphere")
        listed = self._below("candidates", "forbidden")
        boxes = [
            self._place(BoxSection, value, "forbidden", k)
            for k, value in enumerate(listed if isinstance(listed, list) else ())
        ]
        if section is None:
            return None
        forbidden = tuple(place for place in boxes if place is not None)
        places = {"box": box, "hemisphere": hemisphere, "forbidden": forbidden}
        return build(partial(section.build, **places), ("candidates",), self.problems, cone)

    def _place(self, section: type[_Place], value: object, *where: str | int) -> Any:
        """What a section of places stands for; None where there is none, or a problem was noted."""
        if value is None and len(where) == 1:
            return None
        found = validate(section, value, ("candidates", *where), self.problems)
        return None if found is None else found.build()

    def _characteristics(self) -> tuple[CharacteristicEntry, ...]:
        values = self._below("part", "characteristics")
        entries: dict[str, CharacteristicEntry] = {}
        for index, value in enumerate(values if isinstance(values, list) else ()):
            where = ("part", "characteristics", index)
            section = validate(CharacteristicSection, value, where, self.problems)
            if section is None:
                continue
            line = self.problems.line_of(where) or 1
            if section.id in entries:
                first = f"'{section.id}', first in line {entries[section.id].line}"
                self.problems.add((*where, "id"), "the id is used twice", got=first, expected="a unique id")
                continue
            entries[section.id] = CharacteristicEntry(
                section.id, section.ends_mm, section.tolerance, section.observed, line
            )
        return tuple(entries.values())

    def _pose_error(self, probability: float | None) -> PoseError | None:
        """The pose error; a covariance from few samples is made as large as the required probability asks for."""
        if "pose_uncertainty" not in self.sections:
            return None
        where = ("pose_uncertainty",)
        section = validate(PoseUncertaintySection, self.sections["pose_uncertainty"], where, self.problems)
        pose, common, stated = None, None, self.sections["pose_uncertainty"]
        if isinstance(stated, dict) and "frame" in stated:
            pose_section = validate(FrameSection, stated["frame"], (*where, "frame"), self.problems)
            pose = build(pose_section.build, (*where, "frame"), self.problems) if pose_section else None
            if pose is None:
                section = None
        covariance = self._error(section, where, probability)
        if isinstance(stated, dict) and "common" in stated:
            common_section = validate(ErrorSection, stated["common"], (*where, "common"), self.problems)
            common = self._error(common_section, (*where, "common"), probability)
            if common is None:
                return None
        if section is None or covariance is None:
            return None
        return build(section.build, where, self.problems, covariance, pose, common)

    def _error(
        self, section: ErrorSection | None, where: KeyPath, probability: float | None
    ) -> NDArray[np.float64] | None:
        """The covariance ``(6, 6)`` of a pose error's section; None, and the reason in the problems."""
        if section is None:
            return None
        if section.covariance is None:
            return section.from_deviations()
        where = (*where, "covariance")
        path = self.text.beside(section.covariance, ".".join(map(str, where)))
        file = self._file(read_covariance, path, where)
        checked = None if file is None else build(PoseError, where, self.problems, file.covariance)
        if file is None or checked is None:
            return None
        if file.degrees_of_freedom is None or probability is None:
            return checked.covariance
        return np.asarray(checked.covariance * small_sample_factor(file.degrees_of_freedom, probability) ** 2)

    def _file(self, read: Callable[..., _File], path: Path, where: KeyPath, *arguments: Any) -> _File | None:
        """What another file holds; None, and the reason in the problems, where it cannot be read."""
        try:
            return read(path, *arguments)
        except InspectionFileError as error:
            if Path(path).is_file():
                self.problems.found.append(error)
            else:  # then the place to mend is here
                self.problems.add(where, error.problem, got=path, hint=error.hint)
            return None

    def _averaged_viewpoints(self) -> int | None:
        """From how many viewpoints a characteristic may be averaged."""
        if "averaging" not in self.sections:
            return 1
        section = validate(AveragingSection, self._section("averaging"), ("averaging",), self.problems)
        pose_error = self.sections.get("pose_uncertainty")
        if isinstance(pose_error, dict) and "common" not in pose_error:
            self.problems.add(
                ("pose_uncertainty", "common"),
                "averaging several viewpoints helps only against what is drawn anew at each",
                expected=(
                    "pose_uncertainty.common: the part of the error that all acquisitions share (calibration, hand-eye)"
                ),
                hint="state it; write translation: 0 mm and rotation: 0 deg there if there is none",
            )
        return section.viewpoints if section else None
