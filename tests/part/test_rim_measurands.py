"""Measurands on circular edges: diameters of holes and bosses, distances between axes, depths of holes."""

import numpy as np
import pytest
from breps import drilled_plate, edge, face, pmi_record, prism, slotted_block
from soundness import assert_sound, only_characteristic, only_reason

from viewgauge.part.characteristics import derive_characteristics

HOLES = [(20.0, 20.0), (20.0, 40.0), (80.0, 20.0)]


@pytest.mark.parametrize("parts", [1, 2, 3])
def test_hole_pattern_has_one_characteristic_per_hole(parts):
    solid, holes = drilled_plate(HOLES[::-1], parts=parts)
    brep = solid.brep(pmi_record("diameter", 8.0, [face(i) for hole in holes for i in hole], name="HOLE"))
    characteristics, not_measurable = derive_characteristics(brep)
    assert not not_measurable
    assert [d.id for d in characteristics] == ["HOLE/1", "HOLE/2", "HOLE/3"]
    for characteristic, centre, hole in zip(characteristics, HOLES, holes[::-1], strict=True):
        assert_sound(brep, characteristic, 8.0, hole, chord_mm=0.02)
        for measurand in characteristic.measurands:
            np.testing.assert_allclose((measurand.start + measurand.end)[:2] / 2, centre, atol=1e-9)
            assert measurand.start[2] == measurand.end[2]
        assert {g.start[2] for g in characteristic.measurands} == {0.0, 10.0}, "a through hole has two rims"
        assert len(characteristic.measurands) == 12


def test_aligned_holes_of_two_legs_are_two_features():
    solid = slotted_block()
    left = solid.cylinder([(0, 20, 25), (15, 20, 25)], (11, 9), 2.0)
    right = solid.cylinder([(35, 20, 25), (50, 20, 25)], (7, 5), 2.0)
    brep = solid.brep(pmi_record("diameter", 4.0, [face(i) for i in (*right, *left)]))
    characteristics, not_measurable = derive_characteristics(brep)
    assert not not_measurable
    assert [sorted({g.start[0] for g in d.measurands}) for d in characteristics] == [[0.0, 15.0], [35.0, 50.0]]


def test_hole_and_boss_on_one_axis_are_two_features():
    solid = prism([(0, 0), (100, 0), (100, 10), (0, 10)], 60.0)
    hole = solid.cylinder([(20, 20, 0), (20, 20, 10)], (2, 4), 4.0)
    boss = solid.cylinder([(20, 20, 10), (20, 20, 15)], (4, 4), 4.0, concave=False)
    characteristics, _ = derive_characteristics(
        solid.brep(pmi_record("diameter", 8.0, [face(i) for i in (*boss, *hole)]))
    )
    assert [d.id for d in characteristics] == ["D/1", "D/2"]


def test_single_hole_keeps_the_plain_name():
    solid, (hole,) = drilled_plate(HOLES[:1])
    assert (
        only_characteristic(solid.brep(pmi_record("diameter", 8.0, [face(i) for i in hole], name="HOLE"))).id == "HOLE"
    )


def test_diameter_by_rim_edges_and_by_the_plane_they_bound():
    solid, holes = drilled_plate(HOLES)
    top_rims = [i for i, e in enumerate(solid.brep().edges) if e.kind == "circle" and e.centre[2] == 10]
    for references in ([edge(i) for i in top_rims], [face(4)]):
        characteristics, not_measurable = derive_characteristics(solid.brep(pmi_record("diameter", 8.0, references)))
        assert len(characteristics) == len(holes)
        assert not not_measurable
        assert all(g.start[2] == 10 for d in characteristics for g in d.measurands)


def test_half_a_hole_with_less_than_half_a_rim_has_no_diameter():
    solid, (hole,) = drilled_plate(HOLES[:1], parts=3)
    assert "opposite" in only_reason(solid.brep(pmi_record("diameter", 8.0, [face(hole[0])])))


def test_axis_distance_of_equal_holes_is_measured_rim_to_rim():
    solid, holes = drilled_plate(HOLES)
    brep = solid.brep(pmi_record("distance", 60.0, [face(i) for i in holes[0]], [face(i) for i in holes[2]]))
    characteristic = only_characteristic(brep)
    assert_sound(brep, characteristic, 60.0, (*holes[0], *holes[2]), chord_mm=0.02)
    for measurand in characteristic.measurands:
        np.testing.assert_allclose(measurand.end - measurand.start, [60, 0, 0], atol=1e-9)


def test_axis_distance_of_unequal_holes_is_not_measured_rim_to_rim():
    solid = prism([(0, 0), (100, 0), (100, 10), (0, 10)], 60.0)
    small, large = (solid.cylinder([(x, 20, 0), (x, 20, 10)], (2, 4), r) for x, r in ((20, 4.0), (80, 5.0)))
    brep = solid.brep(pmi_record("distance", 60.0, [face(i) for i in small], [face(i) for i in large]))
    assert "equal radius" in only_reason(brep)


def test_length_of_a_hole_is_measured_along_its_wall():
    solid, (hole,) = drilled_plate(HOLES[:1])
    brep = solid.brep(pmi_record("length", 10.0, [face(i) for i in hole], label="depth"))
    assert_sound(brep, only_characteristic(brep), 10.0, hole, chord_mm=0.02)
