"""Evaluate given viewpoints: the table viewpoint x characteristic, in memory or chunk by chunk into a file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation import COLUMNS, WARNINGS, BestRows, as_dataset
from ..exceptions import InputError
from ..execution.chunks import (
    CONFIDENCE,
    DEFAULT_PRECISION,
    VIEWPOINTS_PER_CHUNK,
    EvaluationJob,
    TableJob,
    ViewpointSource,
    chunks_of,
    evaluator_of,
    require_chunk_size,
    table_chunk,
)
from ..execution.executor import Executor, InProcess
from ..execution.fingerprint import job_fingerprint
from ..execution.progress import Progress, Silent
from ..part import Characteristic
from ..planning import without_allowed_error
from ..planning.inspection import Inspection
from ..visibility import REASONS
from .given_viewpoints import ViewpointsLike, sampled_viewpoints, viewpoints_of
from .success_probability import Method

if TYPE_CHECKING:
    import xarray as xr

    from ..formats.tables.table_store import TableStore

__all__ = ["Evaluation", "evaluate", "evaluate_into"]


_SIMULATED_PER_CHUNK = 32  # viewpoints between two signs of progress
_OPTIONAL = ("validity", "probability_low", "probability_high")  # in files after the standard columns
_NAMES = {"reason": REASONS, "validity": ("", *WARNINGS)}
_FLAGS = ("visible", "accepted")


def evaluate(
    inspection: Inspection,
    viewpoints: ViewpointsLike = None,
    *,
    method: Method = "joint",
    precision: float = DEFAULT_PRECISION,
    progress: Progress | None = None,
) -> xr.Dataset:
    """The table viewpoint x characteristic, in memory; :func:`evaluate_into` writes one of any length.

    Parameters
    ----------
    viewpoints
        A viewpoints file (CSV), poses ``T_part_camera`` ``(n, 4, 4)`` mm, or None for those that the inspection
        file names.
    method
        "joint" (both ends share the pose error, the default), "independent" (the paper's), or "monte-carlo" (the
        full camera model by randomised quasi-Monte Carlo, for each visible pair).
    precision
        With "monte-carlo": half-width of the 99 % confidence interval of each probability.

    Returns
    -------
    Dataset over (viewpoint, characteristic) with the columns ``visible, reason, image_length_px, angle_rad,
    relative_tolerance, sigma_displacement_px, sigma_quantization_px, probability, expected_accuracy, accepted``
    and ``measurand``, the index of the best measurand, and ``validity``, what makes the first-order probability
    doubtful; with "monte-carlo" also the confidence interval ``probability_low, probability_high``.
    """
    progress = progress or Silent()
    chosen = viewpoints_of(inspection, viewpoints)
    characteristics, job = _job(inspection, chosen, method, precision, None)
    pieces: list[Mapping[str, NDArray[np.generic]]] = []
    with progress.stage(_stage(len(chosen), method, precision), len(chosen)) as advance:
        for chunk in chunks_of(chosen, _chunk_size(method, VIEWPOINTS_PER_CHUNK)):
            pieces.append(table_chunk(job, chunk)[1])
            advance(chunk[1] - chunk[0])
    columns = {name: np.concatenate([piece[name] for piece in pieces]) for name in job.columns}
    evaluator = evaluator_of(job.evaluation)
    attrs = _attributes(inspection, method, precision)
    return as_dataset(columns, chosen.ids, characteristics, evaluator.allowed_error_mm, attrs)


@dataclass(frozen=True)
class Evaluation:
    """What is known of a table that was written chunk by chunk, or not written at all.

    Parameters
    ----------
    viewpoints
        Number of viewpoints.
    characteristics
        Ids.
    best
        The most probable viewpoint of each characteristic, by index.
    required_probability
        From which on a pair is accepted.
    """

    viewpoints: int
    viewpoint_ids: Sequence[str]
    characteristics: tuple[str, ...]
    best: BestRows
    required_probability: float

    def best_of_each(self) -> dict[str, dict[str, object]]:
        """For each characteristic its most probable viewpoint, as plain data: viewpoint, visible, reason, probability,
        accepted.
        """
        rows: dict[str, dict[str, object]] = {}
        for j, name in enumerate(self.characteristics):
            values, visible = self.best.values, bool(self.best.values.visible[j])
            probability = float(values.probability[j])
            rows[name] = {
                "viewpoint": str(self.viewpoint_ids[int(self.best.viewpoint[j])]),
                "visible": visible,
                "reason": REASONS[int(values.reason[j])],
                "probability": probability,
                "expected_accuracy": float(values.expected_accuracy[j]),
                "accepted": visible and probability >= self.required_probability,
                "validity": _NAMES["validity"][int(values.validity[j])],
            }
        return rows


def evaluate_into(
    inspection: Inspection,
    path: str | PathLike[str] | None,
    viewpoints: ViewpointsLike = None,
    *,
    sampled: bool = False,
    columns: Sequence[str] | None = None,
    method: Method = "joint",
    precision: float = DEFAULT_PRECISION,
    progress: Progress | None = None,
    executor: Executor | None = None,
    viewpoints_per_chunk: int = VIEWPOINTS_PER_CHUNK,
) -> Evaluation:
    """Write the table viewpoint x characteristic chunk by chunk: memory holds a few chunks, however long it is.

    Parameters
    ----------
    path
        A file in CSV or Parquet or a Zarr folder, by suffix; None to write nothing. A Zarr table that was interrupted
        goes on where it was when the same is asked for again, and has the same bytes in the end.
    viewpoints, method, precision
        As for :func:`evaluate`.
    sampled
        Evaluate the candidates that a plan would sample, in place of given viewpoints.
    columns
        Names of the columns to write, whose order does not matter; by default all, but ``measurand`` to Zarr only.
    executor
        Where chunks run (:func:`~viewgauge.execution.executor.open_executor`); by default in this process. Zarr is
        written by the processes of the executor, which must all see the path.
    viewpoints_per_chunk
        Bounds the memory of a process; of Zarr also the chunks.

    Raises
    ------
    InputError
        If something given cannot be used, or the place cannot be written.
    """
    progress, executor = progress or Silent(), executor or InProcess()
    require_chunk_size(viewpoints_per_chunk)
    source: ViewpointSource
    if sampled:
        if viewpoints is not None:
            raise InputError("sampled candidates and given viewpoints exclude each other", key="viewpoints")
        source, ids = sampled_viewpoints(inspection)
    else:
        source = chosen = viewpoints_of(inspection, viewpoints)
        ids = chosen.ids
    wanted = _wanted(columns, method)
    threads = None if isinstance(executor, InProcess) else 1
    characteristics, job = _job(inspection, source, method, precision, threads, wanted if path is not None else ())
    size = _chunk_size(method, viewpoints_per_chunk)
    attrs = _attributes(inspection, method, precision)
    best: BestRows | None = None
    with (
        _store(path, inspection, ids, job, size, attrs, columns is not None) as store,
        progress.stage(_stage(len(source), method, precision), len(source)) as advance,
    ):
        chunks = chunks_of(source, size)
        done: Mapping[int, Mapping[str, Any]] = {} if store is None else store.done
        for k, summary in done.items():
            best = _merged(best, BestRows.from_arrays({n: np.array(v) for n, v in summary["best"].items()}))
            advance(chunks[k][1] - chunks[k][0])
        left = [k for k in range(len(chunks)) if k not in done]
        job = _with_writer(job, store)
        for at, (found, values) in executor.run(table_chunk, job, [chunks[k] for k in left]):
            if store is not None and job.writer is None:
                store.write(chunks[left[at]][0], values)
            best = _merged(best, found)
            advance(chunks[left[at]][1] - chunks[left[at]][0])
    assert best is not None  # there is at least one chunk
    named = tuple(characteristic.id for characteristic in characteristics)
    return Evaluation(len(source), ids, named, best, inspection.requirement.probability)


def _merged(ours: BestRows | None, theirs: BestRows) -> BestRows:
    return theirs if ours is None else ours.merged(theirs)


def _job(
    inspection: Inspection,
    source: ViewpointSource,
    method: Method,
    precision: float,
    threads: int | None,
    columns: tuple[str, ...] | None = None,
) -> tuple[tuple[Characteristic, ...], TableJob]:
    from ..simulation.quasi_monte_carlo import require_precision

    if method not in ("joint", "independent", "monte-carlo"):
        raise InputError("unknown method", key="method", got=method, expected="joint, independent or monte-carlo")
    exact = method == "monte-carlo"
    require_precision(precision)
    characteristics, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    first_order = "joint" if method == "monte-carlo" else method
    evaluation = EvaluationJob.of(inspection, characteristics, source, first_order, threads)
    columns = _wanted(None, method) if columns is None else columns
    return characteristics, TableJob(evaluation, columns, precision if exact else None, inspection.seed)


def _wanted(columns: Sequence[str] | None, method: Method) -> tuple[str, ...]:
    """The columns to write, in their order."""
    known = (*COLUMNS, *(_OPTIONAL if method == "monte-carlo" else _OPTIONAL[:1]), "measurand")
    if columns is None:
        return known
    expected = ", ".join(known)
    if not any(columns):
        raise InputError("no column is named", key="columns", got=", ".join(columns), expected=expected)
    for k, name in enumerate(columns):
        if name not in known:
            raise InputError("no such column", key="columns", got=name, expected=expected)
        if name in columns[:k]:
            raise InputError("a column is named twice", key="columns", got=name, expected="each once")
    return tuple(name for name in known if name in columns)


def _chunk_size(method: Method, given: int) -> int:
    return min(given, _SIMULATED_PER_CHUNK) if method == "monte-carlo" else given


def _stage(viewpoints: int, method: Method, precision: float) -> str:
    how = f" with the full camera model to {precision:g}" if method == "monte-carlo" else ""
    return f"Evaluating {viewpoints} viewpoints{how}"


def _attributes(inspection: Inspection, method: Method, precision: float) -> dict[str, str | float]:
    attrs: dict[str, str | float] = {"method": method, "required_probability": inspection.requirement.probability}
    return attrs | ({"precision": precision, "confidence": CONFIDENCE} if method == "monte-carlo" else {})


@contextmanager
def _store(
    path: str | PathLike[str] | None,
    inspection: Inspection,
    ids: Sequence[str],
    job: TableJob,
    size: int,
    attrs: Mapping[str, str | float],
    asked_for: bool,
) -> Iterator[TableStore | None]:
    """The open table of a path, chunks of ``size`` viewpoints; None where nothing is written.

    Parameters
    ----------
    asked_for
        The columns were named by the user.
    """
    if path is None:
        yield None
        return
    from ..formats.tables.table_store import Column, TableLayout, open_table

    def column(name: str) -> Column:
        if name in _NAMES:
            return Column(name, "name", _NAMES[name])
        if name == "measurand":
            return Column(name, "whole", in_rows=asked_for)  # in rows of no use to most
        return Column(name, "flag" if name in _FLAGS else "real")

    characteristics = job.evaluation.characteristics
    layout = TableLayout(
        viewpoint_ids=ids,
        characteristic_ids=[characteristic.id for characteristic in characteristics],
        columns=tuple(column(name) for name in job.columns),
        chunk_viewpoints=size,
        coordinates={
            "nominal_mm": np.array([characteristic.nominal_mm for characteristic in characteristics]),
            "allowed_error_mm": evaluator_of(job.evaluation).allowed_error_mm,
        },
        attrs=dict(attrs),
    )
    fingerprint = job_fingerprint(inspection, job.evaluation, size, layout.columns, sorted(attrs.items()))
    with open_table(path, layout, fingerprint) as store:
        yield store


def _with_writer(job: TableJob, store: TableStore | None) -> TableJob:
    writer = getattr(store, "writer", None)
    return job if writer is None else replace(job, writer=writer())
