"""From a table to a plan: who measures what, what is not met, and what cannot be measured."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from viewgauge.evaluation import BestRows, CapabilityRequirement, Requirement, TableBlock
from viewgauge.part import Characteristic, LengthBetweenPoints, NotMeasurable
from viewgauge.planning import (
    ChosenViewpoints,
    NotMetFindings,
    PlanRecord,
    Undominated,
    choose_viewpoints,
    compose_plan,
    probability_levels,
    without_allowed_error,
)
from viewgauge.visibility import REASONS

REQUIRED = Requirement("error", 0.05, 0.9)


def characteristic(name, count=2, tolerance=(-0.1, 0.1)):
    up = np.array([[0.0, 0, 1]])
    made = tuple(LengthBetweenPoints(np.array([0.0, k, 0]), np.array([10.0, k, 0]), up, up) for k in range(count))
    return Characteristic(name, "length", 10.0, tolerance, made)


def table(probability, measurand=0, hidden=()):
    probability = np.array(probability, dtype=float)
    reason = np.full(probability.shape, REASONS.index(""), dtype=np.int8)
    for k, j in hidden:
        reason[k, j], probability[k, j] = REASONS.index("occluded"), 0.0
    return TableBlock(
        reason=reason,
        image_length_px=np.full(probability.shape, 500.0),
        angle_rad=np.zeros(probability.shape),
        relative_tolerance=np.full(probability.shape, 0.005),
        sigma_displacement_px=np.full(probability.shape, 0.3),
        sigma_quantization_px=np.full(probability.shape, 0.1),
        probability=probability,
        expected_accuracy=probability * 0.999,
        measurand=np.full(probability.shape, measurand, dtype=np.int32),
        validity=np.zeros(probability.shape, dtype=np.int8),
    )


def rows(values: TableBlock, chosen):
    return TableBlock(*(getattr(values, f.name)[list(chosen)] for f in fields(values)))


def plan_of(values, characteristics, not_measurable=(), ids=None):
    """As the job does it: keep what the cover needs, choose, compose."""
    poses = np.tile(np.eye(4), (len(values.reason), 1, 1))
    poses[:, 0, 3] = np.arange(len(poses))
    level = probability_levels(np.where(values.visible, values.probability, 0.0), REQUIRED.probability)
    kept = Undominated(len(characteristics))
    kept.add(np.arange(len(level)), level, np.ones(level.shape, dtype=bool))
    cover = choose_viewpoints(kept)
    best = BestRows.of(values, np.arange(len(level)))
    names = tuple(ids[k] if ids else f"S{n}" for n, k in enumerate(cover.chosen, start=1))
    return compose_plan(
        ChosenViewpoints(rows(values, cover.chosen), poses[list(cover.chosen)], names),
        characteristics,
        not_measurable,
        REQUIRED,
        NotMetFindings({j: (best, j) for j in range(len(characteristics))}),
        PlanRecord(lower_bound=cover.lower_bound, candidate_count=len(poses), seed=3),
    )


def test_each_characteristic_is_measured_by_the_most_probable_of_the_chosen():
    # rows 1 and 3 are the only pair that holds all; both hold the middle characteristic
    values = table([[0.99, 0, 0], [0.95, 0.91, 0], [0, 0.99, 0.2], [0.1, 0.96, 0.93]], measurand=1)
    plan = plan_of(values, [characteristic(name) for name in "abc"])
    assert [s.id for s in plan.viewpoints] == ["S1", "S2"]
    assert [s.T_part_camera[0, 3] for s in plan.viewpoints] == [1, 3]
    assert [s.observes for s in plan.viewpoints] == [("a",), ("b", "c")]
    assert [(d.status, d.viewpoint, d.probability) for d in plan.characteristics] == [
        ("met", "S1", 0.95),
        ("met", "S2", 0.96),
        ("met", "S2", 0.93),
    ]
    assert all(d.limit == "" and d.measurand[0, 1] == 1 for d in plan.characteristics), "the second measurand"
    assert (plan.count, plan.lower_bound, plan.gap, plan.proven, plan.all_met) == (2, 2, 0.0, True, True)
    assert plan.candidate_count == 4
    assert plan.seed == 3


def test_an_not_met_characteristic_names_the_best_of_all_candidates_and_costs_no_viewpoint():
    values = table([[0.95, 0.2, 0.0], [0.0, 0.7, 0.0], [0.0, 0.0, 0.0]], hidden=[(0, 2), (1, 2), (2, 2)])
    plan = plan_of(values, [characteristic(name) for name in "abc"], ids=["x", "y", "z"])
    assert [s.id for s in plan.viewpoints] == ["x"]
    met, best, unseen = plan.characteristics
    assert (met.status, met.viewpoint) == ("met", "x")
    assert (best.status, best.viewpoint, best.probability) == ("not_met", None, 0.7)
    assert best.measurand is not None
    assert "pose error (90%" in best.limit
    assert (unseen.status, unseen.viewpoint, unseen.probability, unseen.measurand) == ("not_met", None, 0.0, None)
    assert "hidden by the part (100%)" in unseen.limit
    assert not plan.all_met


def test_nothing_met_is_a_plan_of_no_viewpoint():
    plan = plan_of(table([[0.5]]), [characteristic("a")])
    assert (plan.count, plan.lower_bound, plan.gap, plan.all_met) == (0, 0, 0.0, False)


def test_a_probability_that_is_not_seen_counts_for_nothing():
    values = replace(table([[0.99]]), reason=np.array([[REASONS.index("occluded")]], dtype=np.int8))
    assert plan_of(values, [characteristic("a")]).characteristics[0].status == "not_met"


def test_what_cannot_be_measured_stays_in_the_plan_with_its_reason():
    not_measurable = [NotMeasurable("q", "angle", "an angle has no measurand")]
    plan = plan_of(table([[0.99]]), [characteristic("a")], not_measurable)
    assert [(d.id, d.status, d.limit) for d in plan.characteristics] == [
        ("a", "met", ""),
        ("q", "not_measurable", "an angle has no measurand"),
    ]
    assert not plan.all_met


def test_a_basic_value_is_judged_by_accuracy_and_refused_by_a_fraction_of_its_tolerance():
    given = [characteristic("a"), characteristic("b", tolerance=None)]
    judged, refused = without_allowed_error(given, Requirement("accuracy", 0.99, 0.9))
    assert ([d.id for d in judged], refused) == (["a", "b"], ())
    judged, refused = without_allowed_error(given, Requirement("fraction_of_tolerance", 0.1, 0.9))
    assert [d.id for d in judged] == ["a"]
    assert [(u.id, u.nominal_mm) for u in refused] == [("b", 10.0)]
    assert "no tolerance" in refused[0].reason


def test_what_a_requirement_says_nothing_about_is_refused_with_its_reason():
    given = [characteristic("a"), characteristic("b", tolerance=(-0.001, 0.001)), characteristic("c", tolerance=None)]
    judged, refused = without_allowed_error(given, CapabilityRequirement("cgk", 1.33, bias_mm=0.002))
    assert [d.id for d in judged] == ["a"]
    assert [(u.id, u.tolerance_mm) for u in refused] == [("b", (-0.001, 0.001)), ("c", None)]
    assert "bias" in refused[0].reason
    assert "no tolerance" in refused[1].reason
