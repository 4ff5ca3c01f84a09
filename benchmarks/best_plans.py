"""How good plans are: greedy, the best of the candidates, refined, with bounds, each probability by the full camera
model.

Usage: python benchmarks/best_plans.py [FOLDER_OF_STEP_FILES] [--precision P] [--directions N]

The slotted block, and with the folder of the NIST STEP files the five CTC parts, planned as their inspection files say.
Prints Markdown. Exit code 1 if the full camera model contradicts a probability, or refining made a plan worse.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import viewgauge as vg
from viewgauge.execution.chunks import EvaluationJob, candidate_grid, evaluator_of
from viewgauge.geometry import invert, transform
from viewgauge.planning import without_allowed_error
from viewgauge.simulation import Sampling, estimate_success_probabilities

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
MODEL_ERROR = 3e-4  # of a probability without warning: docs/paper/validity.md
CONFIDENCE = 0.9999  # of each interval: of 200, one fails by chance with a probability of 2 %


@dataclass(frozen=True)
class Row:
    """What was found of a part; ``weakest`` is the least probability of what is met."""

    part: str
    characteristics: int
    met: int
    greedy: tuple[int, float]
    sampled: tuple[int, float]
    same_count: float
    refined: tuple[int, int, float]
    anywhere: int
    not_met: Sequence[str]
    contradicted: int
    difference: float
    seconds: tuple[float, float]

    @property
    def worse(self) -> bool:
        """Refining cost viewpoints or sureness, which it must not."""
        return self.refined[0] > self.sampled[0] or self.same_count < self.sampled[1] - 1e-12

    @property
    def raised_at_last(self) -> bool:
        """The weakest characteristic is strictly more probable in the refined plan, which may have fewer viewpoints."""
        return self.refined[2] > self.sampled[1]

    @property
    def raised(self) -> bool:
        """With as many viewpoints the weakest characteristic is strictly more probable."""
        return self.same_count > self.sampled[1]


def parts(folder: Path | None) -> Iterator[tuple[str, vg.Inspection]]:
    """The parts by name, read."""
    yield "slotted block", vg.load(EXAMPLES / "slotted_block" / "inspection.yaml")
    for file in sorted((EXAMPLES / "nist").glob("ctc_*.yaml")) if folder else ():
        number = file.stem.removeprefix("ctc_")
        part = next(iter(sorted(folder.glob(f"nist_ctc_{number}_*_ap242*.stp"))), None)
        if part is None:
            sys.exit(f"no nist_ctc_{number}_*_ap242*.stp in {folder}")
        yield f"CTC-{number}", vg.load(file, part=part)


def greedy(inspection: vg.Inspection) -> tuple[int, float]:
    """The textbook's cover: again and again the candidate that measures most of what is left, the first of equals."""
    characteristics, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    grid = candidate_grid(inspection, characteristics)
    evaluator = evaluator_of(EvaluationJob.of(inspection, characteristics, grid))
    probability = evaluator.accepted(grid.poses(0, len(grid))).probability
    accepted = probability >= inspection.requirement.probability
    left, chosen = accepted.any(axis=0), []
    while left.any():
        chosen.append(int((accepted & left).sum(axis=1).argmax()))
        left &= ~accepted[chosen[-1]]
    best = probability[chosen].max(axis=0)
    return len(chosen), float(best[accepted.any(axis=0)].min())


def confirmed(inspection: vg.Inspection, plan: vg.Plan, precision: float) -> tuple[int, float]:
    """How many probabilities of characteristics met the full camera model contradicts, and the largest difference."""
    met = [d for d in plan.characteristics if d.status == "met" and not d.acquisitions]
    points = np.array([transform(invert(d.T_part_camera), d.measurand) for d in met])
    tolerance = [d.allowed_error_mm / np.linalg.norm(np.diff(d.measurand, axis=0)) for d in met]
    exact = estimate_success_probabilities(
        points[:, 0],
        points[:, 1],
        inspection.camera,
        inspection.pose_error,
        np.array(tolerance),
        sampling=Sampling(precision=precision, confidence=CONFIDENCE, seed=1),
    )
    said = np.array([d.probability for d in met])
    outside = (said < exact.low - MODEL_ERROR) | (said > exact.high + MODEL_ERROR)
    return int(outside.sum()), float(np.abs(said - exact.probability).max())


def row(name: str, inspection: vg.Inspection, precision: float) -> Row:
    """Plan a part both ways and judge the figures."""
    start = time.perf_counter()
    sampled = vg.plan(inspection, refine=False, prove=False)
    between = time.perf_counter()
    refined = vg.plan(inspection)
    seconds = between - start, time.perf_counter() - between
    steps = {step.name: step for step in refined.refinement.steps}
    same = steps["raise"].weakest if steps["raise"].count == sampled.count else steps["sampled"].weakest
    contradicted, difference = confirmed(inspection, refined, precision)
    not_met = [d for d in refined.characteristics if d.status == "not_met"]
    return Row(
        name,
        sum(d.status != "not_measurable" for d in refined.characteristics),
        sum(d.status == "met" for d in refined.characteristics),
        greedy(inspection),
        (sampled.count, weakest(sampled)),
        same,
        (refined.count, refined.lower_bound, weakest(refined)),
        refined.anywhere.count,
        [f"{d.id}: {d.proof}" for d in not_met],
        contradicted,
        difference,
        seconds,
    )


def weakest(plan: vg.Plan) -> float:
    """Least probability of what is met."""
    return min(d.probability for d in plan.characteristics if d.status == "met")


COLUMNS = (
    *("part", "characteristics met", "greedy", "weakest", "best of the candidates", "weakest", "as many, refined"),
    *("refined", "bound", "anywhere", "gap", "weakest", "full camera model", "seconds"),
)


def cells(of: Row) -> tuple[object, ...]:
    """A row of the table."""
    gap = (of.refined[0] - of.anywhere) / of.refined[0]
    return (
        *(of.part, f"{of.met} of {of.characteristics}", of.greedy[0], f"{of.greedy[1]:.4f}"),
        *(of.sampled[0], f"{of.sampled[1]:.4f}", f"{of.same_count:.4f}"),
        *(of.refined[0], of.refined[1], of.anywhere, f"{gap:.0%}", f"{of.refined[2]:.4f}"),
        *(f"{of.difference:.0e}", f"{of.seconds[0]:.1f} + {of.seconds[1]:.1f}"),
    )


def main() -> int:
    """Print the table, and what is proven of what is not met."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?", help="the NIST STEP files")
    parser.add_argument("--precision", type=float, default=3e-4, help="half-width of the full camera model's intervals")
    parser.add_argument("--directions", type=int, help="of the candidates, in place of the files'")
    given = parser.parse_args()
    rows = []
    print("| " + " | ".join(COLUMNS) + " |")
    print("|" + " --- |" * len(COLUMNS))
    for name, inspection in parts(given.folder):
        if given.directions:
            inspection = replace(inspection, candidates=replace(inspection.candidates, directions=given.directions))
        rows.append(row(name, inspection, given.precision))
        print("| " + " | ".join(str(cell) for cell in cells(rows[-1])) + " |", flush=True)
    print()
    for of in rows:
        for not_met in of.not_met:
            print(f"- {of.part}, {not_met}")
    raised, at_last = sum(of.raised for of in rows), sum(of.raised_at_last for of in rows)
    worse = sum(of.worse for of in rows)
    contradicted = sum(of.contradicted for of in rows)
    print(
        f"\nParts whose lowest probability rises: {raised} of {len(rows)} with the same number of viewpoints, "
        f"{at_last} in the refined plan,"
    )
    print("which may have fewer viewpoints. Parts with more viewpoints, or with as many and a lower probability:")
    print(f"{worse}. Probabilities of met characteristics that the full camera model contradicts: {contradicted}.")
    return 1 if worse or contradicted else 0


if __name__ == "__main__":
    sys.exit(main())
