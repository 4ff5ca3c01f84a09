"""The example part is what its script builds, and holds the characteristics that its README names."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "slotted_block"
STEP = EXAMPLE / "slotted_block.step"


@pytest.fixture(scope="module")
def script() -> ModuleType:
    pytest.importorskip("OCP")
    spec = importlib.util.spec_from_file_location("build_part", EXAMPLE / "build_part.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def test_script_builds_the_committed_file(script: ModuleType) -> None:
    assert script.step_text(script.build_document()) == STEP.read_text(encoding="ascii")


def test_pmi_records_as_the_file_writes_them() -> None:
    records = re.sub(r"\s+", " ", STEP.read_text(encoding="ascii"))
    names = re.findall(r"= DRAUGHTING_CALLOUT\('(\w+)'", records)
    assert sorted(names) == sorted(f"E{k}" for k in range(1, 15))
    assert len(re.findall(r"= DIMENSIONAL_LOCATION\('linear distance'", records)) == 11
    assert re.findall(r"= DIMENSIONAL_SIZE\(#\d+,'([\w ]+)'\)", records) == ["curve length", "diameter", "diameter"]
    assert len(re.findall(r"= PLUS_MINUS_TOLERANCE\(", records)) == 12  # not the range E9, not the basic E12
    assert len(re.findall(r"REPRESENTATION_ITEM ?\('lower limit'\)", records)) == 1


def test_step_length_is_the_edge_of_the_paper(script: ModuleType) -> None:
    (pmi_record,) = [pmi_record for pmi_record in script.PMI_RECORDS if pmi_record.name == "E2"]
    edge = script.feature_at(script.build_solid(), pmi_record.first[0], pmi_record.target)
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.TopoDS import TopoDS

    curve = BRepAdaptor_Curve(TopoDS.Edge(edge))
    ends = sorted(
        (round(p.X(), 9), round(p.Y(), 9), round(p.Z(), 9))
        for p in (curve.Value(curve.FirstParameter()), curve.Value(curve.LastParameter()))
    )
    assert ends == [(0, 0, 40), (60, 0, 40)]
