"""Measurands of characteristics on parts whose geometry is known exactly."""

from dataclasses import replace

import numpy as np
import pytest
from breps import drilled_plate, edge, face, moved, pmi_record, prism, slotted_block
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from soundness import assert_normals_outward, assert_sound, distance_to_edge, only_characteristic, only_reason

from viewgauge.part import PmiRecord
from viewgauge.part.characteristics import derive_characteristics

SLOT = (7, 9)
HOLES = [(20.0, 20.0), (20.0, 40.0), (80.0, 20.0)]


@pytest.mark.parametrize("kind", ["distance", "length"])
def test_slot_width_is_measured_between_its_walls(kind):
    solid, walls = slotted_block(), [face(i) for i in SLOT]
    references = (walls[:1], walls[1:]) if kind == "distance" else (walls, ())
    brep = solid.brep(pmi_record(kind, 20.0, *references))
    characteristic = only_characteristic(brep)
    assert characteristic.kind == kind
    assert_sound(brep, characteristic, 20.0, SLOT)


def test_slot_width_can_be_measured_from_above_and_from_both_ends():
    characteristic = only_characteristic(slotted_block().brep(pmi_record("distance", 20.0, [face(7)], [face(9)])))
    for direction in ([0, 0, 1], [0, 1, 0], [0, -1, 0]):
        assert any(
            (g.start_normals @ direction > 0.9).any() and (g.end_normals @ direction > 0.9).any()
            for g in characteristic.measurands
        )
    mouth = [g for g in characteristic.measurands if g.start[2] == g.end[2] == 30]
    floor = [g for g in characteristic.measurands if g.start[2] == g.end[2] == 18 and 0 < g.start[1] < 40]
    assert mouth, "the outer corners of the mouth"
    assert len(mouth) >= len(floor), "outer corners come before inner ones"


def test_step_length_is_measured_between_end_face_and_riser():
    brep = slotted_block().brep(pmi_record("distance", 50.0, [face(11)], [face(5)]))
    assert_sound(brep, only_characteristic(brep), 50.0, (11, 5))


def test_step_that_faces_the_same_way_is_joined_by_the_step_floor_edges():
    brep = slotted_block().brep(pmi_record("distance", 10.0, [face(3)], [face(5)]))
    characteristic = only_characteristic(brep)
    assert_sound(brep, characteristic, 10.0, (3, 5))
    assert all(g.start[2] == g.end[2] == 20 for g in characteristic.measurands)


def test_thickness_of_a_plate_is_measured_on_all_four_sides():
    brep = prism([(0, 0), (100, 0), (100, 10), (0, 10)], 60.0).brep(pmi_record("length", 10.0, [face(2), face(4)]))
    characteristic = only_characteristic(brep)
    assert_sound(brep, characteristic, 10.0, (2, 4))
    assert_normals_outward(brep, characteristic)
    for side in ([1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]):
        assert any(
            (g.start_normals @ side).max() == (g.end_normals @ side).max() == 1 for g in characteristic.measurands
        ), f"no measurand on the side {side}"


def test_distance_between_two_edges_and_between_a_face_and_an_edge():
    solid = slotted_block()
    brep = solid.brep()
    mouth = [next(i for i in brep.faces[wall].edges if i in brep.faces[top].edges) for wall, top in ((7, 6), (9, 10))]
    by_edges = solid.brep(pmi_record("distance", 20.0, [edge(mouth[0])], [edge(mouth[1])]))
    assert_sound(by_edges, only_characteristic(by_edges), 20.0, SLOT)
    mixed = solid.brep(pmi_record("distance", 20.0, [face(7)], [edge(mouth[1])]))
    characteristic = only_characteristic(mixed)
    assert_sound(mixed, characteristic, 20.0, SLOT)
    assert distance_to_edge(characteristic.measurands[0].end, brep.edges[mouth[1]]) < 1e-9, "the given edge comes first"


def test_edge_length_and_face_length():
    solid = slotted_block()
    index = next(i for i, e in enumerate(solid.brep().edges) if np.allclose(np.ptp(e.points, axis=0), [10, 0, 0]))
    by_edge = solid.brep(pmi_record("length", 10.0, [edge(index)]))
    characteristic = only_characteristic(by_edge)
    assert [g.length_mm for g in characteristic.measurands] == [10.0]
    assert len(characteristic.measurands[0].start_normals) == 3, "three faces meet at the corner"
    across = solid.brep(pmi_record("length", 20.0, [face(8)]))
    assert_sound(across, only_characteristic(across), 20.0, (8,))


def test_pattern_of_slots_and_of_ribs():
    comb = [
        (0, 0),
        (50, 0),
        (50, 20),
        (40, 20),
        (40, 10),
        (30, 10),
        (30, 20),
        (20, 20),
        (20, 10),
        (10, 10),
        (10, 20),
        (0, 20),
    ]
    solid = prism(comb, 30.0)
    walls = {50: 3, 40: 5, 30: 7, 20: 9, 10: 11, 0: 13}
    faces = solid.brep().faces
    assert all(faces[index].origin[0] == x for x, index in walls.items())
    slots, _ = derive_characteristics(
        solid.brep(pmi_record("length", 10.0, [face(walls[x]) for x in (10, 20, 30, 40)]))
    )
    assert [d.id for d in slots] == ["D/1", "D/2"], "each face once: two slots, not the rib between them"
    ribs, _ = derive_characteristics(solid.brep(pmi_record("length", 10.0, [face(i) for i in walls.values()])))
    assert [d.id for d in ribs] == ["D/1", "D/2", "D/3"]
    for characteristic in (*slots, *ribs):
        assert all(g.length_mm == pytest.approx(10.0, abs=1e-9) for g in characteristic.measurands)


def test_distance_along_another_direction_than_between_the_axes_names_both_values():
    solid, holes = drilled_plate([(20.0, 20.0), (80.0, 40.0)])
    brep = solid.brep(pmi_record("distance", 60.0, [face(i) for i in holes[0]], [face(i) for i in holes[1]]))
    assert "60 mm disagrees with the geometry, 63.2456 mm" in only_reason(brep)


def test_smooth_edges_are_no_measurands():
    solid = prism([(0, 0), (100, 0), (100, 10), (0, 10)], 60.0)
    brep = solid.brep(pmi_record("length", 10.0, [face(2), face(4)]))
    right = set(brep.faces[3].edges)
    smooth = replace(brep, edges=tuple(replace(e, smooth=i in right) for i, e in enumerate(brep.edges)))
    characteristic = only_characteristic(smooth)
    assert all(max(g.start[0], g.end[0]) < 100 for g in characteristic.measurands)
    none = replace(brep, edges=tuple(replace(e, smooth=True) for e in brep.edges))
    assert "no two visible edges" in only_reason(none)


def test_unsupported_pmi_records_are_listed_with_their_reason():
    solid, (hole,) = drilled_plate(HOLES[:1])
    cases = {
        "radius": (pmi_record("radius", 4.0, [face(hole[0])]), "a radius has no pair"),
        "angle": (
            pmi_record("angle", 1.0, [face(2)], [face(3)], label="angular location"),
            "57.2958 deg, its faces 90 deg",
        ),
        "nothing": (pmi_record("distance", 5.0, []), "refers to no face"),
        "unread": (replace(pmi_record("distance", 5.0, []), problem="lost in translation"), "lost in translation"),
        "perpendicular": (pmi_record("distance", 10.0, [face(2)], [face(3)]), "not parallel"),
        "axis": (pmi_record("distance", 20.0, [face(5)], [face(hole[0])]), "an axis has no visible edge"),
        "value": (pmi_record("distance", 10.5, [face(2)], [face(4)]), "10.5 mm disagrees with the geometry, 10 mm"),
        "diameter": (pmi_record("diameter", 8.3, [face(i) for i in hole]), "8.3 mm disagrees with the geometry, 8 mm"),
        "one per cent": (pmi_record("distance", 10.2, [face(2)], [face(4)], tolerance_mm=None), "10.2 mm disagrees"),
    }
    brep = solid.brep(*(replace(given, name=name) for name, (given, _) in cases.items()))
    characteristics, not_measurable = derive_characteristics(brep)
    assert not characteristics
    assert [entry.id for entry in not_measurable] == list(cases)
    for entry in not_measurable:
        assert cases[entry.id][1] in entry.reason


def test_basic_value_and_missing_value_stay_characteristics():
    solid = prism([(0, 0), (100, 0), (100, 10), (0, 10)], 60.0)
    basic = only_characteristic(solid.brep(pmi_record("distance", 10.0, [face(2)], [face(4)], tolerance_mm=None)))
    assert basic.tolerance_mm is None
    without = PmiRecord("D", "distance", "linear distance", float("nan"), None, (face(2),), (face(4),))
    assert only_characteristic(solid.brep(without)).nominal_mm == pytest.approx(10.0)


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1),
    st.lists(st.floats(-500, 500), min_size=3, max_size=3),
)
def test_results_move_along_with_the_part(quaternion, translation):
    solid, (hole,) = drilled_plate(HOLES[:1])
    brep = solid.brep(
        pmi_record("length", 10.0, [face(2), face(4)], name="thickness"),
        pmi_record("diameter", 8.0, [face(i) for i in hole], name="hole"),
    )
    R = Rotation.from_quat(quaternion).as_matrix()
    before, _ = derive_characteristics(brep)
    after, not_measurable = derive_characteristics(moved(brep, R, translation))
    assert not not_measurable
    for at_rest, in_motion in zip(before, after, strict=True):
        assert len(at_rest.measurands) == len(in_motion.measurands)
        for a, b in zip(at_rest.measurands, in_motion.measurands, strict=True):
            np.testing.assert_allclose(R @ a.start + translation, b.start, atol=1e-8)
            np.testing.assert_allclose(R @ a.end + translation, b.end, atol=1e-8)
            np.testing.assert_allclose(a.start_normals @ R.T, b.start_normals, atol=1e-9)


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_any_pmi_record_becomes_a_characteristic_or_a_reason(data):
    solid, _ = drilled_plate(HOLES)
    brep = solid.brep()
    references = st.one_of(
        st.builds(face, st.integers(0, len(brep.faces) - 1)), st.builds(edge, st.integers(0, len(brep.edges) - 1))
    )
    sets = [data.draw(st.lists(references, max_size=4)) for _ in range(2)]
    kind = data.draw(st.sampled_from(["distance", "length", "diameter", "radius", "angle", "other"]))
    nominal = data.draw(st.sampled_from([8.0, 10.0, 20.0, 60.0, 100.0, float("nan"), 0.0]))
    tolerance = data.draw(st.sampled_from([None, (-0.1, 0.1), (0.0, 0.0), (0.1, 0.3)]))
    characteristics, not_measurable = derive_characteristics(
        solid.brep(pmi_record(kind, nominal, *sets, tolerance_mm=tolerance))
    )
    assert len(characteristics) + len(not_measurable) >= 1
    assert all(entry.reason for entry in not_measurable)
    for characteristic in characteristics:
        lengths = [measurand.length_mm for measurand in characteristic.measurands]
        assert lengths == pytest.approx([lengths[0]] * len(lengths), abs=1e-6)
        assert len(lengths) >= 1
