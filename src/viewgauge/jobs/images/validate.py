"""Is the law of the error true? Displaced looks are rendered and measured, and their errors held against the law.

What predicts sees the inspection and, of each setting, a rehearsal: images without noise, of which the contrast of
edges is taken, and whether they can be found at all. It sees nothing of the looks that it is judged on.
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
from ...measurement.image.expected_edges import ExpectedGauge
from ...measurement.image.image_pose import find_guide
from ...measurement.image.length_law import length_law
from ...measurement.image.measurand_image import GaugeImage, gauge_windows, measure_gauge
from ...planning import without_allowed_error
from ...planning.inspection import ExplicitSettings, Inspection
from ...sensors import Camera
from ...simulation.displaced_poses import displaced_poses
from ...simulation.image_sensor import ImageSensor
from ...simulation.partial_image import partial_image
from ...simulation.renderer import Renderer
from ...simulation.true_camera import true_camera
from ..evaluate import SettingsLike, settings_of
from .measure import Edges, require_edges, seen_gauges

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
    looks: int
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
        """Whether the count is what is expected of a true law; without a look nothing is."""
        return self.looks > 0 and self.low <= self.inside <= self.high


@dataclass(frozen=True)
class ValidatedPair:
    """A dimension from a setting.

    Parameters
    ----------
    predicted_px, location_px
        Standard deviation of the image length, all of it, and of the ends' location alone, px.
    errors_px
        ``(looks,)``: measured less nominal image length, px; NaN where it was not measured.
    probability
        ``(looks,)``: by the law, of errors less far from zero than this.
    """

    setting: str
    dimension: str
    length_px: float
    predicted_px: float
    location_px: float
    errors_px: NDArray[np.float64]
    probability: NDArray[np.float64]


@dataclass(frozen=True)
class Validation:
    """What came of the looks.

    Parameters
    ----------
    pairs
        Of those that an image without noise and displacement can be measured in.
    refused
        Pairs that it cannot, with the reason.
    drawn
        ``(n,)``: the probabilities of one dimension of each look, drawn before it was taken: independent of each other.
    drawn_unmeasured
        Looks in which the drawn one could not be measured.
    """

    edges: Edges
    settings: int
    looks: int
    pairs: tuple[ValidatedPair, ...]
    refused: tuple[tuple[str, str, str], ...]
    drawn: NDArray[np.float64]
    drawn_unmeasured: int

    def coverage(self) -> tuple[Coverage, ...]:
        """Over all looks, one dimension of each."""
        return tuple(Coverage.of(self.drawn, level) for level in LEVELS)

    def coverage_of(self, dimension: str) -> tuple[Coverage, ...]:
        """Of one dimension, over all looks that it was measured in."""
        found = [pair.probability for pair in self.pairs if pair.dimension == dimension]
        values = np.concatenate(found) if found else np.zeros(0)
        values = values[np.isfinite(values)]
        return tuple(Coverage.of(values, level) for level in LEVELS)


@dataclass(frozen=True, eq=False)
class _Job:
    inspection: Inspection
    settings: ExplicitSettings
    evaluation: EvaluationJob
    looks: int
    sensor: ImageSensor
    edges: tuple[Edges, ...]
    rays_per_pixel: int
    seed: int


@dataclass(frozen=True)
class _Outcome:
    """Of one setting, by the way of finding edges."""

    pairs: dict[Edges, list[ValidatedPair]]
    refused: list[tuple[str, str, str]]
    drawn: dict[Edges, list[float]]


def validate(
    inspection: Inspection,
    settings: SettingsLike = None,
    *,
    sample: int = 20,
    looks: int = 100,
    sensor: ImageSensor | None = None,
    edges: Sequence[Edges] = ("sub-pixel",),
    rays_per_pixel: int = 34,
    seed: int | None = None,
    progress: Progress | None = None,
    executor: Executor | None = None,
) -> dict[Edges, Validation]:
    """Hold the law of the error against displaced looks, rendered and measured.

    Each look has its own draw of the head's and of the calibration's errors and of the noise. Only what is looked at
    is rendered.

    Parameters
    ----------
    settings
        As of :func:`~viewgauge.evaluate`; where neither they nor the inspection name any, ``sample`` of the candidates
        that see something are drawn.
    looks
        Of each setting.
    edges
        How edges are found in the same images: "sub-pixel", "whole-pixel".
    executor
        Where settings are worked on (:func:`~viewgauge.jobs.open_executor`); by default in this process.

    Returns
    -------
    By the way of finding edges.

    Raises
    ------
    InputError
        If a number is out of range.
    NoCandidateError
        If no candidate sees a dimension.
    """
    for name, value in (("looks", looks), ("sample", sample)):
        if value < 1:
            raise InputError("at least one", key=name, got=value)
    for how in edges:
        require_edges(how)
    seed = inspection.seed if seed is None else seed
    dimensions, _ = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    if settings is None and inspection.settings is None:
        chosen = _drawn_settings(inspection, sample, seed)
    else:
        chosen = settings_of(inspection, settings)
    evaluation = EvaluationJob.of(inspection, dimensions, chosen)
    job = _Job(inspection, chosen, evaluation, looks, sensor or ImageSensor(), tuple(edges), rays_per_pixel, seed)
    outcomes: dict[int, _Outcome] = {}
    progress, executor = progress or Silent(), executor or InProcess()
    with progress.stage(f"Simulating and measuring {len(chosen) * looks} looks", len(chosen)) as advance:
        for index, outcome in executor.run(_validated_setting, job, list(range(len(chosen)))):
            outcomes[index] = outcome
            advance(1)
    return {how: _gathered(how, [outcomes[k] for k in range(len(chosen))], looks) for how in edges}


def _gathered(how: Edges, outcomes: Sequence[_Outcome], looks: int) -> Validation:
    drawn = np.array([value for outcome in outcomes for value in outcome.drawn[how]])
    return Validation(
        how,
        len(outcomes),
        looks,
        tuple(pair for outcome in outcomes for pair in outcome.pairs[how]),
        tuple(refusal for outcome in outcomes for refusal in outcome.refused),
        drawn[np.isfinite(drawn)],
        int(np.isnan(drawn).sum()),
    )


def _drawn_settings(inspection: Inspection, count: int, seed: int) -> ExplicitSettings:
    """Candidates that see something, drawn at random."""
    dimensions, _ = without_allowed_error(inspection.part.dimensions, inspection.requirement)
    if not dimensions:
        raise NoCandidateError("nothing can be measured, so no setting is sampled: see viewgauge check")
    grid = candidate_grid(inspection, dimensions)
    evaluation = EvaluationJob.of(inspection, dimensions, grid)
    rng, found = np.random.default_rng([seed, 7]), []
    for index in rng.permutation(len(grid)).tolist():
        pose = grid.poses(index, index + 1)
        if seen_gauges(evaluation, pose[0]):
            found.append((f"C{index + 1}", pose[0]))
        if len(found) == count:
            break
    if not found:
        raise NoCandidateError("no candidate sees a dimension: see viewgauge check")
    return ExplicitSettings(tuple(name for name, _ in found), np.array([pose for _, pose in found]))


@lru_cache(maxsize=1)
def _renderer_of(job: _Job) -> Renderer:
    mesh = job.inspection.part.mesh
    return Renderer(mesh.vertices, mesh.triangles, rays_per_pixel=job.rays_per_pixel)


def _validated_setting(job: _Job, index: int) -> _Outcome:
    """All looks of one setting."""
    inspection, sensor, name = job.inspection, job.sensor, job.settings.ids[index]
    camera, T = inspection.camera, job.settings.T_part_camera[index]
    head = PoseError(inspection.head.covariance, T_camera_head=inspection.head.T_camera_head)  # none in common
    gauges = seen_gauges(job.evaluation, T)
    windows = [window for gauge in gauges.values() for window in gauge_windows(gauge, T, camera, head)]
    renderer, expected, full = _renderer_of(job), list(gauges.values()), 2**sensor.bits - 1
    rounding, draw = 1 / full / np.sqrt(12), np.random.default_rng([job.seed, index, 1])
    noise, rehearsal = float(np.hypot(sensor.noise, rounding)), replace(sensor, noise=0.0)

    def measured(
        pose: NDArray[np.float64], sensor: ImageSensor, true: Camera, rng: np.random.Generator, noise: float = noise
    ) -> list[_Seen]:
        image = partial_image(renderer, sensor, pose, true, windows, rng) / full
        finder = EdgeFinder(image, noise, windows)
        guide = find_guide(finder, expected, T, camera, head)
        if guide is None:
            return [None] * len(expected)
        return [measure_gauge(finder, image, gauge, T, camera, guide) for gauge in expected]

    why = _rehearsed(gauges, T, camera, head, lambda pose: measured(pose, rehearsal, camera, draw, rounding), draw)
    clean = measured(T, rehearsal, camera, draw)
    known = [k for k, (reason, seen) in enumerate(zip(why, clean, strict=True)) if not reason and seen is not None]
    refused = [(name, dimension, reason) for dimension, reason in zip(gauges, why, strict=True) if reason]
    poses = displaced_poses(T, head, job.looks, np.random.default_rng([job.seed, index]))
    choice = draw.integers(len(known), size=job.looks) if known else np.zeros(0, np.int64)
    looks = []
    for look in range(job.looks if known else 0):
        rng = np.random.default_rng([job.seed, index, 2, look])
        looks.append(measured(poses[look], sensor, true_camera(camera, rng), rng))
    outcome = _Outcome({how: [] for how in job.edges}, refused, {how: [] for how in job.edges})
    for how in job.edges:
        for k in known:
            gauge, nominal = expected[k], clean[k]
            assert nominal is not None  # known
            seen = [found[k] for found in looks]
            outcome.pairs[how].append(_pair(name, list(gauges)[k], gauge, nominal, seen, T, camera, head, how))
        outcome.drawn[how] += [float(outcome.pairs[how][c].probability[look]) for look, c in enumerate(choice)]
    return outcome


_Seen = GaugeImage | None


def _rehearsed(
    gauges: Mapping[str, ExpectedGauge],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    head: PoseError,
    measured: Callable[[NDArray[np.float64]], list[_Seen]],
    rng: np.random.Generator,
) -> list[str]:
    """Why a gauge cannot be measured even in images without noise, or is not where it is found; empty where it can."""
    why = ["" for _ in gauges]
    for pose in [T_part_camera, *displaced_poses(T_part_camera, head, _REHEARSALS, rng)]:
        for k, (gauge, seen) in enumerate(zip(gauges.values(), measured(pose), strict=True)):
            if seen is None:
                why[k] = why[k] or "the part is not seen as planned"
            elif seen.measured_mm is None:
                why[k] = why[k] or seen.reason
            else:
                true = float(np.linalg.norm(np.diff(camera.project(transform(invert(pose), gauge.points)), axis=0)))
                off = abs(seen.measured_mm - true) / min(camera.pixel_pitch_mm)
                if off > _OFF_PX:
                    why[k] = why[k] or f"what lies beside its edges moves them: off by {off:.1f} px in clear images"
    return why


def _pair(
    setting: str,
    dimension: str,
    gauge: ExpectedGauge,
    nominal: GaugeImage,
    seen: Sequence[_Seen],
    T_part_camera: NDArray[np.float64],
    camera: Camera,
    head: PoseError,
    how: Edges,
) -> ValidatedPair:
    whole = how == "whole-pixel"
    law = length_law(gauge.points, T_part_camera, camera, head, nominal.deviation_mm, whole_pixels=whole)
    lengths = [None if found is None else found.length_mm(camera, whole) for found in seen]
    errors = np.array([np.nan if length is None else length - nominal.nominal_mm for length in lengths])
    probability = np.full(len(errors), np.nan)
    good = np.isfinite(errors)
    probability[good] = law.central_probability(np.abs(errors[good]))
    px = min(camera.pixel_pitch_mm)
    return ValidatedPair(
        setting,
        dimension,
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
            "settings": one.settings,
            "looks": one.looks,
            "coverage": [_level(c) for c in one.coverage()],
            "drawn_unmeasured": one.drawn_unmeasured,
            "dimensions": [_dimension(one, name) for name in dict.fromkeys(p.dimension for p in one.pairs)],
            "refused": [list(refusal) for refusal in one.refused],
        }
        for one in found.values()
    ]


def _level(coverage: Coverage) -> dict[str, Any]:
    return {**asdict(coverage), "holds": coverage.holds}


def _dimension(found: Validation, name: str) -> dict[str, Any]:
    errors = np.concatenate([p.errors_px / p.predicted_px for p in found.pairs if p.dimension == name])
    good = errors[np.isfinite(errors)]
    return {
        "id": name,
        "looks": len(good),
        "not_measured": int(len(errors) - len(good)),
        "rms_ratio": float(np.sqrt((good**2).mean())) if len(good) else None,
        "coverage": [_level(c) for c in found.coverage_of(name)],
    }


def write_validation(found: Mapping[Edges, Validation], path: str | PathLike[str]) -> None:
    """Write a CSV with a row for each setting and dimension, px.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ["edges", "setting", "dimension", "length_px", "predicted_px", "location_px", "looks", "not_measured"]
    writer.writerow([*names, "mean_px", "deviation_px", *(f"inside_{round(100 * level)}" for level in LEVELS)])
    for one in found.values():
        for pair in one.pairs:
            good = np.isfinite(pair.errors_px)
            errors = pair.errors_px[good]
            inside = [int((pair.probability[good] <= level).sum()) for level in LEVELS]
            spread = [float(errors.mean()), float(errors.std())] if len(errors) else ["", ""]
            predicted = [pair.length_px, pair.predicted_px, pair.location_px]
            counts = [int(good.sum()), int((~good).sum())]
            writer.writerow([one.edges, pair.setting, pair.dimension, *predicted, *counts, *spread, *inside])
    write_text_atomically(Path(path), text.getvalue())
