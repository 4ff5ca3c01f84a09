"""Is the law of the error true? Displaced acquisitions are rendered and measured, and their errors held against the
law.

What predicts sees the inspection and, of each viewpoint, a rehearsal: images without noise, of which the contrast of
edges is taken, and whether they can be found at all. It sees nothing of the acquisitions that it is judged on.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError, NoCandidateError
from ...execution.chunks import EvaluationJob, candidate_grid
from ...execution.executor import Executor, InProcess
from ...execution.progress import Progress, Silent
from ...formats.files.atomic import write_text_atomically
from ...geometry import PoseError, invert, transform
from ...measurement.image.edges import EdgeFinder
from ...measurement.image.expected_edges import ExpectedMeasurand
from ...measurement.image.image_pose import find_image_pose
from ...measurement.image.length_law import length_law
from ...measurement.image.measurand_image import MeasurandImage, measurand_windows, measure_in_image
from ...planning import without_allowed_error
from ...planning.inspection import ExplicitViewpoints, Inspection
from ...sensors import Camera
from ...simulation.displaced_poses import displaced_poses
from ...simulation.image_sensor import ImageSensor
from ...simulation.partial_image import partial_image
from ...simulation.renderer import Renderer
from ...simulation.true_camera import true_camera
from ..evaluate import ViewpointsLike, viewpoints_of
from .measure import Edges, require_edges, seen_measurands

__all__ = [
    "LEVELS",
    "Coverage",
    "ValidatedPair",
    "Validation",
    "describe_validation",
    "validate",
    "write_validation",
]

LEVELS = (0.68, 0.95, 0.99)
"""Of the intervals whose coverage is counted."""

_REHEARSALS, _OFF_PX = 4, 0.15  # displaced images without noise, and how far off a length may be in them
_LIMITS = 0.99  # of the counts that are expected where the law is true


@dataclass(frozen=True)
class Coverage:
    """How many of so many errors lie in the interval that the law holds for ``level`` of them.

    ``low`` and ``high`` are the counts that a true law keeps with a probability of 99 % (binomial law).
    """

    level: float
    inside: int
    acquisitions: int
    low: int
    high: int

    @classmethod
    def of(cls, probabilities: NDArray[np.float64], level: float) -> Coverage:
        """From the probability, by the law, of errors less far out than each error (uniform if the law is true)."""
        from scipy.stats import binom

        n, tail = len(probabilities), (1 - _LIMITS) / 2
        low, high = (int(binom.ppf(q, n, level)) for q in (tail, 1 - tail)) if n else (0, 0)
        return cls(level, int((probabilities <= level).sum()), n, low, high)

    @property
    def holds(self) -> bool:
        """Whether the count is what is expected of a true law; without an acquisition nothing is."""
        return self.acquisitions > 0 and self.low <= self.inside <= self.high


@dataclass(frozen=True)
class ValidatedPair:
    """A characteristic from a viewpoint.

    Parameters
    ----------
    predicted_px, location_px
        Standard deviation of the image length, all of it, and of the ends' location alone, px.
    errors_px
        ``(acquisitions,)``: measured less nominal image length, px; NaN where it was not measured.
    probability
        ``(acquisitions,)``: by the law, of errors less far from zero than this.
    """

    viewpoint: str
    characteristic: str
    length_px: float
    predicted_px: float
    location_px: float
    errors_px: NDArray[np.float64]
    probability: NDArray[np.float64]


@dataclass(frozen=True)
class Validation:
    """What came of the acquisitions.

    Parameters
    ----------
    pairs
        Of those that an image without noise and displacement can be measured in.
    refused
        Pairs that it cannot, with the reason.
    drawn
        ``(n,)``: the probabilities of one characteristic of each acquisition, drawn before it was taken: independent of
        each other.
    drawn_unmeasured
        Acquisitions in which the drawn one could not be measured.
    """

    edges: Edges
    viewpoints: int
    acquisitions: int
    pairs: tuple[ValidatedPair, ...]
    refused: tuple[tuple[str, str, str], ...]
    drawn: NDArray[np.float64]
    drawn_unmeasured: int

    def coverage(self) -> tuple[Coverage, ...]:
        """Over all acquisitions, one characteristic of each."""
        return tuple(Coverage.of(self.drawn, level) for level in LEVELS)

    def coverage_of(self, characteristic: str) -> tuple[Coverage, ...]:
        """Of one characteristic, over all acquisitions that it was measured in."""
        found = [pair.probability for pair in self.pairs if pair.characteristic == characteristic]
        values = np.concatenate(found) if found else np.zeros(0)
        values = values[np.isfinite(values)]
        return tuple(Coverage.of(values, level) for level in LEVELS)


@dataclass(frozen=True, eq=False)
class _Job:
    inspection: Inspection
    viewpoints: ExplicitViewpoints
    evaluation: EvaluationJob
    acquisitions: int
    sensor: ImageSensor
    edges: tuple[Edges, ...]
    rays_per_pixel: int
    seed: int


@dataclass(frozen=True)
class _Outcome:
    """Of one viewpoint, by the way of finding edges."""

    pairs: dict[Edges, list[ValidatedPair]]
    refused: list[tuple[str, str, str]]
    drawn: dict[Edges, list[float]]


def validate(
    inspection: Inspection,
    viewpoints: ViewpointsLike = None,
    *,
    sample: int = 20,
    repeats: int = 100,
    sensor: ImageSensor | None = None,
    edges: Sequence[Edges] = ("sub-pixel",),
    rays_per_pixel: int = 34,
    seed: int | None = None,
    progress: Progress | None = None,
    executor: Executor | None = None,
) -> dict[Edges, Validation]:
    """Hold the law of the error against displaced acquisitions, rendered and measured.

    Each look has its own draw of the head's and of the calibration's errors and of the noise. Only what is looked at
    is rendered.

    Parameters
    ----------
    viewpoints
        As of :func:`~viewgauge.evaluate`; where neither they nor the inspection name any, ``sample`` of the candidates
        that see something are drawn.
    repeats
        Of each viewpoint.
    edges
        How edges are found in the same images: "sub-pixel", "whole-pixel".
    executor
        Where viewpoints are worked on (:func:`~viewgauge.jobs.open_executor`); by default in this process.

    Returns
    -------
    By the way of finding edges.

    Raises
    ------
    InputError
        If a number is out of range.
    NoCandidateError
        If no candidate sees a characteristic.
    """
    for name, value in (("repeats", repeats), ("sample", sample)):
        if value < 1:
            raise InputError("at least one", key=name, got=value)
    for how in edges:
        require_edges(how)
    seed = inspection.seed if seed is None else seed
    characteristics, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    if viewpoints is None and inspection.viewpoints is None:
        chosen = _drawn_viewpoints(inspection, sample, seed)
    else:
        chosen = viewpoints_of(inspection, viewpoints)
    evaluation = EvaluationJob.of(inspection, characteristics, chosen)
    job = _Job(inspection, chosen, evaluation, repeats, sensor or ImageSensor(), tuple(edges), rays_per_pixel, seed)
    outcomes: dict[int, _Outcome] = {}
    progress, executor = progress or Silent(), executor or InProcess()
    with progress.stage(f"Simulating and measuring {len(chosen) * repeats} acquisitions", len(chosen)) as advance:
        for index, outcome in executor.run(_validated_viewpoint, job, list(range(len(chosen)))):
            outcomes[index] = outcome
            advance(1)
    return {how: _gathered(how, [outcomes[k] for k in range(len(chosen))], repeats) for how in edges}


def _gathered(how: Edges, outcomes: Sequence[_Outcome], acquisitions: int) -> Validation:
    drawn = np.array([value for outcome in outcomes for value in outcome.drawn[how]])
    return Validation(
        how,
        len(outcomes),
        acquisitions,
        tuple(pair for outcome in outcomes for pair in outcome.pairs[how]),
        tuple(refusal for outcome in outcomes for refusal in outcome.refused),
        drawn[np.isfinite(drawn)],
        int(np.isnan(drawn).sum()),
    )


def _drawn_viewpoints(inspection: Inspection, count: int, seed: int) -> ExplicitViewpoints:
    """Candidates that see something, drawn at random."""
    characteristics, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    if not characteristics:
        raise NoCandidateError("nothing can be measured, so no viewpoint is sampled: see viewgauge check")
    grid = candidate_grid(inspection, characteristics)
    evaluation = EvaluationJob.of(inspection, characteristics, grid)
    rng, found = np.random.default_rng([seed, 7]), []
    for index in rng.permutation(len(grid)).tolist():
        pose = grid.poses(index, index + 1)
        if seen_measurands(evaluation, pose[0]):
            found.append((f"C{index + 1}", pose[0]))
        if len(found) == count:
            break
    if not found:
        raise NoCandidateError("no candidate sees a characteristic: see viewgauge check")
    return ExplicitViewpoints(tuple(name for name, _ in found), np.array([pose for _, pose in found]))


@lru_cache(maxsize=1)
def _renderer_of(job: _Job) -> Renderer:
    mesh = job.inspection.part.mesh
    return Renderer(mesh.vertices, mesh.triangles, rays_per_pixel=job.rays_per_pixel)


def _validated_viewpoint(job: _Job, index: int) -> _Outcome:
    """All acquisitions of one viewpoint."""
    inspection, sensor, name = job.inspection, job.sensor, job.viewpoints.ids[index]
    camera, T = inspection.camera, job.viewpoints.T_part_camera[index]
    pose_error = PoseError(
        inspection.pose_error.covariance, T_camera_frame=inspection.pose_error.T_camera_frame
    )  # none in common
    measurands = seen_measurands(job.evaluation, T)
    windows = [
        window for measurand in measurands.values() for window in measurand_windows(measurand, T, camera, pose_error)
    ]
    renderer, expected, full = _renderer_of(job), list(measurands.values()), 2**sensor.bits - 1
    rounding, draw = 1 / full / np.sqrt(12), np.random.default_rng([job.seed, index, 1])
    noise, rehearsal = float(np.hypot(sensor.noise, rounding)), replace(sensor, noise=0.0)

    def measured(
        pose: NDArray[np.float64], sensor: ImageSensor, true: Camera, rng: np.random.Generator, noise: float = noise
    ) -> list[_Seen]:
        image = partial_image(renderer, sensor, pose, true, windows, rng) / full
        finder = EdgeFinder(image, noise, windows)
        image_pose = find_image_pose(finder, expected, T, camera, pose_error)
        if image_pose is None:
            return [None] * len(expected)
        return [measure_in_image(finder, image, measurand, T, camera, image_pose) for measurand in expected]

    why = _rehearsed(
        measurands, T, camera, pose_error, lambda pose: measured(pose, rehearsal, camera, draw, rounding), draw
    )
    clean = measured(T, rehearsal, camera, draw)
    known = [k for k, (reason, seen) in enumerate(zip(why, clean, strict=True)) if not reason and seen is not None]
    refused = [(name, characteristic, reason) for characteristic, reason in zip(measurands, why, strict=True) if reason]
    poses = displaced_poses(T, pose_error, job.acquisitions, np.random.default_rng([job.seed, index]))
    choice = draw.integers(len(known), size=job.acquisitions) if known else np.zeros(0, np.int64)
    acquisitions = []
    for acquisition in range(job.acquisitions if known else 0):
        rng = np.random.default_rng([job.seed, index, 2, acquisition])
        acquisitions.append(measured(poses[acquisition], sensor, true_camera(camera, rng), rng))
    outcome = _Outcome({how: [] for how in job.edges}, refused, {how: [] for how in job.edges})
    for how in job.edges:
        for k in known:
            measurand, nominal = expected[k], clean[k]
            assert nominal is not None  # known
            seen = [found[k] for found in acquisitions]
            outcome.pairs[how].append(
                _pair(name, list(measurands)[k], measurand, nominal, seen, T, camera, pose_error, how)
            )
        outcome.drawn[how] += [
            float(outcome.pairs[how][c].probability[acquisition]) for acquisition, c in enumerate(choice)
        ]
    return outcome


_Seen = MeasurandImage | None


def _rehearsed(
    measurands: Mapping[str, ExpectedMeasurand],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    pose_error: PoseError,
    measured: Callable[[NDArray[np.float64]], list[_Seen]],
    rng: np.random.Generator,
) -> list[str]:
    """Why a measurand cannot be measured even in images without noise, or is not where it is found; empty where it
    can.
    """
    why = ["" for _ in measurands]
    for pose in [T_part_camera, *displaced_poses(T_part_camera, pose_error, _REHEARSALS, rng)]:
        for k, (measurand, seen) in enumerate(zip(measurands.values(), measured(pose), strict=True)):
            if seen is None:
                why[k] = why[k] or "the part is not seen as planned"
            elif seen.measured_mm is None:
                why[k] = why[k] or seen.reason
            else:
                true = float(np.linalg.norm(np.diff(camera.project(transform(invert(pose), measurand.points)), axis=0)))
                off = abs(seen.measured_mm - true) / min(camera.pixel_pitch_mm)
                if off > _OFF_PX:
                    why[k] = why[k] or f"what lies beside its edges moves them: off by {off:.1f} px in clear images"
    return why


def _pair(
    viewpoint: str,
    characteristic: str,
    measurand: ExpectedMeasurand,
    nominal: MeasurandImage,
    seen: Sequence[_Seen],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    pose_error: PoseError,
    how: Edges,
) -> ValidatedPair:
    whole = how == "whole-pixel"
    law = length_law(measurand.points, T_part_camera, camera, pose_error, nominal.deviation_mm, whole_pixels=whole)
    lengths = [None if found is None else found.length_mm(camera, whole) for found in seen]
    errors = np.array([np.nan if length is None else length - nominal.nominal_mm for length in lengths])
    probability = np.full(len(errors), np.nan)
    good = np.isfinite(errors)
    probability[good] = law.central_probability(np.abs(errors[good]))
    px = min(camera.pixel_pitch_mm)
    return ValidatedPair(
        viewpoint,
        characteristic,
        nominal.nominal_mm / px,
        float(law.std()) / px,
        nominal.deviation_mm / px,
        errors / px,
        probability,
    )


def describe_validation(found: Mapping[Edges, Validation]) -> list[dict[str, Any]]:
    """As JSON-ready data, px; of each way of finding edges."""
    return [
        {
            "edges": one.edges,
            "viewpoints": one.viewpoints,
            "acquisitions": one.acquisitions,
            "coverage": [_level(c) for c in one.coverage()],
            "drawn_unmeasured": one.drawn_unmeasured,
            "characteristics": [
                _characteristic(one, name) for name in dict.fromkeys(p.characteristic for p in one.pairs)
            ],
            "refused": [list(refusal) for refusal in one.refused],
        }
        for one in found.values()
    ]


def _level(coverage: Coverage) -> dict[str, Any]:
    return {**asdict(coverage), "holds": coverage.holds}


def _characteristic(found: Validation, name: str) -> dict[str, Any]:
    errors = np.concatenate([p.errors_px / p.predicted_px for p in found.pairs if p.characteristic == name])
    good = errors[np.isfinite(errors)]
    return {
        "id": name,
        "acquisitions": len(good),
        "not_measured": int(len(errors) - len(good)),
        "rms_ratio": float(np.sqrt((good**2).mean())) if len(good) else None,
        "coverage": [_level(c) for c in found.coverage_of(name)],
    }


def write_validation(found: Mapping[Edges, Validation], path: str | PathLike[str]) -> None:
    """Write a CSV with a row for each viewpoint and characteristic, px.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [
        "edges",
        "viewpoint",
        "characteristic",
        "length_px",
        "predicted_px",
        "location_px",
        "acquisitions",
        "not_measured",
    ]
    writer.writerow([*names, "mean_px", "deviation_px", *(f"inside_{round(100 * level)}" for level in LEVELS)])
    for one in found.values():
        for pair in one.pairs:
            good = np.isfinite(pair.errors_px)
            errors = pair.errors_px[good]
            inside = [int((pair.probability[good] <= level).sum()) for level in LEVELS]
            spread = [float(errors.mean()), float(errors.std())] if len(errors) else ["", ""]
            predicted = [pair.length_px, pair.predicted_px, pair.location_px]
            counts = [int(good.sum()), int((~good).sum())]
            writer.writerow([one.edges, pair.viewpoint, pair.characteristic, *predicted, *counts, *spread, *inside])
    write_text_atomically(Path(path), text.getvalue())
