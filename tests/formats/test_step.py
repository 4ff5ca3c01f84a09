"""Geometry and dimensions of STEP files through the CAD kernel, from the path to the part.

Small solids are made on the fly; the NIST test cases are read where they lie beside the checkout.
"""

import math
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from viewgauge.exceptions import PartFileError
from viewgauge.formats.step.kernel_process import read_step
from viewgauge.part.brep import Brep

pytest.importorskip("OCP", reason="the CAD kernel (OCP) is not installed")

NIST = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "nist"
SIZE, RADIUS, AXIS = np.array([40.0, 30.0, 20.0]), 6.0, (15.0, 12.0)


def block():
    """A block of 40 x 30 x 20 with a hole of radius 6 along z through (15, 12)."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    drill = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(*AXIS, -5.0), gp_Dir(0, 0, 1)), RADIUS, 30.0)
    return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(*SIZE).Shape(), drill.Shape()).Shape()


def write(shape, path: Path, unit: str = "MM", *, assembly: bool = False) -> Path:
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    Interface_Static.SetIVal_s("write.step.assembly", int(assembly))
    writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    writer.Write(str(path))
    return path


def moved(shape, x: float, y: float, z: float, *, turned: bool = False):
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    move, turn = gp_Trsf(), gp_Trsf()
    move.SetTranslation(gp_Vec(x, y, z))
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), math.pi / 2 if turned else 0.0)
    return shape.Moved(TopLoc_Location(move.Multiplied(turn)))


def compound(*shapes):
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    builder, whole = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(whole)
    for shape in shapes:
        builder.Add(whole, shape)
    return whole


def volume(brep: Brep) -> float:
    """Sum of the signed tetrahedra from a far point, mm^3."""
    a, b, c = (brep.mesh.vertices[brep.mesh.triangles[:, k]] - 1000.0 for k in range(3))
    return float(np.linalg.det(np.stack([a, b, c], axis=1)).sum() / 6.0)


def open_sides(brep: Brep) -> int:
    """Sides of triangles without exactly one partner that runs the other way."""
    sides = Counter(
        tuple(t[k] for k in pair) for t in brep.mesh.triangles.tolist() for pair in ((0, 1), (1, 2), (2, 0))
    )
    return sum(count != 1 or sides[b, a] != 1 for (a, b), count in sides.items())


def winding(points, brep: Brep):
    """Turns of the mesh around each point: 1 inside, 0 outside (van Oosterom and Strackee 1983, eq. 8)."""
    corners = brep.mesh.vertices[brep.mesh.triangles]
    turns = []
    for point in points:
        a, b, c = np.moveaxis(corners - point, 1, 0)
        x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        dots = (np.einsum("ij,ij->i", p, q) * r for p, q, r in ((a, b, z), (b, c, x), (c, a, y)))
        solid = np.arctan2(np.einsum("ij,ij->i", a, np.cross(b, c)), x * y * z + sum(dots))
        turns.append(solid.sum() / (2.0 * np.pi))
    return np.array(turns)


@pytest.fixture(scope="module", params=["MM", "INCH"])
def part(request, tmp_path_factory) -> Brep:
    path = tmp_path_factory.mktemp("step") / "block.step"
    return read_step(write(block(), path, request.param), chord_error_mm=0.02)


def test_unit_is_named_and_everything_is_mm(part, request):
    unit = request.node.callspec.params["part"]
    assert part.length_unit == {"MM": "mm", "INCH": "inch"}[unit]
    np.testing.assert_allclose(part.mesh.bounds, [np.zeros(3), SIZE], atol=1e-6)


def test_counts(part):
    assert Counter(face.kind for face in part.faces) == {"plane": 6, "cylinder": 1}
    assert Counter(edge.kind for edge in part.edges) == {"line": 13, "circle": 2}
    assert [edge.kind for edge in part.edges if edge.seam] == ["line"]
    assert sum(edge.closed for edge in part.edges) == 2
    assert all(len(edge.points) == 2 for edge in part.edges if edge.kind == "line")
    assert all(len(edge.faces) == (1 if edge.seam else 2) for edge in part.edges)
    assert not any(edge.smooth and not edge.seam for edge in part.edges)
    for index, face in enumerate(part.faces):
        assert set(face.edges) == {k for k, edge in enumerate(part.edges) if index in edge.faces}


def test_free_form_planes_cylinders_lines_and_circles_are_recognised(tmp_path):
    from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert

    path = write(BRepBuilderAPI_NurbsConvert(block()).Shape(), tmp_path / "a.step")
    assert "PLANE(" not in path.read_text()
    brep = read_step(path, chord_error_mm=0.02)
    test_counts(brep)
    test_plane_normals_point_outwards(brep)
    (wall,) = (face for face in brep.faces if face.kind == "cylinder")
    assert wall.concave
    assert wall.radius_mm == pytest.approx(RADIUS, abs=1e-5)
    for edge in (edge for edge in brep.edges if edge.kind == "circle"):
        assert edge.radius_mm == pytest.approx(RADIUS, abs=1e-6)
        np.testing.assert_allclose(edge.centre[:2], AXIS, atol=1e-6)
        np.testing.assert_allclose(np.abs(edge.axis), [0, 0, 1], atol=1e-6)


def test_plane_normals_point_outwards(part):
    planes = [face for face in part.faces if face.kind == "plane"]
    for face in planes:
        assert np.abs(face.axis).max() == pytest.approx(1.0, abs=1e-12)
        assert (face.origin - SIZE / 2) @ face.axis == pytest.approx(SIZE @ np.abs(face.axis) / 2, abs=1e-9)
        assert not face.concave
    assert len({tuple(np.round(face.axis)) for face in planes}) == 6


def test_the_hole_is_concave_and_its_wall_faces_its_axis(part):
    (wall,) = (face for face in part.faces if face.kind == "cylinder")
    assert wall.concave
    assert wall.radius_mm == pytest.approx(RADIUS, abs=1e-9)
    np.testing.assert_allclose(np.abs(wall.axis), [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(wall.origin[:2], AXIS, atol=1e-9)
    index = part.faces.index(wall)
    for edge in (edge for edge in part.edges if edge.kind == "circle"):
        radial = (edge.points - edge.centre) / RADIUS
        np.testing.assert_allclose(edge.normals[:, edge.faces.index(index)], -radial, atol=1e-9)
        cap = edge.normals[:, 1 - edge.faces.index(index)]
        np.testing.assert_allclose(cap, np.tile([0, 0, 1 if edge.centre[2] > 10 else -1], (len(cap), 1)), atol=1e-12)


def test_circles_are_sampled_on_the_curve_within_the_chord_error(part):
    for edge in (edge for edge in part.edges if edge.kind == "circle"):
        np.testing.assert_allclose(np.linalg.norm(edge.points - edge.centre, axis=1), RADIUS, atol=1e-9)
        np.testing.assert_allclose(edge.centre, [*AXIS, round(edge.centre[2] / 20) * 20], atol=1e-9)
        assert edge.radius_mm == pytest.approx(RADIUS, abs=1e-9)
        np.testing.assert_allclose(edge.points[0], edge.points[-1], atol=1e-9)
        middle = (edge.points[1:] + edge.points[:-1]) / 2 - edge.centre
        assert RADIUS - np.linalg.norm(middle, axis=1).min() <= 0.02


def test_the_mesh_is_watertight_and_encloses_the_volume(part):
    assert part.mesh.chord_error_mm == 0.02
    assert open_sides(part) == 0
    exact = SIZE.prod() - math.pi * RADIUS**2 * SIZE[2]
    wall = 2 * math.pi * RADIUS * SIZE[2]
    assert 0 < volume(part) - exact < 0.02 * wall  # chords of a hole lie in the hole
    assert part.notes == ("The file has no semantic PMI: geometry only.",)


def test_the_chord_error_follows_the_size(tmp_path):
    assert read_step(write(block(), tmp_path / "a.step")).mesh.chord_error_mm == pytest.approx(
        2e-4 * np.linalg.norm(SIZE), rel=1e-3
    )


def test_an_assembly_is_read_in_the_frame_of_its_root(tmp_path):
    one = block()
    path = write(compound(moved(one, 100, 0, 0, turned=True), moved(one, 0, 0, 50)), tmp_path / "a.step", assembly=True)
    assert "NEXT_ASSEMBLY_USAGE_OCCURRENCE" in path.read_text()
    brep = read_step(path, chord_error_mm=0.02)
    assert len(brep.faces) == 14
    np.testing.assert_allclose(brep.mesh.bounds, [[0, 0, 0], [100, 40, 70]], atol=1e-6)
    points = np.concatenate([edge.points for edge in brep.edges])
    np.testing.assert_allclose([points.min(axis=0), points.max(axis=0)], [[0, 0, 0], [100, 40, 70]], atol=1e-6)
    walls = sorted(tuple(np.round(face.origin[:2], 6)) for face in brep.faces if face.kind == "cylinder")
    assert walls == [(15.0, 12.0), (88.0, 15.0)]
    assert open_sides(brep) == 0
    _assert_outward(brep, 0.5)


def test_a_characteristic_in_an_assembly_finds_every_instance(tmp_path):
    one = block()
    path = write(compound(moved(one, 100, 0, 0), moved(one, 0, 0, 50)), tmp_path / "a.step", assembly=True)
    (wall,) = (number for number, point in _planes_and_walls(path.read_text()) if point is None)
    brep = read_step(_with_dimensions(path, {"hole": wall}))
    assert [r.kind for r in brep.pmi_records[0].first] == ["face", "face"]
    assert {brep.faces[r.index].kind for r in brep.pmi_records[0].first} == {"cylinder"}


def _planes_and_walls(text: str):
    """Number of each face record, with the location of its plane (None for a cylinder)."""
    records = dict(re.findall(r"#(\d+) = ([^;]*);", text))
    for number, body in records.items():
        if not body.startswith("ADVANCED_FACE"):
            continue
        surface = records[re.findall(r"#(\d+)", body)[-1]]
        placement = records[re.findall(r"#(\d+)", surface)[0]]
        location = records[re.findall(r"#(\d+)", placement)[0]]
        coordinates = np.array([float(x) for x in re.findall(r"-?\d+\.[\dE+-]*", location)])
        yield int(number), coordinates if surface.startswith("PLANE") else None


def _with_dimensions(path: Path, faces: dict[str, int]) -> Path:
    """Add one dimension per face record, without a value."""
    lines = []
    for k, (label, face) in enumerate(faces.items()):
        n = 900_000 + 10 * k
        lines.append(f"#{n}=SHAPE_ASPECT('','',#{n},.T.);#{n + 1}=DIMENSIONAL_SIZE(#{n},'{label}');")
        lines.append(f"#{n + 2}=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#{n},$,#{face});")
    pose_error, end = path.read_text().rsplit("ENDSEC;", 1)
    path.write_text(pose_error + "\n".join(lines) + "\nENDSEC;" + end)
    return path


def test_every_face_record_finds_its_face(tmp_path):
    path = write(block(), tmp_path / "a.step", "INCH")
    planes = dict(_planes_and_walls(path.read_text()))
    assert len(planes) == 7
    brep = read_step(_with_dimensions(path, {str(number): number for number in planes}))
    assert len(brep.pmi_records) == 7
    for pmi_record in brep.pmi_records:
        (reference,) = pmi_record.first
        face, point = brep.faces[reference.index], planes[int(pmi_record.label)]
        assert face.kind == ("cylinder" if point is None else "plane")
        if point is not None:
            assert (point * 25.4 - face.origin) @ face.axis == pytest.approx(0.0, abs=1e-6)
    assert len({pmi_record.first for pmi_record in brep.pmi_records}) == 7


def _assert_outward(brep: Brep, step: float) -> None:
    """Half way along every edge, a step between its normals leaves the part and the opposite step enters it."""
    middles, out = [], []
    for edge in brep.edges:
        if len(edge.faces) != 2:
            continue
        if edge.kind == "line":
            middles.append(edge.points.mean(axis=0))
            out.append(edge.normals.mean(axis=0).sum(axis=0))
        else:
            middles.append(edge.points[len(edge.points) // 2])
            out.append(edge.normals[len(edge.points) // 2].sum(axis=0))
    direction = np.array(out) / np.linalg.norm(out, axis=1, keepdims=True)
    np.testing.assert_allclose(winding(np.array(middles) + step * direction, brep), 0.0, atol=1e-3)
    np.testing.assert_allclose(winding(np.array(middles) - step * direction, brep), 1.0, atol=1e-3)


def test_round_faces_of_every_kind(tmp_path):
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone, BRepPrimAPI_MakeSphere, BRepPrimAPI_MakeTorus

    shapes = (
        BRepPrimAPI_MakeCone(10.0, 0.0, 20.0).Shape(),
        moved(BRepPrimAPI_MakeSphere(8.0).Shape(), 40, 0, 0),
        moved(BRepPrimAPI_MakeTorus(10.0, 3.0).Shape(), 80, 0, 0),
    )
    brep = read_step(write(compound(*shapes), tmp_path / "a.step"), chord_error_mm=0.01)
    assert Counter(face.kind for face in brep.faces) == {"cone": 1, "sphere": 1, "torus": 1, "plane": 1}
    assert not any(face.concave for face in brep.faces)
    assert open_sides(brep) == 0
    exact = math.pi * 100 * 20 / 3 + 4 / 3 * math.pi * 8**3 + 2 * math.pi**2 * 10 * 9
    assert volume(brep) == pytest.approx(exact, rel=4e-3)
    for edge in brep.edges:
        np.testing.assert_allclose(np.linalg.norm(edge.normals, axis=2), 1.0, atol=1e-9)


def test_rounded_edges_are_smooth(tmp_path):
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    box = BRepPrimAPI_MakeBox(*SIZE).Shape()
    fillet = BRepFilletAPI_MakeFillet(box)
    fillet.Add(2.0, TopoDS.Edge(TopExp_Explorer(box, TopAbs_ShapeEnum.TopAbs_EDGE).Current()))
    brep = read_step(write(fillet.Shape(), tmp_path / "a.step"))
    (round_face,) = (k for k, face in enumerate(brep.faces) if face.kind == "cylinder")
    assert not brep.faces[round_face].concave
    smooth = [edge for edge in brep.edges if edge.smooth]
    assert len(smooth) == 2
    assert all(edge.kind == "line" and round_face in edge.faces for edge in smooth)


def test_surfaces_without_a_solid_are_taken_with_a_note(tmp_path):
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    explorer = TopExp_Explorer(block(), TopAbs_ShapeEnum.TopAbs_FACE)
    brep = read_step(write(explorer.Current(), tmp_path / "a.step"))
    assert len(brep.faces) == 1
    assert "no solid" in brep.notes[0]
    assert any("not watertight" in note for note in brep.notes)


def test_a_file_without_geometry_is_refused(tmp_path):
    path = tmp_path / "empty.step"
    path.write_text(
        "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=DIRECTION('',(0.,0.,1.));\nENDSEC;\nEND-ISO-10303-21;\n"
    )
    with pytest.raises(PartFileError, match=r"no geometry|no solid"):
        read_step(path)


def test_a_coordinate_that_is_no_number_is_refused(tmp_path):
    path = write(block(), tmp_path / "a.step")
    text = re.sub(r"(CARTESIAN_POINT\('',\()40\.,", r"\1NaN,", path.read_text(), count=1)
    assert "NaN" in text
    path.write_text(text)
    with pytest.raises(PartFileError, match="no number"):
        read_step(path)


def test_too_little_memory_is_an_error_and_no_crash(tmp_path):
    path = write(block(), tmp_path / "a.step")
    with pytest.raises(PartFileError, match=r"more than 0\.293 GiB of memory"):
        read_step(path, memory_bytes=300 * 2**20)


# PLUS_MINUS_TOLERANCE and dimensions of each file as counted by the data's README; dimensions with a tolerance: those,
# and in case 1 two diameters with limits instead ("upper limit", "lower limit"); geometric tolerances.
CASES = {
    1: (6, {"distance": 2, "diameter": 9, "angle": 1}, 8, 6, "mm"),
    2: (7, {"diameter": 7}, 7, 22, "mm"),
    3: (8, {"distance": 1, "diameter": 8, "length": 1}, 8, 13, "mm, dimensions in inch"),
    4: (7, {"distance": 3, "diameter": 6, "angle": 1}, 7, 7, "mm"),
    5: (2, {"distance": 5, "diameter": 1}, 2, 10, "inch"),
}


@pytest.fixture(scope="module", params=CASES)
def case(request) -> tuple[int, Path, Brep]:
    found = sorted(NIST.glob(f"nist_ctc_0{request.param}_*.stp"))
    if not found:
        pytest.skip(f"the NIST test cases are not in {NIST}")
    return request.param, found[0], read_step(found[0])


def dimensions_of(brep: Brep):
    """The PMI records that are no geometric tolerances."""
    return [pmi_record for pmi_record in brep.pmi_records if pmi_record.indication.zone_mm is None]


def test_nist_characteristics_are_complete(case):
    number, _, brep = case
    plus_minus, kinds, toleranced, geometric, unit = CASES[number]
    assert brep.plus_minus_count == plus_minus
    dimensions = dimensions_of(brep)
    assert Counter(pmi_record.kind for pmi_record in dimensions) == kinds
    assert sum(pmi_record.tolerance_mm is not None for pmi_record in dimensions) == toleranced
    assert len(brep.pmi_records) - len(dimensions) == geometric
    assert Counter(r.kind for r in brep.pmi_records if r.indication.toleranced) == brep.pmi_counts
    assert sum(brep.pmi_counts.values()) == toleranced + geometric
    assert not brep.findings
    assert brep.length_unit == unit
    assert any("by limits" in note for note in brep.notes) == (toleranced > plus_minus)
    assert len({pmi_record.name for pmi_record in brep.pmi_records}) == len(brep.pmi_records)


def test_nist_geometry_is_watertight_and_outward(case):
    _, _, brep = case
    assert open_sides(brep) == 0
    assert volume(brep) > 0
    if len(brep.mesh.triangles) < 20_000:  # a sum over all triangles for every edge
        _assert_outward(brep, 0.3)


def test_nist_diameters_are_those_of_the_faces_they_refer_to(case):
    _, _, brep = case
    diameters = [c for c in brep.pmi_records if c.kind == "diameter" and c.first and not math.isnan(c.nominal_mm)]
    assert diameters
    for pmi_record in diameters:
        for reference in pmi_record.first:
            source = brep.faces if reference.kind == "face" else brep.edges
            assert 2 * source[reference.index].radius_mm == pytest.approx(pmi_record.nominal_mm, abs=1e-6)


def test_nist_distances_are_those_of_the_planes_they_refer_to(case):
    _, _, brep = case
    for pmi_record in brep.pmi_records:
        if (
            pmi_record.kind != "distance"
            or pmi_record.problem
            or {r.kind for r in pmi_record.first + pmi_record.second} != {"face"}
        ):
            continue
        one, other = (brep.faces[side[0].index] for side in (pmi_record.first, pmi_record.second))
        if one.kind == other.kind == "plane":
            assert abs(one.axis @ (one.origin - other.origin)) == pytest.approx(pmi_record.nominal_mm, abs=1e-6)


def test_nist_problems_are_said(case):
    number, _, brep = case
    for pmi_record in brep.pmi_records:
        understood = bool(pmi_record.first) and (pmi_record.kind != "distance" or bool(pmi_record.second))
        assert (understood and not math.isnan(pmi_record.nominal_mm)) or pmi_record.problem
    assert sum(bool(pmi_record.problem) for pmi_record in dimensions_of(brep)) == {1: 4, 2: 0, 3: 1, 4: 2, 5: 4}[number]


def test_nist_values_agree_with_the_kernels_own_reading(case):
    """XCAF reads most of the same values by other code, deviations without their sign."""
    _, path, brep = case
    own = {pmi_record.name: pmi_record for pmi_record in brep.pmi_records}
    compared = 0
    for name, value, lower, upper in _kernel_dimensions(path):
        pmi_record = own[name]
        scale = math.degrees(1.0) if pmi_record.kind == "angle" else 1.0
        assert pmi_record.nominal_mm * scale == pytest.approx(value, rel=1e-9)
        if (lower, upper) != (0.0, 0.0):
            assert pmi_record.tolerance_mm is not None
            assert [abs(x) * scale for x in pmi_record.tolerance_mm] == pytest.approx([lower, upper], abs=1e-9)
        compared += 1
    assert compared >= CASES[case[0]][0] - 1  # it drops a few


def _kernel_dimensions(path: Path):
    """Presentation name, value and absolute deviations of every dimension that XCAF gives a value."""
    from OCP.collections import Sequence_TDF_Label
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFApp import XCAFApp_Application
    from OCP.XCAFDoc import XCAFDoc_Dimension, XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    XCAFApp_Application.GetApplication_s().NewDocument(TCollection_ExtendedString("MDTV-XCAF"), document)
    reader = STEPCAFControl_Reader()
    reader.SetGDTMode(True)
    reader.ReadFile(str(path))
    reader.Transfer(document)
    labels = Sequence_TDF_Label()
    XCAFDoc_DocumentTool.DimTolTool_s(document.Main()).GetDimensionLabels(labels)
    for k in range(1, labels.Length() + 1):
        dimension = XCAFDoc_Dimension.Set_s(labels.Value(k)).GetObject()
        if dimension.GetValue() and dimension.GetPresentationName() and not dimension.IsDimWithRange():
            name = dimension.GetPresentationName().ToCString()
            yield name, dimension.GetValue(), dimension.GetLowerTolValue(), dimension.GetUpperTolValue()
