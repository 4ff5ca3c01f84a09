"""Meshes that were read with a gap, inside out, in another unit, or as bodies whose seams nobody could see."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
import trimesh

import viewgauge as vg
from cases.version_2 import CASES, copy_case
from viewgauge.exceptions import PartFileError
from viewgauge.formats.mesh.mesh_part import MeshPart
from viewgauge.formats.mesh.meshes import read_mesh
from viewgauge.part.characteristics.point_pairs import measurand_on_mesh, missing_edge

shared = pytest.mark.skipif(not CASES.is_dir(), reason="the shared cases are not beside this checkout")


def part_of(path, unit=None):
    with MeshPart().reading(path, None, unit) as finish:
        return finish()


def written(tmp_path, *bodies, name="part.stl"):
    path = tmp_path / name
    trimesh.util.concatenate([trimesh.Trimesh(*body, process=False) for body in bodies]).export(path)
    return path


def box(size, at=(0.0, 0.0, 0.0)):
    made = trimesh.creation.box(size)
    return np.array(made.vertices) + at, np.array(made.faces)


def volume(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return float(np.linalg.det(np.stack([a, b, c], axis=1)).sum() / 6)


@shared
@pytest.mark.parametrize(
    ("case", "part", "met"),
    [
        ("nearly_equal_corners", "nearly_equal_corners.stl", 2),
        ("nearly_equal_corners", "nearly_equal_corners_inside_out.stl", 2),
        ("strips", "strips.ply", 2),
        ("touching_bodies", "touching_bodies.stl", 8),
        ("touching_bodies", "touching_bodies_united.stl", 8),
    ],
)
def test_a_shared_case_is_met(tmp_path, case, part, met):
    inspection = vg.load(copy_case(CASES / "mesh" / f"{case}.yaml", tmp_path, part))
    assert not any("watertight" in note for note in inspection.part.notes)
    assert [c.status.value for c in vg.plan(inspection).characteristics] == ["met"] * met


@shared
def test_the_cells_of_a_board_are_not_measurable(tmp_path):
    inspection = vg.load(copy_case(CASES / "mesh" / "flat_cells.yaml", tmp_path))
    assert [entry.id for entry in inspection.part.not_measurable] == ["cell", "two"]
    assert all("no edge that an image shows" in entry.reason for entry in inspection.part.not_measurable)


@shared
@pytest.mark.parametrize(("name", "unit"), [("metres.stl", "m"), ("inches.stl", "inch")])
def test_the_unit_is_stated(name, unit):
    part = part_of(CASES / "mesh" / name, unit)
    np.testing.assert_allclose(np.ptp(part.mesh.bounds, axis=0), [70, 45, 36], atol=1e-4)
    assert not part.findings


@shared
def test_metres_taken_as_millimetres_are_questioned():
    (finding,) = part_of(CASES / "mesh" / "metres.stl").findings
    assert (finding.name, finding.refused) == ("part_size", False)
    assert "0.07 mm" in str(finding)
    assert "part.unit: m" in str(finding)


@pytest.mark.parametrize(("scale", "likely"), [(1e-3, "m"), (1 / 25.4 / 40, "inch"), (1.0, ""), (1e3, "um")])
def test_a_size_that_no_part_has(tmp_path, scale, likely):
    vertices, faces = box((20.0, 15.0, 10.0))
    found = part_of(written(tmp_path, (vertices * scale, faces))).findings
    assert [finding.name for finding in found] == (["part_size"] if likely else [])
    assert all(f"part.unit: {likely}" in str(finding) or likely == "inch" for finding in found)


@pytest.mark.parametrize("far", [0.0, 3000.0])
@pytest.mark.parametrize("gap", [1e-6, 2e-5])
def test_corners_that_differ_by_rounding_are_welded(tmp_path, gap, far):
    vertices, faces = box((40.0, 30.0, 20.0), (far, 0.0, 0.0))
    soup = vertices[faces].reshape(-1, 3) + np.random.default_rng(3).uniform(-gap, gap, (36, 3))
    mesh, notes = read_mesh(written(tmp_path, (soup, np.arange(36).reshape(-1, 3))))
    assert not any("watertight" in note for note in notes)
    assert len(mesh.triangles) == 12
    assert volume(mesh) == pytest.approx(24000, rel=1e-4)


def test_a_wide_gap_is_the_part_s_own(tmp_path):
    vertices, faces = box((40.0, 30.0, 20.0))
    soup = vertices[faces].reshape(-1, 3)
    soup[:3] += 0.05
    _, notes = read_mesh(written(tmp_path, (soup, np.arange(36).reshape(-1, 3))))
    assert any("not watertight" in note for note in notes)


@pytest.mark.parametrize("angle", [0.0, 0.3])
@pytest.mark.parametrize("shared_face", [False, True])
def test_bodies_that_touch_are_one(tmp_path, shared_face, angle):
    plate = box((40.0, 40.0, 5.0), (0, 0, 2.5))
    block = box((40.0, 40.0, 10.0) if shared_face else (10.0, 8.0, 10.0), (0, 0, 10.0))
    R = trimesh.transformations.rotation_matrix(angle, [1, 2, 3])[:3, :3]
    mesh, notes = read_mesh(written(tmp_path, *((vertices @ R.T, faces) for vertices, faces in (plate, block))))
    assert any("2 bodies touch and were united" in note for note in notes)
    assert volume(mesh) == pytest.approx(8000 + (16000 if shared_face else 800), rel=1e-4)
    seam = measurand_on_mesh(mesh, R @ [0, -4.0, 5.0], R @ [0, 4.0, 5.0]) if not shared_face else None
    if seam is not None:
        inward = [float((normals @ (R @ [0, 0, -1])).max()) for normals in (seam.start_normals, seam.end_normals)]
        assert max(inward) < 0.1, "no face of the seam looks into the plate"


def test_bodies_apart_stay_as_they_are(tmp_path):
    mesh, notes = read_mesh(written(tmp_path, box((10.0, 10.0, 10.0)), box((5.0, 5.0, 5.0), (20, 0, 0))))
    assert len(mesh.triangles) == 24
    assert not any("united" in note for note in notes)


def test_inside_out_with_a_cavity(tmp_path):
    outer, (vertices, faces) = box((20.0, 20.0, 20.0)), box((4.0, 4.0, 4.0))
    inside_out = (outer[0], outer[1][:, ::-1]), (vertices, faces)
    assert volume(read_mesh(written(tmp_path, *inside_out))[0]) == pytest.approx(8000 - 64)


def test_a_point_within_a_face_or_on_an_open_border_is_no_edge(tmp_path):
    mesh, _ = read_mesh(written(tmp_path, box((20.0, 20.0, 20.0))))
    assert missing_edge(measurand_on_mesh(mesh, [-10, 0, 10], [10, 0, 10])) == ""
    assert "its end [0, 0, 10] mm lies within" in missing_edge(measurand_on_mesh(mesh, [-10, 0, 10], [0, 0, 10]))


STRIPS = """ply
format ascii 1.0
element vertex 8
property float x
property float y
property float z
element tristrips 1
property list int int vertex_indices
end_header
0 0 0\n9 0 0\n0 7 0\n9 7 0\n0 0 5\n9 0 5\n0 7 5\n9 7 5
21 0 4 1 5 3 7 2 6 0 4 -1 0 1 2 3 -1 4 6 5 7 -1
"""


@pytest.mark.parametrize("order", ["ascii", "<", ">"])
def test_triangle_strips(tmp_path, order):
    path, (header, _, body) = tmp_path / "s.ply", STRIPS.partition("end_header\n")
    if order == "ascii":
        path.write_text(STRIPS)
    else:
        numbers = np.array(body.split(), dtype=float)
        name = "little" if order == "<" else "big"
        head = f"{header.replace('ascii', f'binary_{name}_endian')}end_header\n".encode()
        path.write_bytes(
            head + numbers[:24].astype(f"{order}f4").tobytes() + numbers[24:].astype(f"{order}i4").tobytes()
        )
    mesh, notes = read_mesh(path)
    assert len(mesh.triangles) == 12
    assert volume(mesh) == pytest.approx(9 * 7 * 5)
    assert not any("watertight" in note for note in notes)


MODEL = """<?xml version="1.0"?>
<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>
<object id="1" type="model"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object>
<object id="2" type="model"><components>
<component objectid="1" transform="1 0 0 0 1 0 0 0 1 4 0 0"/></components></object>
</resources><build><item objectid="1"/><item objectid="2" transform="1 0 0 0 1 0 0 0 1 0 8 0"/></build></model>
"""


@pytest.mark.parametrize(("unit", "stated", "mm"), [("millimeter", None, 1), ("inch", None, 25.4), ("inch", "cm", 10)])
def test_3mf(tmp_path, unit, stated, mm):
    vertices, faces = box((2.0, 2.0, 2.0))
    text = MODEL.format(
        unit=unit,
        vertices="".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in vertices),
        triangles="".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces),
    )
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
        archive.writestr("3D/3dmodel.model", text)
    mesh, notes = read_mesh(tmp_path / "a.3mf", stated)
    np.testing.assert_allclose(mesh.bounds, np.array([[-1, -1, -1], [5, 9, 1]]) * mm)
    assert len(notes) == (1 if stated else 0)


def test_glb_is_in_metres_and_keeps_its_places(tmp_path):
    scene = trimesh.Scene()
    T = trimesh.transformations.translation_matrix([0.05, 0, 0])
    scene.add_geometry(trimesh.creation.box((0.02, 0.03, 0.04)), transform=T)
    scene.export(tmp_path / "a.glb")
    mesh, notes = read_mesh(tmp_path / "a.glb")
    np.testing.assert_allclose(mesh.bounds, [[40, -15, -20], [60, 15, 20]], atol=1e-4)
    assert notes == ()


@pytest.mark.parametrize("content", [b"PK", b"garbage", b""])
def test_a_damaged_3mf_is_one_message(tmp_path, content):
    (tmp_path / "a.3mf").write_bytes(content)
    with pytest.raises(PartFileError):
        read_mesh(tmp_path / "a.3mf")
