"""The content of a file of hand-eye samples, and the protocol of its readers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ..pose_file import PoseDocument

__all__ = ["HandEyeFile", "HandEyeFormat"]


@dataclass(frozen=True)
class HandEyeFile:
    """Pairs of poses.

    Parameters
    ----------
    format
        Name of the format.
    T_base_flange, T_camera_board
        ``(n, 4, 4)`` mm.
    in_hand
        What the robot carries: "camera" or "board"; None where the file does not say.
    names
        Of the pairs.
    """

    format: str
    T_base_flange: NDArray[np.float64]
    T_camera_board: NDArray[np.float64]
    in_hand: Literal["camera", "board"] | None
    names: tuple[str, ...]


class HandEyeFormat(Protocol):
    """Reads one format of hand-eye samples."""

    @property
    def name(self) -> str:
        """In messages and in the documentation."""
        ...

    @property
    def form(self) -> str:
        """What the file holds and what the format says of it."""
        ...

    @property
    def cannot_say(self) -> str:
        """What such a file cannot say, and how the user states it; "-" if nothing."""
        ...

    def recognises(self, document: PoseDocument) -> bool:
        """Whether a file is of this format, by its content."""
        ...

    def read(self, document: PoseDocument) -> HandEyeFile:
        """The pairs; raises InputError where the file cannot be used."""
        ...
