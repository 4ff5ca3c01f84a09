"""The whole plan of the example part, stage by stage."""

from __future__ import annotations

import tempfile
from collections.abc import Callable

import numpy as np
import pytest

import part
import viewgauge as vg
from viewgauge.evaluation import Evaluator
from viewgauge.planning import CandidateGrid, Undominated, choose_viewpoints, probability_levels

pytestmark = pytest.mark.benchmark(group="plan")


@pytest.mark.parametrize("stage", ["poses", "accepted", "table", "dominance", "cover", "plan", "report"])
def test_stage(stage: str, tiny: bool, timed: Callable[..., None]) -> None:
    """Each stage on what the one before it gives."""
    i = part.with_candidates(1000 if tiny else 12_000)
    grid = CandidateGrid(part.measurands().points, i.part.mesh, i.camera, i.candidates, i.seed)
    evaluator = Evaluator(i.part.characteristics, i.part.mesh, i.setup)
    poses = grid.poses(0, len(grid))
    accepted = evaluator.accepted(poses)
    level = probability_levels(accepted.probability, i.requirement.probability)

    def dominance() -> Undominated:
        kept = Undominated(level.shape[1])
        kept.add(np.arange(len(level)), level, accepted.certain)
        return kept

    kept, plan = dominance(), vg.plan(i)

    def report() -> None:
        with tempfile.TemporaryDirectory() as folder:
            vg.write_plan(plan, i, folder)

    calls: dict[str, tuple[str, Callable[[], object]]] = {
        "poses": ("sampling poses", lambda: grid.poses(0, len(grid))),
        "accepted": ("evaluating what is accepted", lambda: evaluator.accepted(poses)),
        "table": ("evaluating the whole table (evaluate)", lambda: evaluator.table(poses)),
        "dominance": (f"removing dominated viewpoints ({len(kept)} stay)", dominance),
        "cover": ("choosing the fewest and most probable", lambda: choose_viewpoints(kept)),
        "plan": ("the plan, all of the above but the table; refined and bounded", lambda: vg.plan(i)),
        "report": ("writing plan and report", report),
    }
    name, call = calls[stage]
    timed(call, count=len(grid), unit="viewpoints", rounds=5, name=name)
