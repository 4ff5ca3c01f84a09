"""The thresholds above which a measurand counts as observable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..exceptions import InputError

__all__ = ["ObservationLimits"]


@dataclass(frozen=True)
class ObservationLimits:
    """Thresholds of the observability conditions.

    Parameters
    ----------
    margin_px
        Width of the image border in which no end of a measurand may lie, px.
    minimum_length_px
        Shortest image of a measurand that is measured, px.
    grazing_angle_rad
        A face counts as turned to the camera when the line of sight makes at least this angle with it.
    """

    margin_px: float = 8.0
    minimum_length_px: float = 16.0
    grazing_angle_rad: float = float(np.deg2rad(10.0))

    def __post_init__(self) -> None:
        for name in ("margin_px", "minimum_length_px", "grazing_angle_rad"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise InputError(f"{name} must be finite and not negative", key=name, got=value)
