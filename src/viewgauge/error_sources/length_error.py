"""A further error of the image length, which a camera carries with it: what a new source of error derives from."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from ..geometry import PoseError
from ..sensors import Camera
from .base import Component, DrawnView, ErrorSource, LinearTerms, SourceKind

__all__ = ["LengthError"]


class LengthError(ErrorSource):
    """A normal error of the image length beside those that every camera has.

    A frozen dataclass that derives from it, put among a camera's ``further_errors``, takes part in the table, the error
    budget, the knobs and the draws. It has its own knob, of its name, which multiplies it. The draws of
    :meth:`displaced_images` must not use :meth:`deviation_mm`: agreement between them would mean nothing.

    Attributes
    ----------
    name, words
        Its name in files, and as it is shown.
    common
        It is the same error at every acquisition; else it is drawn anew at each.
    """

    words: ClassVar[str]
    common: ClassVar[bool]
    groups = ("camera",)

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if hasattr(cls, "name"):
            cls.kind = SourceKind.COMMON if cls.common else SourceKind.ANEW
            cls.components = (Component(cls.name, cls.name, cls.words),)
            cls.knobs = (cls.name,)

    @abstractmethod
    def standard_deviation(self) -> float:
        """Standard deviation of the error, in its own unit."""

    @abstractmethod
    def times(self, factor: float) -> Self:
        """This error with its standard deviation multiplied."""

    @abstractmethod
    def deviation_mm(self, points: NDArray[np.float64], camera: Camera) -> NDArray[np.float64]:
        """``(...)`` mm: change of the image length for one standard deviation of the error, at first order.

        Parameters
        ----------
        points
            ``(..., 2, 3)`` mm, camera frame.
        """

    @abstractmethod
    def displaced_images(
        self, images: NDArray[np.float64], drawn: NDArray[np.float64], view: DrawnView
    ) -> NDArray[np.float64]:
        """``(n, 2, 2)`` mm: ideal images of both ends with the errors of unit normals ``(n,)``, not linearised."""

    # --- what follows from these

    def size(self, camera: Camera, pose_error: PoseError) -> float:  # noqa: ARG002
        """1, or 0 where the camera does not have this error."""
        return float(any(error.name == self.name for error in camera.further_errors))

    def scaled(self, camera: Camera, pose_error: PoseError, factor: float) -> tuple[Camera, PoseError]:
        """A camera with this error multiplied; with 0 without it."""
        errors = tuple(
            error.times(factor) if error.name == self.name else error  # type: ignore[attr-defined]
            for error in camera.further_errors
            if factor > 0 or error.name != self.name
        )
        return replace(camera, further_errors=errors), pose_error

    def standard_uncertainty(self, camera: Camera, pose_error: PoseError) -> NDArray[np.float64]:  # noqa: ARG002
        """``(1,)``: the standard deviation."""
        return np.array([self.standard_deviation()])

    def sensitivity(self, terms: LinearTerms, camera: Camera) -> NDArray[np.float64]:  # noqa: ARG002
        """``(..., 1)``: mm of image length per unit."""
        unit = self.standard_deviation() or 1.0
        if self.common:
            return terms.gradient[self.name] / unit
        return np.asarray(np.sqrt(terms.anew_mm2[self.name]) / unit)[..., None]

    def draw_width(self, camera: Camera) -> int:  # noqa: ARG002
        """One."""
        return 1

    def displaced(self, px: NDArray[np.float64], drawn: NDArray[np.float64], view: DrawnView) -> NDArray[np.float64]:
        """The ends in the pixels, moved by what the error does to their ideal images."""
        images = self.displaced_images(view.camera.from_pixels(px), drawn[:, 0], view)
        return view.camera.to_pixels(images)
