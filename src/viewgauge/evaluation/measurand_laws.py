"""The laws of the error with which one characteristic is measured, in mm of the characteristic."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..drawing import Drawable
from ..errors import AveragedError, IndependentTotalError, TotalError
from ..errors.law import Law
from ..geometry import PoseError
from ..sensors import Camera
from .averaging import Acquisitions
from .segment import image_segment

__all__ = ["MeasurandLaws"]


@dataclass(frozen=True)
class MeasurandLaws(Drawable):
    """What the error of a characteristic is made of, and the probability that follows.

    Parameters
    ----------
    length_mm
        Of the measurand, or the mean of those of several viewpoints.
    total
        Law of the error, mm: the joint model.
    displacement
        Of what the pose error alone does.
    camera
        Of what the camera alone does: quantization, or edge location and calibration.
    independent
        The paper's independent model of the total error, mm **on the image**; None where it does not know the camera,
        for several viewpoints, or where it has no value.
    image_scale
        Millimetres of the characteristic for each on the image.
    """

    length_mm: float
    total: Law
    displacement: Law
    camera: Law
    independent: IndependentTotalError | None = None
    image_scale: float = 1.0

    @classmethod
    def of_acquisition(
        cls,
        points: ArrayLike,
        camera: Camera,
        error: PoseError,
        rim_axis: NDArray[np.float64] | None = None,
    ) -> MeasurandLaws:
        """Of one acquisition.

        Parameters
        ----------
        points
            ``(2, 3)`` mm: both ends of the measurand, in front of the camera, in its frame.
        rim_axis
            ``(3,)``, camera frame: as of :func:`~viewgauge.evaluation.camera_errors.camera_errors`.
        """
        start, end = np.asarray(points, dtype=float)
        length = float(np.linalg.norm(end - start))
        image = image_segment(start, end, camera, error, rim_axis=rim_axis)
        scale = length / float(image.length_mm)
        displaced, located = scale * image.sigma_displacement_mm, scale * image.sigma_camera_mm
        half_widths = scale * image.camera.half_widths_mm
        independent = None
        if camera.is_plain:
            law = image_segment(start, end, camera, error, "independent").total_error()
            if isinstance(law, IndependentTotalError) and np.isfinite(law.central_probability(float(image.length_mm))):
                independent = law
        return cls(
            length,
            TotalError.of_half_widths(np.hypot(displaced, located), half_widths),
            TotalError(displaced, 0.0, 0.0),
            TotalError.of_half_widths(located, half_widths),
            independent,
            scale,
        )

    @classmethod
    def of_mean(
        cls,
        points: ArrayLike,
        camera: Camera,
        error: PoseError,
        rim_axis: NDArray[np.float64] | None = None,
    ) -> MeasurandLaws:
        """Of the mean of k acquisitions; ``points`` ``(k, 2, 3)`` mm and ``rim_axis`` ``(k, 3)``, each in its camera
        frame.

        Raises
        ------
        InputError
            As :meth:`~viewgauge.evaluation.Acquisitions.of`.
        """
        ends = np.asarray(points, dtype=float)
        acquisitions = Acquisitions.of(ends, camera, error, rim_axis)
        every = np.arange(len(acquisitions))
        nothing = np.zeros_like
        moved = replace(
            acquisitions,
            half_widths_mm=nothing(acquisitions.half_widths_mm),
            location_variance_mm2=nothing(acquisitions.location_variance_mm2),
            camera_gradient=nothing(acquisitions.camera_gradient),
        )
        held = replace(acquisitions, gradient=nothing(acquisitions.gradient))
        length = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean())
        return cls(length, acquisitions.mean_of(every), moved.mean_of(every), held.mean_of(every))

    @property
    def standard_uncertainty_mm(self) -> float:
        """Of the joint model."""
        return float(self.total.std())

    def probability(self, error_mm: ArrayLike) -> NDArray[np.float64]:
        """P(|error| <= error_mm) by the joint model."""
        return _central(self.total, error_mm)

    def independent_probability(self, error_mm: ArrayLike) -> NDArray[np.float64] | None:
        """The same by the paper's independent model; None where there is none."""
        if self.independent is None:
            return None
        return np.asarray(self.independent.central_probability(np.asarray(error_mm, dtype=float) / self.image_scale))

    def independent_density(self, error_mm: ArrayLike) -> NDArray[np.float64] | None:
        """Density per mm of the characteristic by the paper's independent model; None where there is none."""
        if self.independent is None:
            return None
        return self.independent.pdf(np.asarray(error_mm, dtype=float) / self.image_scale) / self.image_scale


def _central(law: Law, error_mm: ArrayLike) -> NDArray[np.float64]:
    assert isinstance(law, TotalError | AveragedError)  # what this module makes
    return np.asarray(law.central_probability(error_mm))
