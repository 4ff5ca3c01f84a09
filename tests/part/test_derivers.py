"""Kinds of PMI records: which are derived, and how one is added from outside."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from breps import drilled_plate, edge, face, pmi_record, prism
from soundness import only_characteristic, only_reason

from viewgauge.exceptions import InputError
from viewgauge.part import Diameter, LengthBetweenPoints
from viewgauge.part.characteristics import derive_characteristics, derivers, register
from viewgauge.part.characteristics.outcome import Derived, NotDerived

PLATE = [(0, 0), (100, 0), (100, 10), (0, 10)]


@pytest.fixture
def registry(monkeypatch):
    monkeypatch.setattr(derivers, "_DERIVERS", dict(derivers._DERIVERS))


def derive_depth(outline, pmi_record):
    """A toy: the length of each edge that the record refers to, whatever its nominal value."""
    outcomes = []
    for reference in pmi_record.first:
        start, end = outline.brep.edges[reference.index].points[[0, -1]]
        measurand = outline.measurand(reference.index, start, reference.index, end)
        outcomes.append(Derived(measurand.length_mm, (measurand,)))
    return outcomes or [NotDerived("a depth needs an edge")]


@pytest.mark.usefixtures("registry")
def test_a_kind_is_added_from_outside():
    solid = prism(PLATE, 60.0)
    record = pmi_record("depth", math.nan, [edge(0), edge(1)], name="deep")
    assert "a PMI record of kind depth (size)" in only_reason(solid.brep(replace(record, first=(edge(0),))))
    register("depth", derive_depth)
    brep = solid.brep(record)
    characteristics, not_measurable = derive_characteristics(brep)
    assert not not_measurable
    assert [(c.id, c.kind, c.unit) for c in characteristics] == [
        ("deep/1", "depth", "mm"),
        ("deep/2", "depth", "mm"),
    ]
    for characteristic, index in zip(characteristics, (0, 1), strict=True):
        start, end = brep.edges[index].points
        assert characteristic.nominal_mm == pytest.approx(math.dist(start, end))
    assert only_reason(solid.brep(replace(record, first=()))) == "a depth needs an edge"


@pytest.mark.usefixtures("registry")
def test_a_kind_has_one_deriver():
    register("depth", derive_depth)
    register("depth", derive_depth)  # a module that is loaded twice is no other deriver
    with pytest.raises(InputError, match="deriver already"):
        register("length", derive_depth)


@pytest.mark.parametrize("kind", ["distance", "length", "diameter"])
def test_a_record_without_references_is_told_so(kind):
    brep = prism(PLATE, 60.0).brep(pmi_record(kind, 10.0, [], [face(2)]))
    assert only_reason(brep) == "the PMI record refers to no face or edge"


@pytest.mark.parametrize("kind", ["length", "diameter"])
def test_a_size_between_two_sets_of_references_is_their_distance(kind):
    characteristic = only_characteristic(prism(PLATE, 60.0).brep(pmi_record(kind, 10.0, [face(2)], [face(4)])))
    assert characteristic.kind == kind
    assert all(isinstance(measurand, LengthBetweenPoints) for measurand in characteristic.measurands)


def test_chords_of_a_rim_are_diameters_and_know_its_axis_where_the_rim_is_whole():
    solid, (hole,) = drilled_plate([(20.0, 20.0)])
    characteristic = only_characteristic(solid.brep(pmi_record("diameter", 8.0, [face(i) for i in hole])))
    assert all(isinstance(measurand, Diameter) for measurand in characteristic.measurands)
    assert all(abs(measurand.rim_axis @ [0, 0, 1]) == pytest.approx(1) for measurand in characteristic.measurands)


def test_chords_of_two_thirds_of_a_rim_are_diameters_without_an_axis():
    solid, _ = drilled_plate([(20.0, 20.0)], parts=3)
    arcs = [i for i, e in enumerate(solid.brep().edges) if e.kind == "circle" and e.centre[2] == 10]
    characteristic = only_characteristic(solid.brep(pmi_record("diameter", 8.0, [edge(i) for i in arcs[:2]])))
    assert all(isinstance(measurand, Diameter) for measurand in characteristic.measurands)
    assert all(measurand.rim_axis is None for measurand in characteristic.measurands)


def test_what_is_not_measurable_keeps_its_unit():
    brep = prism(PLATE, 60.0).brep(
        pmi_record("angle", 1.0, [face(2)], [face(3)], name="angle"),
        pmi_record("radius", 4.0, [face(2)], name="radius"),
    )
    _, not_measurable = derive_characteristics(brep)
    assert {entry.id: entry.unit for entry in not_measurable} == {"angle": "rad", "radius": "mm"}
