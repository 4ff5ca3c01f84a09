"""What to improve, as results: for characteristics and the part the least change of one thing, and what trades for
what.
"""

from __future__ import annotations

from dataclasses import dataclass

from ...part import NotMeasurable
from .catalogue import SensorFormat

__all__ = ["CameraChoice", "Change", "CharacteristicChanges", "Improvement", "Specification", "TradeOff"]


@dataclass(frozen=True)
class Change:
    """The least change of one thing, all else as today, with which a characteristic or the part is met.

    Parameters
    ----------
    factor
        Of today's value; None where no factor will do. At least 1 where it is met today: by so much it may be worse.
        Of focal length and distance that end of the interval which is nearest to 1.
    value
        Today's times the factor, in the knob's unit.
    interval
        Values between which it is met; None for an end that nothing limits (of errors the lower one is 0).
    unlimited
        It is still met at 1024 times the error, or at the longest or shortest that was tried.
    best_probability
        Of a characteristic where no factor will do: its probability without the error. None else.
    verified
        Evaluated afresh: met at the answer, and not met 0.1 % beyond it.
    limited_by
        The characteristics that are met no further, or those for which no factor will do, where they are known.
    """

    factor: float | None
    value: float | None
    interval: tuple[float | None, float | None] | None
    unlimited: bool
    best_probability: float | None
    verified: bool
    limited_by: tuple[str, ...] = ()


@dataclass(frozen=True)
class CharacteristicChanges:
    """A characteristic today, and for each knob the least change."""

    id: str
    met: bool
    probability: float
    changes: dict[str, Change]


@dataclass(frozen=True)
class TradeOff:
    """With a quantization step of ``pixel_px`` the largest factor of the pose error with which the part is met.

    None where it is not met even without pose error.
    """

    pixel_px: float
    pose_error_factor: float | None
    translation_mm: float | None
    rotation_deg: float | None
    verified: bool


@dataclass(frozen=True)
class Improvement:
    """What to improve.

    Parameters
    ----------
    today
        Of each knob its value.
    part
        For all characteristics together, but for ``left_out``.
    left_out
        Characteristics that are not met even without any pixel and pose error: what the camera sees is in the way.
    viewpoints
        How many were tried: the candidates, and what refining found.
    """

    today: dict[str, float]
    characteristics: tuple[CharacteristicChanges, ...]
    part: dict[str, Change]
    trade_off: tuple[TradeOff, ...]
    left_out: tuple[str, ...]
    not_measurable: tuple[NotMeasurable, ...]
    viewpoints: int


@dataclass(frozen=True)
class CameraChoice:
    """A sensor with a lens, and how small the pose error has to be.

    Parameters
    ----------
    distance_mm
        (nearest, farthest) of the candidates.
    met
        How many characteristics are met with the pose error of today.
    pose_error
        The largest factor of the pose error with which the part is met; ``limited_by`` are those characteristics that
        are not met even without pose error.
    translation_mm, rotation_deg
        The largest standard deviations with that factor; None where no factor will do, or where there is no such error
        today.
    pixel
        With the pose error of today the coarsest step of the edge detector, px, with which the part is met; None where
        the edge detector is ideal today.
    """

    sensor: SensorFormat
    focal_length_mm: float
    distance_mm: tuple[float, float]
    met: int
    pose_error: Change
    translation_mm: float | None
    rotation_deg: float | None
    pixel: Change | None

    @property
    def rank(self) -> tuple[float, ...]:
        """A larger pose error, then more characteristics met, then a coarser edge detector: the best is highest."""
        coarsest = 0.0 if self.pixel is None else self.pixel.factor or 0.0
        return (-1.0 if self.pose_error.factor is None else self.pose_error.factor, self.met, coarsest)


@dataclass(frozen=True)
class Specification:
    """Cameras for a part.

    Parameters
    ----------
    choices
        Of every sensor and focal length for which a candidate is left; fewest pixels, then shortest lens first.
    characteristics
        How many there are to be met.
    """

    choices: tuple[CameraChoice, ...]
    characteristics: int
    not_measurable: tuple[NotMeasurable, ...]

    @property
    def best(self) -> tuple[CameraChoice, ...]:
        """Of each sensor the lens that allows the largest pose error."""
        by_sensor: dict[str, CameraChoice] = {}
        for choice in self.choices:
            before = by_sensor.get(choice.sensor.name)
            if before is None or choice.rank > before.rank:
                by_sensor[choice.sensor.name] = choice
        return tuple(by_sensor.values())

    @property
    def smallest(self) -> CameraChoice | None:
        """The camera of the fewest pixels that meets the part with the pose error of today; None where none does."""
        return next((c for c in self.best if c.pose_error.factor is not None and c.pose_error.factor >= 1), None)
