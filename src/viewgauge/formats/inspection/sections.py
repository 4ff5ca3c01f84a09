"""The keys of the inspection file: one model per section, which builds the object that the section stands for.

Values arrive as plain YAML values and leave in mm, rad and px. Every quantity carries its unit in the file.
"""

from __future__ import annotations

from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, StrictInt, StrictStr, model_validator

from ...exceptions import InputError
from ...geometry import PoseError, pose_from_quaternion
from ...part.characteristic import Observed
from ...planning.candidates.candidate_options import CandidateOptions
from ...planning.region import RegionMember
from ...visibility.limits import ObservationLimits
from ..files.units import ANGLE, LENGTH, PIXELS, RATIO, Kind, Sign, parse_quantities, parse_quantity

__all__ = [
    "AnyLength",
    "AveragingSection",
    "CandidatesSection",
    "CharacteristicSection",
    "ConeSection",
    "ErrorSection",
    "FNumber",
    "FrameSection",
    "InspectionSections",
    "Length",
    "LengthOrZero",
    "Name",
    "ObservationSection",
    "PartSection",
    "Pitch",
    "PixelPair",
    "Pixels",
    "PixelsOrZero",
    "PixelsOrZeros",
    "PoseUncertaintySection",
    "Ratio",
    "Resolution",
    "Section",
]


def _one(kind: Kind, sign: Sign) -> BeforeValidator:
    def read(value: object) -> float:
        return parse_quantity(value, kind, sign)

    return BeforeValidator(read)


def _several(kind: Kind, counts: tuple[int, ...], sign: Sign) -> BeforeValidator:
    def read(value: object) -> tuple[float, ...]:
        return parse_quantities(value, kind, counts, sign)

    return BeforeValidator(read)


def _numbers(count: int) -> BeforeValidator:
    def read(value: object) -> tuple[float, ...]:
        expected = f"{count} plain numbers, such as {[0] * (count - 1) + [1]}"
        if not isinstance(value, list) or len(value) != count:
            raise InputError(f"not {count} numbers", got=value, expected=expected)
        if not all(isinstance(item, int | float) and not isinstance(item, bool) for item in value):
            raise InputError("not plain numbers", got=value, expected=expected)
        return tuple(float(item) for item in value)

    return BeforeValidator(read)


def _read_tolerance(value: object) -> tuple[float, ...]:
    limits = parse_quantities(value, LENGTH, (1, 2))
    if len(limits) == 1:
        if limits[0] <= 0:
            raise InputError("the tolerance must be positive", got=value, expected="plus/minus, such as 0.1 mm")
        return (-limits[0], limits[0])
    if not limits[0] < limits[1]:
        raise InputError(
            "the lower deviation must be less than the upper", got=value, expected="such as [-0.05, 0.1] mm"
        )
    return limits


def _read_distance(value: object) -> tuple[float, ...]:
    limits = parse_quantities(value, LENGTH, (1, 2), "positive")
    if limits[0] > limits[-1]:
        raise InputError("the nearer distance comes first", got=value, expected="such as [300, 600] mm")
    return (limits[0], limits[-1])


def _read_name(value: object) -> object:
    if isinstance(value, str) and not value.strip():
        raise InputError("the text is empty")
    return value


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _read_unit(value: object) -> object:
    if isinstance(value, str):
        parse_quantity(f"1 {value}", LENGTH)
    return value


def _read_resolution(value: object) -> tuple[int, ...]:
    expected = "columns and rows as two positive whole numbers, such as [2448, 2048]"
    if isinstance(value, str):
        value = list(parse_quantities(value, PIXELS, (2,), "positive"))
    if not isinstance(value, list) or len(value) != 2 or any(isinstance(count, bool) for count in value):
        raise InputError("not two numbers", got=value, expected=expected)
    if not all(isinstance(count, int | float) and 1 <= count <= 1_000_000 and count % 1 == 0 for count in value):
        raise InputError("not two positive whole numbers", got=value, expected=expected)
    return tuple(int(count) for count in value)


def _read_f_number(value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not 0 < value < float("inf"):
        raise InputError("not a positive number", got=value, expected="a plain number, such as 8")
    return float(value)


Length = Annotated[float, _one(LENGTH, "positive")]
AnyLength = Annotated[float, _one(LENGTH, "any")]
LengthOrZero = Annotated[float, _one(LENGTH, "not negative")]
Angle = Annotated[float, _one(ANGLE, "positive")]
AngleOrZero = Annotated[float, _one(ANGLE, "not negative")]
Pixels = Annotated[float, _one(PIXELS, "positive")]
PixelsOrZero = Annotated[float, _one(PIXELS, "not negative")]
Ratio = Annotated[float, _one(RATIO, "positive")]
Point = Annotated[tuple[float, float, float], _several(LENGTH, (3,), "any")]
PixelsOrZeros = Annotated[tuple[float, ...], _several(PIXELS, (1, 2), "not negative")]
Resolution = Annotated[tuple[int, int], BeforeValidator(_read_resolution)]
FNumber = Annotated[float, BeforeValidator(_read_f_number)]
PixelPair = Annotated[tuple[float, float], _several(PIXELS, (2,), "any")]
Pitch = Annotated[tuple[float, ...], _several(LENGTH, (1, 2), "positive")]
Deviations = tuple[float, ...]  # one or three
LengthDeviations = Annotated[Deviations, _several(LENGTH, (1, 3), "not negative")]
AngleDeviations = Annotated[Deviations, _several(ANGLE, (1, 3), "not negative")]
Tolerance = Annotated[tuple[float, float], BeforeValidator(_read_tolerance)]
DistanceRange = Annotated[tuple[float, float], BeforeValidator(_read_distance)]
Direction = Annotated[tuple[float, float, float], _numbers(3)]
Quaternion = Annotated[tuple[float, float, float, float], _numbers(4)]
Unit = Annotated[StrictStr, BeforeValidator(_read_unit)]
Name = Annotated[StrictStr, BeforeValidator(_read_name)]
Count = Annotated[StrictInt, Field(ge=1, le=1_000_000)]
CountOrZero = Annotated[StrictInt, Field(ge=0)]


class Section(BaseModel):
    """A section of the file: no unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, protected_namespaces=())


class InspectionSections(Section):
    """The top level; the sections are read one by one."""

    camera: Any = Field(description="a section with focal_length, pixel_pitch and resolution")
    pose_uncertainty: Any = Field(description="a section with translation and rotation, or covariance")
    requirement: Any = Field(
        description="a section with accuracy, error or fraction_of_tolerance, and probability; or with another kind"
    )
    part: Any = None
    candidates: Any = None
    observation: Any = None
    averaging: Any = None
    seed: CountOrZero = 0


class PartSection(Section):
    """What is inspected; the characteristics are read one by one."""

    file: Name | None = None
    characteristics: list[Any] | None = None
    general_tolerance: Tolerance | None = None


class CharacteristicSection(Section):
    """A measurand of the user's own, or what is to be changed of a characteristic read from PMI."""

    id: Name = Field(description="a name, unique among the characteristics")
    points: Annotated[list[Any], Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="two points of the part's surface, such as [[0, 0, 40], [60, 0, 40]] with unit: mm"
    )
    unit: Unit | None = None
    tolerance: Tolerance | None = None
    observed: Observed | None = None

    @model_validator(mode="after")
    def _whole(self) -> CharacteristicSection:
        if self.points is None and self.unit is not None:
            raise InputError("the unit belongs to points", key="unit", expected="points and their unit, or neither")
        if (ends := self.ends_mm) is not None and ends[0] == ends[1]:
            raise InputError("the two points are the same", key="points", got=f"{list(ends[0])} mm")
        if self.points is None and self.tolerance is None and self.observed is None:
            raise InputError(
                "the entry says nothing but its id",
                expected="two points, or a tolerance for the characteristic of this id read from the part",
            )
        return self

    @property
    def ends_mm(self) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
        """The two points, mm, part frame; None where the entry has none; raises InputError."""
        if self.points is None:
            return None
        start, end = (self._point(point) for point in self.points)
        return start, end

    def _point(self, point: object) -> tuple[float, ...]:
        if self.unit is not None and isinstance(point, list):
            point = [f"{value} {self.unit}" if _is_number(value) else value for value in point]
        try:
            return parse_quantities(point, LENGTH, (3,))
        except InputError as error:
            raise InputError(
                error.problem,
                key="points",
                got=error.got,
                expected="two points, such as [[0, 0, 40], [60, 0, 40]] with unit: mm beside them",
                hint=error.hint,
            ) from error


class FrameSection(Section):
    """The frame in which the pose error acts, in the camera frame: ``T_camera_frame``."""

    position: Point = Field(default=(0.0, 0.0, 0.0), description='three lengths, such as "[0, 0, -16] mm"')
    quaternion: Quaternion = Field(
        default=(1.0, 0.0, 0.0, 0.0), description="a unit quaternion [w, x, y, z], such as [1, 0, 0, 0]"
    )

    def build(self) -> NDArray[np.float64]:
        """The pose ``(4, 4)``, mm; raises InputError."""
        try:
            return pose_from_quaternion(self.position, self.quaternion)
        except InputError as error:
            raise InputError(error.problem, key="quaternion", got=error.got, expected=error.expected) from error


class ErrorSection(Section):
    """A pose error: standard deviations, or a covariance file, which is read apart."""

    translation: LengthDeviations | None = None
    rotation: AngleDeviations | None = None
    covariance: Name | None = None

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

    common: Any = None
    frame: Any = None

    def build(
        self,
        covariance: NDArray[np.float64],
        T_camera_frame: NDArray[np.float64] | None,
        common: NDArray[np.float64] | None = None,
    ) -> PoseError:
        """The pose error of one acquisition from what the section itself states and what is common."""
        total = covariance if common is None else covariance + common
        return PoseError(total, T_camera_frame=T_camera_frame, common_covariance=common)


class AveragingSection(Section):
    """Whether a characteristic may be measured from several viewpoints and averaged."""

    viewpoints: Annotated[StrictInt, Field(ge=2, le=16)] = Field(description="a whole number from 2 to 16")


class ConeSection(Section):
    """The cone of directions, from the part to the camera."""

    axis: Direction = (0.0, 0.0, 1.0)
    half_angle: Angle = Field(description="an angle, such as 60 deg")

    @model_validator(mode="after")
    def _in_range(self) -> ConeSection:
        if self.half_angle > np.pi:
            raise InputError(
                "the cone's half angle is too large",
                key="half_angle",
                got=f"{np.rad2deg(self.half_angle):.6g} deg",
                expected="at most 180 deg",
            )
        if not 0 < np.linalg.norm(self.axis) < np.inf:
            raise InputError("the cone's axis is no direction", key="axis", got=list(self.axis), expected="not zero")
        return self


class CandidatesSection(Section):
    """How candidate viewpoints are sampled; the cone and the members of the allowed region are read apart.

    The keys of the allowed region are added by :func:`~viewgauge.formats.inspection.region_section.candidates_section`.
    """

    distance: DistanceRange | None = None
    distances: Count | None = None
    directions: Count | None = None
    rolls: Count | None = None
    targets: CountOrZero | None = None
    cone: Any = None
    viewpoints: Name | None = None

    def build(self, cone: ConeSection | None, regions: tuple[RegionMember, ...]) -> CandidateOptions:
        """The options, with the defaults for what is not given; raises InputError."""
        given: dict[str, Any] = {
            "distance_mm": self.distance,
            "distances": self.distances,
            "directions": self.directions,
            "rolls": self.rolls,
            "targets": self.targets,
            "regions": regions,
        }
        if self.distance is not None and self.distance[0] == self.distance[1]:
            given["distances"] = 1
        if cone is not None:
            given |= {"cone_axis": cone.axis, "cone_half_angle_rad": cone.half_angle}
        return CandidateOptions(**{name: value for name, value in given.items() if value is not None})


class ObservationSection(Section):
    """When a measurand counts as observable."""

    margin: PixelsOrZero | None = None
    minimum_length: PixelsOrZero | None = None
    grazing_angle: AngleOrZero | None = None

    def build(self) -> ObservationLimits:
        """The limits, with the defaults for what is not given; raises InputError."""
        given = {
            "margin_px": self.margin,
            "minimum_length_px": self.minimum_length,
            "grazing_angle_rad": self.grazing_angle,
        }
        return ObservationLimits(**{name: value for name, value in given.items() if value is not None})
