"""A plan that was written and is read back says the same."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import viewgauge as vg
from viewgauge.jobs.read_plan import require_plan_of
from viewgauge.jobs.write import describe_plan

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "slotted_block"


@pytest.fixture(scope="module", params=["met and not", "several viewpoints"])
def planned(request):
    inspection = vg.load(EXAMPLE / ("averaging.yaml" if request.param == "several viewpoints" else "inspection.yaml"))
    wanted = ("E1", "E7", "E9")
    part = replace(inspection.part, characteristics=tuple(d for d in inspection.part.characteristics if d.id in wanted))
    requirement = inspection.requirement
    if request.param == "met and not":
        requirement = replace(requirement, probability=0.97)
    options = replace(inspection.candidates, directions=50)
    inspection = replace(inspection, part=part, candidates=options, requirement=requirement)
    return inspection, vg.plan(inspection)


def test_everything_that_was_written_is_there(planned, tmp_path):
    inspection, plan = planned
    vg.write_plan(plan, inspection, tmp_path)
    again = vg.read_plan(tmp_path)
    assert describe_plan(again, inspection) == describe_plan(plan, inspection)
    assert vg.read_plan(tmp_path / "plan.json").count == plan.count
    require_plan_of(again, inspection)


def test_the_plan_of_another_part_is_refused(planned):
    inspection, plan = planned
    other = replace(inspection, part=replace(inspection.part, characteristics=inspection.part.characteristics[1:]))
    with pytest.raises(vg.InputError, match="of another part"):
        require_plan_of(plan, other)


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"viewpoints": 3}'])
def test_what_is_no_plan_is_refused(tmp_path, text):
    (tmp_path / "plan.json").write_text(text)
    with pytest.raises(vg.InputError):
        vg.read_plan(tmp_path)


def test_a_missing_plan_is_refused(tmp_path):
    with pytest.raises(vg.InputError, match=r"plan\.json"):
        vg.read_plan(tmp_path)


def test_a_plan_that_lacks_something_is_refused(planned, tmp_path):
    inspection, plan = planned
    document = describe_plan(plan, inspection)
    del document["characteristics"][0]["certificate"]
    (tmp_path / "plan.json").write_text(json.dumps(document))
    with pytest.raises(vg.InputError, match="not a plan"):
        vg.read_plan(tmp_path)
