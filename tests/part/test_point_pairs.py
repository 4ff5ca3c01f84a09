"""Measurands given by two points of a mesh, and the lines of a mesh for pictures."""

import numpy as np
import pytest
import trimesh
from breps import box_mesh, drilled_plate, face, pmi_record
from hypothesis import given
from hypothesis import strategies as st

from viewgauge.exceptions import InputError
from viewgauge.part import Mesh
from viewgauge.part.characteristics.point_pairs import distance_to_triangles, measurand_on_mesh
from viewgauge.part.feature_lines import brep_feature_lines, mesh_feature_lines

BOX = box_mesh([0, 0, 0], [60, 40, 30])


def rows(normals):
    return {tuple(np.round(n, 9) + 0.0) for n in normals}


def test_normals_are_those_of_the_faces_at_each_end():
    measurand = measurand_on_mesh(BOX, [0, 0, 30], [60, 20, 30])
    assert measurand.length_mm == pytest.approx(np.hypot(60, 20))
    assert rows(measurand.start_normals) == {(-1, 0, 0), (0, -1, 0), (0, 0, 1)}
    assert rows(measurand.end_normals) == {(1, 0, 0), (0, 0, 1)}
    assert rows(measurand_on_mesh(BOX, [0, 20, 30], [30, 11, 30]).end_normals) == {(0, 0, 1)}


def test_point_near_the_surface_has_the_nearest_faces():
    measurand = measurand_on_mesh(BOX, [0, 20, 30.05], [60, 20, 30], tolerance_mm=1e-3)
    assert rows(measurand.start_normals) <= {(-1, 0, 0), (0, 0, 1)}
    assert len(measurand.start_normals) >= 1


@pytest.mark.parametrize(
    ("start", "end", "message"),
    [
        ([0, 0, 0], [0, 0, 35], "outside the part: its end is 5 mm"),
        ([30, 20, 15], [0, 0, 30], "outside the part: its start is 15 mm"),
        ([0, 0, 0], [0, 0, 0], "no length"),
        ([0, 0, np.nan], [0, 0, 30], "three finite numbers"),
        ([0, 0, 0], [0, np.inf, 30], "three finite numbers"),
        ([0, 0], [0, 0, 30], "three finite numbers"),
        (["a", 0, 0], [0, 0, 30], "three finite numbers"),
    ],
)
def test_bad_points_are_refused(start, end, message):
    with pytest.raises(InputError, match=message):
        measurand_on_mesh(BOX, start, end)


def test_chord_error_widens_what_counts_as_touching():
    sphere = trimesh.creation.icosphere(subdivisions=2, radius=20.0)
    rough = Mesh(sphere.vertices, sphere.faces.astype(np.int64), chord_error_mm=0.5)
    measurand = measurand_on_mesh(rough, [0, 0, 20], [0, 0, -20])
    assert (measurand.start_normals[:, 2] > 0.9).all()
    assert (measurand.end_normals[:, 2] < -0.9).all()


@given(st.lists(st.floats(-100, 100), min_size=3, max_size=3))
def test_distance_to_a_box_is_the_analytic_one(point):
    p, low, high = np.array(point), BOX.vertices.min(axis=0), BOX.vertices.max(axis=0)
    outside = np.linalg.norm(np.maximum(0, np.maximum(low - p, p - high)))
    inside = min((p - low).min(), (high - p).min())
    expected = inside if inside > 0 else outside
    assert distance_to_triangles(BOX, p).min() == pytest.approx(expected, abs=1e-9)


def test_box_has_twelve_feature_lines_without_diagonals():
    lines = mesh_feature_lines(BOX)
    assert sorted(np.linalg.norm(line[1] - line[0]) for line in lines) == pytest.approx([30] * 4 + [40] * 4 + [60] * 4)


def test_repeated_vertices_and_degenerate_triangles_change_nothing():
    soup = Mesh(BOX.vertices[BOX.triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert len(mesh_feature_lines(soup)) == 12
    degenerate = Mesh(BOX.vertices, np.vstack([BOX.triangles, [[0, 0, 1]]]))
    assert len(mesh_feature_lines(degenerate)) == 12


def test_smooth_facets_are_no_feature_lines_but_open_borders_are():
    cylinder = trimesh.creation.cylinder(radius=10, height=20, sections=64)
    lines = mesh_feature_lines(Mesh(cylinder.vertices, cylinder.faces.astype(np.int64)))
    assert len(lines) == 128, "both rims, no rulings"
    assert len(mesh_feature_lines(Mesh(BOX.vertices, BOX.triangles[:1]))) == 3


def test_brep_lines_leave_out_seams_and_smooth_edges():
    solid, (hole,) = drilled_plate([(20.0, 20.0)])
    brep = solid.brep(pmi_record("diameter", 8.0, [face(i) for i in hole]))
    assert len(brep_feature_lines(brep)) == 12 + 4
