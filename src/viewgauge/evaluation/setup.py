"""What travels together: the camera, the uncertainty of its pose, the requirement, and what counts as observable."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..geometry import PoseError
from ..part import Characteristic
from ..sensors import Camera
from ..visibility import ObservationLimits
from .requirement.allowed_error import Requirement

__all__ = ["Setup"]


@dataclass(frozen=True)
class Setup:
    """The measurement set-up that every viewpoint shares.

    Parameters
    ----------
    camera
        The sensor, with its edge detector.
    pose_error
        Uncertainty of the camera's pose.
    requirement
        How accurately, and with what probability, a characteristic must be measured.
    limits
        When a measurand counts as observable.
    """

    camera: Camera
    pose_error: PoseError
    requirement: Requirement
    limits: ObservationLimits = field(default_factory=ObservationLimits)

    def allowed_error_mm(self, characteristic: Characteristic) -> float:
        """The error that the requirement allows of a characteristic, mm.

        Raises
        ------
        ValueError
            If the requirement needs a tolerance that the characteristic does not have; callers ask before.
        """
        allowed = self.requirement.allowed_error_mm(characteristic.nominal_mm, characteristic.tolerance_mm)
        if allowed is None:
            raise ValueError(f"characteristic {characteristic.id} has no tolerance, which the requirement needs")
        return allowed
