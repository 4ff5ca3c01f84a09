"""Evaluates viewpoints, block by block, on all cores: the table, or only what is accepted."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..geometry import VIEWS, PoseError, invert, transform, view_block
from ..part import Characteristic, Mesh
from ..part.measurand_table import MeasurandTable
from ..sensors import Camera
from ..visibility import VISIBLE, Culling, Occluder, SightLines
from .compiled.best_measurands import best_measurands
from .compiled.kernel import ProbabilityKernel
from .compiled.pair_columns import PairColumns
from .segment import FirstOrderMethod, SegmentImage, image_segment, require_plain
from .setup import Setup
from .validity import NEGLIGIBLE, WARNINGS, validity

__all__ = ["Accepted", "Evaluator", "TableBlock"]

_Block = TypeVar("_Block", "TableBlock", "Accepted")
_Result = TypeVar("_Result")


@dataclass(frozen=True)
class TableBlock:
    """The table's values of n viewpoints x d characteristics.

    Parameters
    ----------
    reason, validity
        ``(n, d)`` index into :data:`~viewgauge.visibility.REASONS`; 0, or one more than that into
        :data:`~viewgauge.evaluation.WARNINGS`.
    measurand
        ``(n, d)`` index of the best measurand among those of its characteristic.
    image_length_px, angle_rad, relative_tolerance, sigma_displacement_px, sigma_quantization_px, probability,
    expected_accuracy
        ``(n, d)``: the columns of the table.
    """

    reason: NDArray[np.int8]
    image_length_px: NDArray[np.float64]
    angle_rad: NDArray[np.float64]
    relative_tolerance: NDArray[np.float64]
    sigma_displacement_px: NDArray[np.float64]
    sigma_quantization_px: NDArray[np.float64]
    probability: NDArray[np.float64]
    expected_accuracy: NDArray[np.float64]
    measurand: NDArray[np.int32]
    validity: NDArray[np.int8]

    @property
    def visible(self) -> NDArray[np.bool_]:
        """``(n, d)``: no observability condition fails."""
        return np.asarray(self.reason == VISIBLE)


@dataclass(frozen=True)
class Accepted:
    """What n viewpoints measure of d characteristics as surely as required.

    Parameters
    ----------
    probability
        ``(n, d)``: of the most probable visible measurand; 0 where it is under the requirement.
    certain
        ``(n, d)``: the small-error model is beyond doubt by the size of what it neglects.
    """

    probability: NDArray[np.float64]
    certain: NDArray[np.bool_]


class Evaluator:
    """Everything that is the same for all viewpoints, made ready once.

    Parameters
    ----------
    characteristics
        Each with at least one measurand and an allowed error under the requirement.
    mesh
        The part's surface, which hides.
    threads
        How many work at once; by default as many as there are processors.
    occluder
        The mesh made ready for rays, where that was done before.
    """

    def __init__(
        self,
        characteristics: Sequence[Characteristic],
        mesh: Mesh,
        setup: Setup,
        method: FirstOrderMethod = "joint",
        threads: int | None = None,
        occluder: Occluder | None = None,
    ) -> None:
        measurands = MeasurandTable.of(characteristics)
        camera, error = setup.camera, setup.pose_error
        if method == "independent":
            require_plain(camera)
        self.characteristics, self.setup = tuple(characteristics), setup
        self._mesh = mesh
        self.allowed_error_mm = np.array([setup.allowed_error_mm(characteristic) for characteristic in characteristics])
        self._measurands, self._camera, self._error, self._method = measurands, camera, error, method
        self.required = setup.requirement.probability
        self._tolerance = self.allowed_error_mm[measurands.characteristic] / measurands.length_mm
        self._first = np.append(measurands.first, len(measurands)).astype(np.int64)
        self._culling = Culling(measurands, camera, setup.limits)
        self._occluder = occluder or Occluder(mesh)
        self._lines = SightLines(measurands, self._occluder)
        self._kernel = ProbabilityKernel(measurands, self._tolerance, camera, error)
        self._columns = PairColumns(measurands, camera, error)
        self.threads = threads or _processors()

    def of(self, characteristics: Sequence[int]) -> Evaluator:
        """The same for some of the characteristics, by index: what hides is made ready only once."""
        return Evaluator(
            [self.characteristics[j] for j in characteristics],
            self._mesh,
            self.setup,
            self._method,
            self.threads,
            self._occluder,
        )

    def with_setup(self, setup: Setup) -> Evaluator:
        """The same characteristics and part with another set-up: what hides is made ready only once."""
        return Evaluator(self.characteristics, self._mesh, setup, self._method, self.threads, self._occluder)

    def with_errors(self, camera: Camera, pose_error: PoseError) -> Evaluator:
        """The same with another camera and another uncertainty of its pose."""
        return self.with_setup(replace(self.setup, camera=camera, pose_error=pose_error))

    def probabilities(self, T_part_camera: NDArray[np.float64]) -> NDArray[np.float64]:
        """``(n, d)`` of viewpoints ``(n, 4, 4)`` mm: of the most probable visible measurand, also below the
        requirement; else 0.
        """
        return np.concatenate(self._of_blocks(lambda poses: self._ranked(poses, 0.0).probability, T_part_camera))

    def table(self, T_part_camera: NDArray[np.float64]) -> TableBlock:
        """The table of viewpoints ``(n, 4, 4)`` mm."""
        return self._each_block(self._table_block, T_part_camera)

    def accepted(self, T_part_camera: NDArray[np.float64]) -> Accepted:
        """Only what is accepted, of viewpoints ``(n, 4, 4)`` mm: rays are cast for nothing else."""
        return self._each_block(self._accepted_block, T_part_camera)

    def _each_block(self, work: Callable[[NDArray[np.float64]], _Block], T_part_camera: NDArray[np.float64]) -> _Block:
        results = self._of_blocks(work, T_part_camera)
        joined = (np.concatenate([getattr(r, f.name) for r in results]) for f in fields(results[0]))
        return type(results[0])(*joined)

    def _of_blocks(
        self, work: Callable[[NDArray[np.float64]], _Result], T_part_camera: NDArray[np.float64]
    ) -> list[_Result]:
        blocks = [T_part_camera[k : k + VIEWS] for k in range(0, len(T_part_camera), VIEWS)] or [T_part_camera]
        with _mapped(self.threads, work, blocks) as done:
            return list(done)

    def _ranked(self, poses: NDArray[np.float64], threshold: float) -> _Ranked:
        views, count = view_block(poses), len(poses)
        reason = self._culling.reasons(views, count)
        if self._method == "joint":
            probability, margin = self._kernel.probabilities(views, count, reason)
        else:
            probability, margin = self._independent(poses, reason)
        best, seen = best_measurands(views, count, reason, probability, margin, self._first, self._lines, threshold)
        measurand, seen = best[:, :count].T, seen[:, :count].T
        viewpoint = np.broadcast_to(np.arange(count)[:, None], measurand.shape)
        return _Ranked(
            views, measurand, seen, reason[measurand, viewpoint], np.where(seen, probability[measurand, viewpoint], 0.0)
        )

    def _independent(
        self, poses: NDArray[np.float64], reason: NDArray[np.int8]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The paper's model, in NumPy; the margin of a measurand is its expected accuracy."""
        measurand, viewpoint = np.nonzero(reason[:, : len(poses)] == VISIBLE)
        image = self._image(poses[viewpoint], measurand)
        probability, margin = np.zeros(reason.shape), np.zeros(reason.shape)
        probability[measurand, viewpoint] = image.success_probability(self._tolerance[measurand])
        margin[measurand, viewpoint] = image.expected_accuracy()
        return probability, margin

    def _image(self, poses: NDArray[np.float64], measurand: NDArray[np.int64]) -> SegmentImage:
        points = transform(invert(poses)[:, None], self._measurands.points[measurand])
        return image_segment(points[:, 0], points[:, 1], self._camera, self._error, self._method)

    def _table_block(self, poses: NDArray[np.float64]) -> TableBlock:
        ranked = self._ranked(poses, 0.0)
        measurand, visible = ranked.measurand, ranked.seen
        viewpoint = np.repeat(np.arange(len(measurand)), measurand.shape[1])
        values = self._columns.of(ranked.views, viewpoint, measurand.ravel())
        sigma, accuracy = (v.reshape(measurand.shape) for v in (values.sigma_displacement_px, values.expected_accuracy))
        if self._method == "independent":
            at = np.nonzero(visible)
            image = self._image(poses[at[0]], measurand[at])
            direction = np.stack([np.cos(image.angle_rad), np.sin(image.angle_rad)], axis=-1)
            per_mm = np.linalg.norm(direction / np.asarray(self._camera.pixel_pitch_mm), axis=-1)
            sigma[at], accuracy[at] = image.sigma_displacement_mm * per_mm, image.expected_accuracy()
        return TableBlock(
            reason=ranked.reason,
            image_length_px=values.length_px.reshape(measurand.shape),
            angle_rad=values.angle_rad.reshape(measurand.shape),
            relative_tolerance=self._tolerance[measurand],
            sigma_displacement_px=np.where(visible, sigma, np.nan),
            sigma_quantization_px=np.where(visible, values.sigma_quantization_px.reshape(measurand.shape), np.nan),
            probability=ranked.probability,
            expected_accuracy=np.where(visible, accuracy, 0.0),
            measurand=(measurand - self._measurands.first).astype(np.int32),
            validity=self._validity(poses, measurand, visible, values.neglected.reshape(measurand.shape)),
        )

    def _validity(
        self,
        poses: NDArray[np.float64],
        measurand: NDArray[np.int64],
        visible: NDArray[np.bool_],
        neglected: NDArray[np.float64],
    ) -> NDArray[np.int8]:
        """Codes of the warnings; only pairs that neglect more than nothing are looked at closely."""
        codes = np.zeros(measurand.shape, dtype=np.int8)
        at = np.nonzero(visible & ~(neglected < _SCREEN))
        if len(at[0]):
            points = transform(invert(poses[at[0]])[:, None], self._measurands.points[measurand[at]])
            names = validity(points[:, 0], points[:, 1], self._camera, self._error, self._tolerance[measurand[at]])
            found = np.zeros(len(names), dtype=np.int8)
            for code, name in enumerate(WARNINGS, start=1):
                found[names == name] = code
            codes[at] = found
        return codes

    def _accepted_block(self, poses: NDArray[np.float64]) -> Accepted:
        ranked = self._ranked(poses, self.required)
        at = np.nonzero(ranked.seen)
        certain = np.zeros(ranked.seen.shape, dtype=bool)
        certain[at] = self._columns.neglected(ranked.views, at[0], ranked.measurand[at]) < _SCREEN
        return Accepted(ranked.probability, certain)


def _processors() -> int:
    """How many this process may use, where the system tells."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def _mapped(
    threads: int, work: Callable[[NDArray[np.float64]], _Result], blocks: Sequence[NDArray[np.float64]]
) -> Iterator[Iterator[_Result]]:
    """Results in order; the compiled loops and the ray caster let other threads run."""
    if min(threads, len(blocks)) < 2:
        yield map(work, blocks)
        return
    pool = ThreadPoolExecutor(threads)
    try:
        yield pool.map(work, blocks)
    finally:
        pool.shutdown(cancel_futures=True)


# what rounding may move does not decide: the exact evaluation has the last word at the border
_SCREEN = NEGLIGIBLE * (1 - 1e-6)


@dataclass(frozen=True)
class _Ranked:
    """A block of n viewpoints with the best measurand of each characteristic ``(n, d)``."""

    views: NDArray[np.float64]
    measurand: NDArray[np.int64]
    seen: NDArray[np.bool_]
    reason: NDArray[np.int8]
    probability: NDArray[np.float64]
