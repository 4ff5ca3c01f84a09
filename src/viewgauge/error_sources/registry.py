"""The list of error sources, in the order of budgets, files and draws."""

from __future__ import annotations

from collections.abc import Sequence

from ..sensors import Camera
from .base import Component, ErrorSource
from .calibration import Calibration
from .edge_noise import EdgeNoise
from .edge_offset import EdgeOffset
from .length_error import LengthError
from .pose_rotation import PoseRotation
from .pose_translation import PoseTranslation
from .quantization import Quantization

__all__ = ["CALIBRATION", "ERROR_SOURCES", "components_of", "groups_of", "sources_of"]

CALIBRATION = Calibration()

ERROR_SOURCES: tuple[ErrorSource, ...] = (
    PoseTranslation(),
    PoseRotation(),
    Quantization(),
    EdgeNoise(),
    EdgeOffset(),
    CALIBRATION,
)
"""The sources that every camera and its pose can have. Draws take their uniform numbers in this order."""

_GROUPS = ("translation", "rotation", "pose", "pixels", "camera")  # in the order of files


def sources_of(camera: Camera) -> tuple[ErrorSource, ...]:
    """All sources of a camera: those that every camera can have, and its further errors."""
    further = camera.further_errors
    assert all(isinstance(error, LengthError) for error in further), "further_errors are LengthErrors"
    return (*ERROR_SOURCES, *further)  # type: ignore[arg-type]


def components_of(sources: Sequence[ErrorSource]) -> tuple[Component, ...]:
    """The lines of an error budget."""
    return tuple(component for source in sources for component in source.components)


def groups_of(sources: Sequence[ErrorSource]) -> dict[str, tuple[int, ...]]:
    """Components that are mended together, by their place among all."""
    groups: dict[str, list[int]] = {name: [] for name in _GROUPS}
    place = 0
    for source in sources:
        places = range(place, place + len(source.components))
        for name in source.groups:
            groups.setdefault(name, []).extend(places)
        place = places.stop
    return {name: tuple(places) for name, places in groups.items()}
