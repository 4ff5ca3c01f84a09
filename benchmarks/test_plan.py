"""The whole plan of the example part, stage by stage."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

import part
import viewgauge as vg
from viewgauge.evaluation import Evaluator
from viewgauge.planning import CandidateGrid, Undominated, choose_viewpoints, probability_levels

pytestmark = pytest.mark.benchmark(group="plan")


@dataclass(frozen=True)
class Stages:
    """What the stages begin with, each what the one before it gives."""

    inspection: vg.Inspection
    grid: CandidateGrid
    evaluator: Evaluator
    poses: NDArray[np.float64]
    level: NDArray[np.uint16]
    certain: NDArray[np.bool_]
    plan: vg.Plan

    def undominated(self) -> Undominated:
        """The viewpoints that no other makes needless."""
        kept = Undominated(self.level.shape[1])
        kept.add(np.arange(len(self.level)), self.level, self.certain)
        return kept

    def report(self) -> None:
        """Write the plan and its report."""
        with tempfile.TemporaryDirectory() as folder:
            vg.write_plan(self.plan, self.inspection, folder)


@pytest.fixture(scope="module")
def stages(tiny: bool) -> Stages:
    """Of the example, done once."""
    i = part.with_candidates(1000 if tiny else 12_000)
    grid = CandidateGrid(part.measurands().points, i.part.mesh, i.camera, i.candidates, i.seed)
    evaluator = Evaluator(i.part.characteristics, i.part.mesh, i.setup)
    poses = grid.poses(0, len(grid))
    accepted = evaluator.accepted(poses)
    level = probability_levels(accepted.probability, i.requirement.probability)
    return Stages(i, grid, evaluator, poses, level, accepted.certain, vg.plan(i))


@pytest.mark.parametrize("stage", ["poses", "accepted", "table", "dominance", "cover", "plan", "report"])
def test_stage(stage: str, stages: Stages, timed: Callable[..., None]) -> None:
    """Each stage on what the one before it gives."""
    s, kept = stages, stages.undominated()
    calls: dict[str, tuple[str, Callable[[], object]]] = {
        "poses": ("sampling poses", lambda: s.grid.poses(0, len(s.grid))),
        "accepted": ("evaluating what is accepted", lambda: s.evaluator.accepted(s.poses)),
        "table": ("evaluating the whole table (evaluate)", lambda: s.evaluator.table(s.poses)),
        "dominance": (f"removing dominated viewpoints ({len(kept)} stay)", s.undominated),
        "cover": ("choosing the fewest and most probable", lambda: choose_viewpoints(kept)),
        "plan": ("the plan, all of the above but the table; refined and bounded", lambda: vg.plan(s.inspection)),
        "report": ("writing plan and report", s.report),
    }
    name, call = calls[stage]
    timed(call, count=len(s.grid), unit="viewpoints", rounds=5, name=name)
