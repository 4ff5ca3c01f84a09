"""What a source of measurement error has to say: the protocol, and what it is given."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from ..geometry import PoseError
from ..sensors import Camera

__all__ = ["Component", "DrawnView", "ErrorSource", "LinearTerms", "SourceKind"]


class SourceKind(Enum):
    """How the errors of a source are distributed."""

    POSE = "normal, of the camera's pose, correlated with the other errors of the pose"
    TRIANGULAR = "differences of two uniform errors along u and v, drawn anew at each acquisition"
    ANEW = "normal, drawn anew at each acquisition"
    COMMON = "normal, the same at every acquisition"


@dataclass(frozen=True)
class Component:
    """One line of the error budget.

    Parameters
    ----------
    name
        In files.
    part, words
        What it is shown as, together with other components of the same part.
    """

    name: str
    part: str
    words: str


@dataclass(frozen=True)
class LinearTerms:
    """The linear law of image lengths ``(...)``, from which sources take their sensitivities.

    Parameters
    ----------
    direction
        ``(..., 2)``: of the image, unit.
    pose
        ``(..., 6)``: mm of image length per mm and rad of the pose error, pose error frame.
    half_widths_mm
        ``(..., 2)``: of the triangular errors of quantization, along u and v.
    anew_mm2
        By source ``(...)``: variance of what is drawn anew at each acquisition.
    gradient
        By source ``(..., k)``: mm of image length per unit of each error that is common to all acquisitions.
    covariance
        By source ``(k, k)`` of those errors.
    """

    direction: NDArray[np.float64]
    pose: NDArray[np.float64]
    half_widths_mm: NDArray[np.float64]
    anew_mm2: Mapping[str, NDArray[np.float64]]
    gradient: Mapping[str, NDArray[np.float64]]
    covariance: Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class DrawnView:
    """One segment in front of a camera, as the full camera model draws its errors.

    Parameters
    ----------
    points
        ``(2, 3)`` mm, camera frame, in front of the camera.
    images
        ``(2, 2)`` mm: ideal images of both ends without errors.
    rim_axis
        ``(3,)``, camera frame: axis of the whole rim of which the segment is a diameter; None or zeros for none.
    prepared
        By source what it has made ready for all draws (:meth:`ErrorSource.prepared`).
    """

    camera: Camera
    points: NDArray[np.float64]
    images: NDArray[np.float64]
    rim_axis: NDArray[np.float64] | None = None
    prepared: Mapping[str, Any] = field(default_factory=dict)


class ErrorSource(ABC):
    """A source of measurement error.

    Attributes
    ----------
    name
        By which the linear law and the draws name it.
    kind
        How its errors are distributed.
    components
        Its lines of the error budget.
    groups
        Names of the sources that are mended together, of which it is one.
    knobs
        Names of the knobs that scale it.
    """

    name: ClassVar[str]
    kind: ClassVar[SourceKind]
    components: ClassVar[tuple[Component, ...]]
    groups: ClassVar[tuple[str, ...]]
    knobs: ClassVar[tuple[str, ...]] = ()

    # --- its size

    @abstractmethod
    def size(self, camera: Camera, pose_error: PoseError) -> float:
        """How large it is: a standard deviation or a step, in the unit of its knob; 0 where there is none of it."""

    @abstractmethod
    def scaled(self, camera: Camera, pose_error: PoseError, factor: float) -> tuple[Camera, PoseError]:
        """Camera and pose error with this source multiplied."""

    def without(self, camera: Camera, pose_error: PoseError) -> tuple[Camera, PoseError]:
        """Camera and pose error without this source."""
        return self.scaled(camera, pose_error, 0.0)

    # --- the linear law

    @abstractmethod
    def standard_uncertainty(self, camera: Camera, pose_error: PoseError) -> NDArray[np.float64]:
        """``(m,)``: of each component."""

    @abstractmethod
    def sensitivity(self, terms: LinearTerms, camera: Camera) -> NDArray[np.float64]:
        """``(..., m)``: mm of image length per unit of each component."""

    # --- the full camera model

    def draw_width(self, camera: Camera) -> int:  # noqa: ARG002 - of sources that draw nothing by themselves
        """How many uniform numbers make a draw; 0 where there is nothing to draw.

        Errors of the pose are correlated: they are drawn together (:mod:`viewgauge.simulation.full_camera`).
        """
        return 0

    def drawn(self, uniform: NDArray[np.float64]) -> NDArray[np.float64]:
        """Errors in their own units from uniform numbers ``(n, width)``: unit normals, unless the source says else."""
        return np.asarray(ndtri(uniform))

    def prepared(self, view: DrawnView) -> Any:  # noqa: ARG002 - most need nothing
        """What is computed once for all draws of a segment; it is found in ``view.prepared``."""
        return None

    def displaced(self, px: NDArray[np.float64], drawn: NDArray[np.float64], view: DrawnView) -> NDArray[np.float64]:
        """``(n, 2, 2)`` px: where the ends that are shown at ``px`` are located, with the drawn errors ``(n, width)``.

        True geometry, without any linearisation.
        """
        raise NotImplementedError(f"{self.name} draws nothing that moves pixels")  # pragma: no cover
