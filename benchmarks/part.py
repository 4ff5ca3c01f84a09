"""What the benchmarks of evaluating and planning work on: the example part, of which any number of views is sampled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

import viewgauge as vg
from viewgauge.geometry import VIEWS, view_block
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.planning import CandidateGrid

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "slotted_block" / "inspection.yaml"

Item = TypeVar("Item")


@cache
def inspection() -> vg.Inspection:
    """The slotted block: 15 characteristics, 147 measurands."""
    return vg.load(EXAMPLE)


def with_candidates(count: int) -> vg.Inspection:
    """The example with about ``count`` candidates: more directions, or of few fewer distances and points aimed at."""
    options = replace(inspection().candidates, distances=3, rolls=2, targets=4)
    if count < 3000:
        options = replace(options, distances=2, rolls=1, targets=1)
    per_direction = options.distances * options.rolls * (options.targets + 1)
    return replace(inspection(), candidates=replace(options, directions=max(1, round(count / per_direction))))


@cache
def measurands() -> MeasurandTable:
    """The example's measurands."""
    return MeasurandTable.of(inspection().part.characteristics)


@cache
def tolerances() -> NDArray[np.float64]:
    """``(g,)``: relative tolerance of each measurand."""
    allowed = [
        inspection().requirement.allowed_error_mm(d.nominal_mm, d.tolerance_mm)
        for d in inspection().part.characteristics
    ]
    return np.array(allowed, dtype=float)[measurands().characteristic] / measurands().length_mm


def blocks(viewpoints: int) -> list[NDArray[np.float64]]:
    """Whole blocks of about this many candidate viewpoints."""
    i = with_candidates(viewpoints)
    grid = CandidateGrid(measurands().points, i.part.mesh, i.camera, i.candidates, i.seed)
    return [view_block(grid.poses(k, k + VIEWS)) for k in range(0, len(grid) - VIEWS + 1, VIEWS)]


def on_threads(threads: int, work: Callable[[Item], object], items: Sequence[Item]) -> Callable[[], None]:
    """A call that does all items on some threads."""

    def run() -> None:
        if threads == 1:
            for item in items:
                work(item)
            return
        with ThreadPoolExecutor(threads) as pool:
            for _ in pool.map(work, items):
                pass

    return run
