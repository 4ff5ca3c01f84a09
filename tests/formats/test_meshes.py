"""Meshes from files."""

import subprocess
import sys

import numpy as np
import pytest
import trimesh

from viewgauge.exceptions import PartFileError
from viewgauge.formats.mesh.meshes import read_mesh

SIZE = (10.0, 20.0, 30.0)
VOLUME_MM3 = 6000.0
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
"""


def block():
    return trimesh.creation.box(SIZE)


def saved(tmp_path, vertices, faces, name="part.stl"):
    path = tmp_path / name
    trimesh.Trimesh(vertices, faces, process=False).export(path)
    return path


def signed_volume(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return np.linalg.det(np.stack([a, b, c], axis=1)).sum() / 6


@pytest.mark.parametrize("name", ["b.stl", "b.ply", "b.obj", "B.STL"])
def test_a_block(tmp_path, name):
    path = tmp_path / name
    block().export(path, file_type=name[-3:].lower())
    mesh, notes = read_mesh(path)
    assert mesh.vertices.shape == (8, 3)  # merged: an STL file repeats each
    assert mesh.triangles.shape == (12, 3)
    assert mesh.triangles.dtype == np.int64
    np.testing.assert_array_equal(mesh.bounds, [[-5, -10, -15], [5, 10, 15]])
    assert signed_volume(mesh) == pytest.approx(VOLUME_MM3)
    assert notes == ("a mesh file names no unit: its coordinates are taken as mm",)


def test_ascii_stl(tmp_path):
    path = tmp_path / "b.stl"
    path.write_text(trimesh.exchange.stl.export_stl_ascii(block()))
    assert read_mesh(path)[0].triangles.shape == (12, 3)


def test_an_inside_out_mesh_is_turned(tmp_path):
    faces = block().faces[:, ::-1]
    mesh, notes = read_mesh(saved(tmp_path, block().vertices, faces))
    assert signed_volume(mesh) == pytest.approx(VOLUME_MM3)
    assert "12 of 12 triangles faced inward" in notes[1]


@pytest.mark.parametrize("seed", range(5))
def test_randomly_turned_triangles_are_made_consistent(tmp_path, seed):
    rng = np.random.default_rng(seed)
    sphere = trimesh.creation.icosphere(2, 10)
    faces = np.array(sphere.faces)
    turned = rng.random(len(faces)) < 0.5
    faces[turned] = faces[turned][:, ::-1]
    mesh, _ = read_mesh(saved(tmp_path, sphere.vertices, faces))
    centres = mesh.vertices[mesh.triangles].mean(axis=1)
    assert (np.einsum("ij,ij->i", mesh.normals, centres) > 0).all()


def test_a_cavity_keeps_its_side_and_a_neighbour_is_turned(tmp_path):
    outer, cavity, neighbour = block(), trimesh.creation.box((2, 2, 2)), trimesh.creation.box((3, 3, 3))
    neighbour.apply_translation([20, 0, 0])
    cavity.invert()
    neighbour.invert()
    joined = trimesh.util.concatenate([outer, cavity, neighbour])
    mesh, _ = read_mesh(saved(tmp_path, joined.vertices, joined.faces))
    assert signed_volume(mesh) == pytest.approx(VOLUME_MM3 - 8 + 27)


def test_an_open_mesh_says_so(tmp_path):
    mesh, notes = read_mesh(saved(tmp_path, block().vertices, block().faces[1:]))
    assert len(mesh.triangles) == 11
    assert any("not watertight: facing tests may be wrong" in note for note in notes)


def test_triangles_without_area_are_dropped(tmp_path):
    vertices = np.vstack([block().vertices, [[0, 0, 0], [1, 1, 1], [2, 2, 2]]])
    faces = np.vstack([block().faces, [[0, 0, 1], [8, 9, 10]]])
    mesh, notes = read_mesh(saved(tmp_path, vertices, faces, "b.ply"))
    assert mesh.triangles.shape == (12, 3)
    assert mesh.vertices.shape == (8, 3)
    assert any("2 of 14 triangles have no area" in note for note in notes)


def test_materials_are_not_looked_for(tmp_path):
    path = tmp_path / "b.obj"
    (tmp_path / "secret.mtl").write_text("newmtl a\nmap_Kd none.png\n")
    path.write_text(
        "mtllib secret.mtl\nmtllib http://localhost:9/x.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\n"
        "usemtl a\nf 1/1 2/1 3/1 4/1\nusemtl b\nf 1/1 3/1 2/1\n"
    )
    mesh, _ = read_mesh(path)
    assert len(mesh.triangles) == 3  # a quadrangle and a triangle, of two materials


@pytest.mark.parametrize(
    ("name", "content", "telling"),
    [
        ("a.stl", b"", "the file is empty"),
        ("a.stl", b"garbage", "no triangles"),
        ("a.stl", b"solid a\nendsolid a\n", "no triangles"),
        ("a.stl", b"\0" * 80 + (2).to_bytes(4, "little") + b"\0" * 60, "is complete"),
        ("a.stl", bytes(range(256)) * 3, "a.stl"),
        ("a.ply", b"garbage", "cannot be read as PLY"),
        ("a.ply", PLY.encode() + b"0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n", "not finite"),
        ("a.ply", PLY.encode() + b"0 0 inf\n1 0 0\n0 1 0\n3 0 1 2\n", "not finite"),
        ("a.ply", PLY.encode() + b"0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "a vertex that is not there"),
        ("a.ply", PLY.replace("face 1", "face 0").encode() + b"0 0 0\n1 0 0\n0 1 0\n", "no triangles"),
        (
            "a.ply",
            PLY.replace("ascii", "binary_little_endian").replace("vertex 3", "vertex 9999999999").encode(),
            "PLY",
        ),
        ("a.obj", b"v 0 0 0\nv 1 1 1\nf 1 2 9\n", "cannot be read as OBJ"),
        ("a.obj", b"v 0 0 0\nv 1 1 x\nv 1 0 0\nf 1 2 3\n", "cannot be read as OBJ"),
        ("a.obj", b"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "no extent"),
        ("a.obj", b"v 1 1 1\nv 2 2 2\nv 3 3 3\nf 1 2 3\n", "without area"),
        ("a.gltf", b"{}", "not a mesh file by its name"),
        ("part", b"x", "not a mesh file by its name"),
    ],
)
def test_bad_files(tmp_path, name, content, telling):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(PartFileError) as caught:
        read_mesh(path)
    assert caught.value.file == str(path)
    assert telling in str(caught.value)


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(PartFileError, match="No such file"):
        read_mesh(tmp_path / "none.stl")
    (tmp_path / "folder.stl").mkdir()
    with pytest.raises(PartFileError, match="a folder"):
        read_mesh(tmp_path / "folder.stl")


def test_works_without_the_cad_kernel(tmp_path):
    block().export(tmp_path / "b.stl")
    code = (
        "import sys; sys.modules['OCP'] = None\n"
        "from viewgauge.formats.mesh.meshes import read_mesh\n"
        "assert 'trimesh' not in sys.modules\n"
        f"assert len(read_mesh({str(tmp_path / 'b.stl')!r})[0].triangles) == 12\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_slightly_damaged_file_prints_nothing(tmp_path):
    text = trimesh.exchange.stl.export_stl_ascii(block())
    (tmp_path / "b.stl").write_text(text.replace("normal -1.0", "normal -1.x", 1))
    code = (
        "from viewgauge.formats.mesh.meshes import read_mesh\n"
        f"assert len(read_mesh({str(tmp_path / 'b.stl')!r})[0].triangles) == 12  # the stored normals are not used\n"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stderr == ""
