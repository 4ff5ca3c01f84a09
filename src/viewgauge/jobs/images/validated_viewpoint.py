"""The acquisitions of one viewpoint: rendered, measured, and their errors beside the law.

What predicts sees the inspection and a rehearsal: images without noise, of which the contrast of edges is taken, and
whether they can be found at all. It sees nothing of the acquisitions that it is judged on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...execution.chunks import EvaluationJob
from ...geometry import PoseError, invert, transform
from ...measurement.image.edges import EdgeFinder
from ...measurement.image.expected_edges import ExpectedMeasurand
from ...measurement.image.image_pose import find_image_pose
from ...measurement.image.length_law import length_law
from ...measurement.image.measurand_image import MeasurandImage, measurand_windows, measure_in_image
from ...planning.inspection import ExplicitViewpoints, Inspection
from ...sensors import Camera, Window
from ...simulation.displaced_poses import displaced_poses
from ...simulation.image_sensor import ImageSensor
from ...simulation.partial_image import partial_image
from ...simulation.renderer import Renderer
from ...simulation.true_camera import true_camera
from .measure import Edges, seen_measurands
from .validation import ValidatedPair

__all__ = ["ValidatedViewpoint", "ValidationJob", "validated_viewpoint"]

_REHEARSALS, _OFF_PX = 4, 0.15  # displaced images without noise, and how far off a length may be in them


@dataclass(frozen=True, eq=False)
class ValidationJob:
    """What all viewpoints of a validation share.

    Parameters
    ----------
    acquisitions
        Number of images of each viewpoint.
    edges
        How edges are found in them.
    """

    inspection: Inspection
    viewpoints: ExplicitViewpoints
    evaluation: EvaluationJob
    acquisitions: int
    sensor: ImageSensor
    edges: tuple[Edges, ...]
    rays_per_pixel: int
    seed: int


@dataclass(frozen=True)
class ValidatedViewpoint:
    """What the acquisitions of one viewpoint have shown, by the way of finding edges.

    Parameters
    ----------
    pairs
        Each characteristic that can be measured from there.
    refused
        Those that cannot: viewpoint, characteristic, reason.
    drawn
        The probability of one characteristic of each acquisition, drawn before it was taken.
    """

    refused: list[tuple[str, str, str]]
    pairs: dict[Edges, list[ValidatedPair]] = field(default_factory=dict)
    drawn: dict[Edges, list[float]] = field(default_factory=dict)


@lru_cache(maxsize=1)
def _renderer_of(job: ValidationJob) -> Renderer:
    mesh = job.inspection.part.mesh
    return Renderer(mesh.vertices, mesh.triangles, rays_per_pixel=job.rays_per_pixel)


@dataclass(frozen=True)
class _Acquisitions:
    """The images of one viewpoint and what is measured in them.

    Parameters
    ----------
    T_part_camera
        ``(4, 4)`` mm: the planned pose.
    pose_error
        Of which nothing is common to acquisitions: each draws its own.
    measurands
        By the characteristic's id.
    windows
        All that is rendered.
    noise
        Standard deviation of a pixel, rounding included, share of full scale.
    """

    job: ValidationJob
    camera: Camera
    pose_error: PoseError
    T_part_camera: NDArray[np.float64]
    measurands: dict[str, ExpectedMeasurand]
    windows: list[Window]
    noise: float

    def measured(
        self, pose: NDArray[np.float64], sensor: ImageSensor, true: Camera, rng: np.random.Generator, noise: float
    ) -> list[MeasurandImage | None]:
        """The measurands in an image that a true camera takes at a pose; None for all where its pose is not found."""
        image = partial_image(_renderer_of(self.job), sensor, pose, true, self.windows, rng) / (2**sensor.bits - 1)
        finder, expected = EdgeFinder(image, noise, self.windows), list(self.measurands.values())
        T, camera = self.T_part_camera, self.camera
        image_pose = find_image_pose(finder, expected, T, camera, self.pose_error)
        if image_pose is None:
            return [None] * len(expected)
        return [measure_in_image(finder, image, measurand, T, camera, image_pose) for measurand in expected]

    def refusals(self, sensor: ImageSensor, rng: np.random.Generator, noise: float) -> list[str]:
        """Why a measurand cannot be measured even in images without noise, or is not where it is found; empty where it
        can.
        """
        why = ["" for _ in self.measurands]
        for pose in [self.T_part_camera, *displaced_poses(self.T_part_camera, self.pose_error, _REHEARSALS, rng)]:
            images = self.measured(pose, sensor, self.camera, rng, noise)
            for k, (measurand, seen) in enumerate(zip(self.measurands.values(), images, strict=True)):
                why[k] = why[k] or self._refusal(measurand, seen, pose)
        return why

    def _refusal(self, measurand: ExpectedMeasurand, seen: MeasurandImage | None, pose: NDArray[np.float64]) -> str:
        if seen is None:
            return "the part is not seen as planned"
        if seen.measured_mm is None:
            return seen.reason
        image = self.camera.project(transform(invert(pose), measurand.points))
        off = abs(seen.measured_mm - float(np.linalg.norm(np.diff(image, axis=0)))) / min(self.camera.pixel_pitch_mm)
        return f"what lies beside its edges moves them: off by {off:.1f} px in clear images" if off > _OFF_PX else ""

    def pair(
        self, names: tuple[str, str], nominal: MeasurandImage, seen: Sequence[MeasurandImage | None], how: Edges
    ) -> ValidatedPair:
        """The errors of a characteristic, by (viewpoint, characteristic), beside its law from the nominal image."""
        camera, whole = self.camera, how == "whole-pixel"
        points, T = self.measurands[names[1]].points, self.T_part_camera
        law = length_law(points, T, camera, self.pose_error, nominal.deviation_mm, whole_pixels=whole)
        lengths = [None if found is None else found.length_mm(camera, whole) for found in seen]
        errors = np.array([np.nan if length is None else length - nominal.nominal_mm for length in lengths])
        probability = np.full(len(errors), np.nan)
        good = np.isfinite(errors)
        probability[good] = law.central_probability(np.abs(errors[good]))
        px = min(camera.pixel_pitch_mm)
        deviations = (float(law.std()) / px, nominal.deviation_mm / px)
        return ValidatedPair(*names, nominal.nominal_mm / px, *deviations, errors / px, probability)


def validated_viewpoint(job: ValidationJob, index: int) -> ValidatedViewpoint:
    """All acquisitions of one viewpoint."""
    inspection, sensor, name = job.inspection, job.sensor, job.viewpoints.ids[index]
    camera, T = inspection.camera, job.viewpoints.T_part_camera[index]
    pose_error = PoseError(inspection.pose_error.covariance, T_camera_frame=inspection.pose_error.T_camera_frame)
    measurands = seen_measurands(job.evaluation, T)
    windows = [
        window for measurand in measurands.values() for window in measurand_windows(measurand, T, camera, pose_error)
    ]
    rounding, draw = 1 / (2**sensor.bits - 1) / np.sqrt(12), np.random.default_rng([job.seed, index, 1])
    noise, rehearsal = float(np.hypot(sensor.noise, rounding)), replace(sensor, noise=0.0)
    acquisitions = _Acquisitions(job, camera, pose_error, T, measurands, windows, noise)
    why = acquisitions.refusals(rehearsal, draw, rounding)
    clean = acquisitions.measured(T, rehearsal, camera, draw, noise)
    known = {
        characteristic: (k, seen)
        for k, (characteristic, reason, seen) in enumerate(zip(measurands, why, clean, strict=True))
        if not reason and seen is not None
    }
    refused = [(name, characteristic, reason) for characteristic, reason in zip(measurands, why, strict=True) if reason]
    poses = displaced_poses(T, pose_error, job.acquisitions, np.random.default_rng([job.seed, index]))
    choice = draw.integers(len(known), size=job.acquisitions) if known else np.zeros(0, np.int64)
    images = []
    for acquisition in range(job.acquisitions if known else 0):
        rng = np.random.default_rng([job.seed, index, 2, acquisition])
        images.append(acquisitions.measured(poses[acquisition], sensor, true_camera(camera, rng), rng, noise))
    outcome = ValidatedViewpoint(refused)
    for how in job.edges:
        outcome.pairs[how] = [
            acquisitions.pair((name, characteristic), nominal, [found[k] for found in images], how)
            for characteristic, (k, nominal) in known.items()
        ]
        outcome.drawn[how] = [float(outcome.pairs[how][c].probability[k]) for k, c in enumerate(choice)]
    return outcome
