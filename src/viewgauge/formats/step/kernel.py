"""A STEP file's geometry and dimensions by the CAD kernel.

The only module that imports OCP (Open CASCADE), and the only one that a broken file can crash: it is imported
by :mod:`.step_child` alone, in a process of its own.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_SurfaceType
from OCP.gp import gp_Cylinder, gp_Pln, gp_Pnt, gp_Vec
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.ShapeAnalysis import ShapeAnalysis_CanonicalRecognition
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

from ...exceptions import PartFileError
from ...part.brep import Brep, Edge, Face, Reference
from ...part.mesh import Mesh
from ..mesh.watertight import is_watertight
from .curve_points import arc_parameters, circle_through, is_straight, refined_parameters
from .pmi import count_toleranced, drawn_annotations, pmi_findings, pmi_notes, pmi_sources, to_pmi_records
from .source.coordinates import LARGEST_PART_MM, refuse_far_points
from .source.external_files import external_files, refuse_without_geometry
from .source.step_source import read_source
from .source.tessellation import has_surfaces, tessellated_bodies, tessellated_brep
from .step_text import StepText, not_a_number
from .step_units import Units
from .triangle_weld import Weld, signed_volume

__all__ = ["read_part"]

_ANGULAR_DEFLECTION_RAD = 0.35
_SMOOTH_COSINE = np.cos(0.01)  # tangent within CAD tolerances
_SAME_SHAPE_MM = 1e-4  # a free-form curve or surface this close to a simple one is taken as that
_SURFACES: dict[Any, FaceKind] = {
    GeomAbs_SurfaceType.GeomAbs_Plane: "plane",
    GeomAbs_SurfaceType.GeomAbs_Cylinder: "cylinder",
    GeomAbs_SurfaceType.GeomAbs_Cone: "cone",
    GeomAbs_SurfaceType.GeomAbs_Sphere: "sphere",
    GeomAbs_SurfaceType.GeomAbs_Torus: "torus",
}
_ROUND = ("cylinder", "cone", "sphere", "torus")
_CURVES = (
    "GEOMETRIC_CURVE_SET",
    "EDGE_BASED_WIREFRAME_MODEL",
    "SHELL_BASED_WIREFRAME_MODEL",
    "BLOCK",
    "RIGHT_CIRCULAR_CYLINDER",
    "SPHERE",
)

Vectors = NDArray[np.float64]
CurveKind = Literal["line", "circle", "other"]
FaceKind = Literal["plane", "cylinder", "cone", "sphere", "torus", "other"]


def read_part(path: Path, *, chord_error_mm: float | None, with_pmi: bool, folder: Path) -> Brep:
    """Read a STEP file.

    Parameters
    ----------
    path
        The file.
    chord_error_mm
        Largest distance of mesh and edge points from the true surface, mm; None: 2e-4 of the part's diagonal,
        from 0.01 to 0.1 mm.
    with_pmi
        Find the faces that the PMI refers to; without it every characteristic is read and none is measurable.
    folder
        Existing folder for a copy of the file in the form that the kernel reads, where it needs one.

    Raises
    ------
    PartFileError
        If the kernel cannot read the file or there is no geometry in it.
    """
    source = read_source(path, folder)
    bad = not_a_number(source.text)
    if bad is not None:
        raise PartFileError("a point has a coordinate that is no number", got=bad, expected="finite coordinates")
    text = StepText.scan(source.text)
    units = Units(text)
    refuse_far_points(source.text, units.geometry_factor())
    name = _product_name(text) or path.stem
    if not has_surfaces(text):
        if tessellated_bodies(text):
            return tessellated_brep(text, name, units.geometry_factor(), units.summary())
        if not text.numbers(*_CURVES):
            refuse_without_geometry(text, source.text)
    reader = STEPControl_Reader()
    Interface_Static.SetIVal_s("read.step.tessellated", 0)  # they are read from the text
    if reader.ReadFile(str(source.kernel_path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise PartFileError("the CAD kernel cannot read the file: it is damaged or no valid STEP")
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape is None or shape.IsNull():
        raise PartFileError("the file holds no geometry", expected="a solid part")
    notes: list[str] = []
    roots = _roots(shape, notes)
    diagonal = _diagonal(roots)
    chord_error = chord_error_mm or float(np.clip(2e-4 * diagonal, 0.01, 0.1))
    topology = _Topology(roots, chord_error)
    mesh, sign = topology.mesh(notes)
    faces, edges = topology.faces(sign), topology.edges(sign, notes)
    notes += _not_read(text, source.text)
    brep = Brep(name, units.summary(), faces, edges, mesh, (), solids=_count(roots, TopAbs_ShapeEnum.TopAbs_SOLID))
    sources, counts = pmi_sources(text), count_toleranced(source.text)
    wanted = {number for s in sources for number in (*s.first, *s.second)} if with_pmi else ()
    shapes = topology.references(reader, text, wanted, source.kernel_numbers) if wanted else {}
    pmi_records = to_pmi_records(sources, shapes, faces, edges)
    if not with_pmi:
        lost = "the CAD kernel crashed when it was asked for the faces that it refers to"
        pmi_records = tuple(r if r.indication.zone_mm is not None else replace(r, problem=lost) for r in pmi_records)
    notes += pmi_notes(text, pmi_records)
    return _noted(
        brep,
        notes,
        pmi_records=pmi_records,
        plus_minus_count=len(text.numbers("PLUS_MINUS_TOLERANCE")),
        pmi_counts=counts,
        findings=pmi_findings(pmi_records, counts, faces, drawn_annotations(text)),
    )


def _noted(brep: Brep, notes: Sequence[str], **changes: Any) -> Brep:
    return replace(brep, notes=tuple(notes), **changes)


def _product_name(text: StepText) -> str:
    words = [word for _, product in text.parts("PRODUCT") for word in product.parameters[1::-1]]
    return next((" ".join(word.split()) for word in words if isinstance(word, str) and word.strip()), "")


def _roots(shape: Any, notes: list[str]) -> list[Any]:
    """The solids of a shape, or its shells, or its faces."""
    for kind, note in (
        (TopAbs_ShapeEnum.TopAbs_SOLID, ""),
        (TopAbs_ShapeEnum.TopAbs_SHELL, "The file holds no solid but surfaces; they are taken as they are."),
        (TopAbs_ShapeEnum.TopAbs_FACE, "The file holds no solid but single faces; they are taken as they are."),
    ):
        roots = list(_shapes(shape, kind))
        if roots:
            notes += [note] if note else []
            return roots
    raise PartFileError("the file holds no solid, shell or face", expected="a solid part")


def _shapes(shape: Any, kind: TopAbs_ShapeEnum) -> Iterator[Any]:
    found = ShapeMap()
    TopExp.MapShapes_s(shape, kind, found)
    return (found.FindKey(index) for index in range(1, found.Extent() + 1))


def _count(roots: Iterable[Any], kind: TopAbs_ShapeEnum) -> int:
    return sum(root.ShapeType() == kind for root in roots)


def _not_read(text: StepText, source: str) -> list[str]:
    """Notes on geometry that the file names beside its B-rep, and that is not used."""
    notes = []
    tessellated = len(tessellated_bodies(text))
    if tessellated:
        notes.append(f"Tessellated bodies beside the B-rep geometry: {tessellated}; they are not used.")
    files = external_files(text, source)
    if files:
        notes.append(f"Geometry in other files is not read and hides nothing: {', '.join(files[:20])}.")
    return notes


def _diagonal(roots: Iterable[Any]) -> float:
    """Diagonal of the roots' box, mm."""
    box = Bnd_Box()
    for root in roots:
        BRepBndLib.Add_s(root, box)
    if box.IsVoid():
        raise PartFileError("the file holds no geometry", expected="a solid part")
    diagonal = float(np.sqrt(box.SquareExtent()))
    if not diagonal <= LARGEST_PART_MM:
        got, expected = f"a diagonal of {diagonal:.4g} mm", f"at most {LARGEST_PART_MM:.0e} mm"
        raise PartFileError("the part is larger than any part", got=got, expected=expected, hint="check its unit")
    return diagonal


class _Topology:
    """Faces and edges of the roots, numbered, with everything measured on them."""

    def __init__(self, roots: Sequence[Any], chord_error_mm: float) -> None:
        self.roots = roots
        self.chord_error_mm = chord_error_mm
        self.face_map, self.edge_map, self.vertex_map = ShapeMap(), ShapeMap(), ShapeMap()
        for root in roots:
            TopExp.MapShapes_s(root, TopAbs_ShapeEnum.TopAbs_FACE, self.face_map)
            TopExp.MapShapes_s(root, TopAbs_ShapeEnum.TopAbs_EDGE, self.edge_map)
            TopExp.MapShapes_s(root, TopAbs_ShapeEnum.TopAbs_VERTEX, self.vertex_map)
        self.face_shapes = [TopoDS.Face(self.face_map.FindKey(k + 1)) for k in range(self.face_map.Extent())]
        self.surfaces = [BRepAdaptor_Surface(face) for face in self.face_shapes]

    @cached_property
    def edge_shapes(self) -> list[Any]:
        """Edges that have a curve (no degenerate ones)."""
        shapes = (TopoDS.Edge(self.edge_map.FindKey(k + 1)) for k in range(self.edge_map.Extent()))
        return [edge for edge in shapes if not BRep_Tool.Degenerated_s(edge)]

    @cached_property
    def edge_index(self) -> dict[int, int]:
        """Index of an edge by its number in the edge map."""
        return {self.edge_map.FindIndex(edge): index for index, edge in enumerate(self.edge_shapes)}

    @cached_property
    def edges_of_face(self) -> list[tuple[int, ...]]:
        """Indices of the edges of every face."""
        found = []
        for face in self.face_shapes:
            numbers = (self.edge_map.FindIndex(edge) for edge in _shapes(face, TopAbs_ShapeEnum.TopAbs_EDGE))
            found.append(tuple(self.edge_index[number] for number in numbers if number in self.edge_index))
        return found

    @cached_property
    def instances(self) -> list[int]:
        """Which instance of a part in an assembly each face belongs to: faces placed alike are of one instance."""
        places: list[Any] = []
        found = []
        for face in self.face_shapes:
            place = face.Location()
            number = next((k for k, known in enumerate(places) if known.IsEqual(place)), len(places))
            if number == len(places):
                places.append(place)
            found.append(number)
        return found

    def mesh(self, notes: list[str]) -> tuple[Mesh, float]:
        """The mesh, and -1 where the file's solids are inside out (the mesh is turned right), else 1."""
        weld = Weld()
        for root in self.roots:
            BRepMesh_IncrementalMesh(root, self.chord_error_mm, False, _ANGULAR_DEFLECTION_RAD)
        bare = sum(not self._add_triangles(weld, face) for face in self.face_shapes)
        if bare:
            notes.append(f"{bare} faces could not be meshed and hide nothing.")
        vertices, triangles = weld.triangles()
        if len(triangles) == 0:
            raise PartFileError("no face of the part could be meshed", expected="a solid part")
        closed = is_watertight(triangles, oriented=True)
        if not closed:
            notes.append("The mesh is not watertight: the part's surface has gaps.")
        sign = -1.0 if closed and signed_volume(vertices, triangles) < 0 else 1.0
        return Mesh(vertices, triangles if sign > 0 else triangles[:, ::-1], self.chord_error_mm), sign

    def _add_triangles(self, weld: Weld, face: Any) -> bool:
        location = TopLoc_Location()
        triangulation = BRep_Tool.Triangulation_s(face, location)
        if triangulation is None:
            return False
        move = location.Transformation()
        nodes = (triangulation.Node(k + 1).Transformed(move) for k in range(triangulation.NbNodes()))
        vertices = np.array([(node.X(), node.Y(), node.Z()) for node in nodes])
        corners = (triangulation.Triangle(k + 1) for k in range(triangulation.NbTriangles()))
        triangles = np.array([[t.Value(1), t.Value(2), t.Value(3)] for t in corners], dtype=np.int64).reshape(-1, 3) - 1
        if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
            triangles = triangles[:, ::-1]
        weld.add(vertices, triangles, self._keys(face, triangulation, location))
        return True

    def _keys(self, face: Any, triangulation: Any, location: Any) -> list[tuple[int, int] | None]:
        """What each node of a face's triangulation is: (0, vertex), (edge, k-th point), or inside the face."""
        keys: list[tuple[int, int] | None] = [None] * triangulation.NbNodes()
        explorer = TopExp_Explorer(face, TopAbs_ShapeEnum.TopAbs_EDGE)
        while explorer.More():
            edge = TopoDS.Edge(explorer.Current())
            explorer.Next()
            polygon = BRep_Tool.PolygonOnTriangulation_s(edge, triangulation, location)
            if polygon is None:
                continue
            number, last = self.edge_map.FindIndex(edge), polygon.NbNodes()
            first_vertex = (0, self.vertex_map.FindIndex(TopExp.FirstVertex_s(edge, False)))
            last_vertex = (0, self.vertex_map.FindIndex(TopExp.LastVertex_s(edge, False)))
            collapsed = BRep_Tool.Degenerated_s(edge)
            for k in range(1, last + 1):
                end = first_vertex if k == 1 or collapsed else last_vertex if k == last else None
                keys[polygon.Node(k) - 1] = end or (number, k)
        return keys

    def faces(self, sign: float) -> tuple[Face, ...]:
        """All faces."""
        return tuple(self._face(index, sign) for index in range(len(self.face_shapes)))

    def _face(self, index: int, sign: float) -> Face:
        surface = self.surfaces[index]
        kind, simple = _recognised(self.face_shapes[index], surface)
        u = 0.5 * (surface.FirstUParameter() + surface.LastUParameter())
        v = 0.5 * (surface.FirstVParameter() + surface.LastVParameter())
        point, normal = self._normal(index, u, v, sign)
        origin, axis, radius, centre = _frame(simple, kind, point)
        if kind == "plane":
            axis = normal
        concave = kind in _ROUND and float(normal @ (point - centre)) < 0
        return Face(kind, origin, axis, radius, concave, self.edges_of_face[index], self.instances[index])

    def _normal(self, index: int, u: float, v: float, sign: float) -> tuple[Vectors, Vectors]:
        """Point and outward unit normal (zero where the surface has none) of a face."""
        point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
        self.surfaces[index].D1(u, v, point, along_u, along_v)
        cross = along_u.Crossed(along_v)
        normal = np.array([cross.X(), cross.Y(), cross.Z()])
        size = float(np.linalg.norm(normal))
        if self.face_shapes[index].Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
            sign = -sign
        limit = 1e-9 * max(along_u.Magnitude() * along_v.Magnitude(), 1e-9)
        return _array(point), normal * (sign / size) if size > limit else np.zeros(3)

    def edges(self, sign: float, notes: list[str]) -> tuple[Edge, ...]:
        """All edges."""
        owners: dict[int, list[int]] = defaultdict(list)
        for face, edges in enumerate(self.edges_of_face):
            for edge in edges:
                owners[edge].append(face)
        crowded = sum(len(faces) > 2 for faces in owners.values())
        if crowded:
            notes.append(f"{crowded} edges join more than two faces; two of them are kept.")
        return tuple(self._edge(index, tuple(owners[index][:2]), sign) for index in range(len(self.edge_shapes)))

    def _edge(self, index: int, faces: tuple[int, ...], sign: float) -> Edge:
        shape = self.edge_shapes[index]
        curve = BRepAdaptor_Curve(shape)
        kind, parameters, centre, axis, radius = _sampled(curve, self.chord_error_mm)
        points = np.array([_array(curve.Value(float(u))) for u in parameters])
        normals = np.stack([self._normals_along(shape, face, parameters, sign) for face in faces], axis=1)
        seam = len(faces) == 1 and BRep_Tool.IsClosed_s(shape, self.face_shapes[faces[0]])
        cosines = np.einsum("ij,ij->i", normals[:, 0], normals[:, -1])
        smooth = seam or (len(faces) == 2 and bool(np.all(cosines > _SMOOTH_COSINE)))
        closed = TopExp.FirstVertex_s(shape).IsSame(TopExp.LastVertex_s(shape))
        instance = self.instances[faces[0]]
        return Edge(kind, points, faces, normals, centre, axis, radius, closed, seam, smooth, instance)

    def _normals_along(self, edge: Any, face: int, parameters: Vectors, sign: float) -> Vectors:
        """Outward unit normals of a face at points of its edge, ``(n, 3)``."""
        if _SURFACES.get(self.surfaces[face].GetType()) == "plane":
            return np.tile(self._normal(face, 0.0, 0.0, sign)[1], (len(parameters), 1))
        trace = BRepAdaptor_Curve2d(edge, self.face_shapes[face])
        normals = []
        for u in parameters:
            place = trace.Value(float(u))
            normals.append(self._normal(face, place.X(), place.Y(), sign)[1])
        return _without_gaps(np.array(normals))

    def references(
        self, reader: Any, text: StepText, wanted: Collection[int], kernel_numbers: Mapping[int, int]
    ) -> dict[int, list[Reference]]:
        """Faces and edges by the number of the record that they came from.

        The kernel answers only in the direction from shape to entity, and looks entities up by address; so the
        wanted records are found in its model by their label, and every face (and edge, if any is wanted) is
        asked for its entity.
        """
        model = reader.StepModel()
        entities = [
            (model.Value(rank), number) for number in wanted if (rank := _rank(model, text, number, kernel_numbers))
        ]
        number_of = {id(entity): number for entity, number in entities}
        names = {entity.DynamicType().Name() for entity, _ in entities}
        transfer = reader.WS().TransferReader()
        found: dict[int, list[Reference]] = defaultdict(list)
        kinds: list[tuple[Literal["face", "edge"], list[Any]]] = []
        if names - {"StepShape_EdgeCurve"}:
            kinds.append(("face", self.face_shapes))
        if "StepShape_EdgeCurve" in names:
            kinds.append(("edge", self.edge_shapes))
        for kind, shapes in kinds:
            for index, shape in enumerate(shapes):
                entity = transfer.EntityFromShapeResult(shape, -1)
                number = number_of.get(id(entity))
                if number is not None:
                    found[number].append(Reference(kind, index))
        return found


def _rank(model: Any, text: StepText, number: int, kernel_numbers: Mapping[int, int]) -> int:
    """Rank of a record in the kernel's model, 0 where it is not there; normally its position in the file."""
    position, label = text.positions.get(number, 1), f"#{kernel_numbers.get(number, number)}"
    return int(model.NextNumberForLabel(label, position - 1, True)) or int(model.NextNumberForLabel(label, 0, True))


def _array(point: Any) -> Vectors:
    return np.array([point.X(), point.Y(), point.Z()], dtype=np.float64)


def _recognised(face: Any, surface: Any) -> tuple[FaceKind, Any]:
    """Kind and simple surface of a face, free-form planes and cylinders as such; None where it has no simple one."""
    kind = _SURFACES.get(surface.GetType())
    if kind is not None:
        return kind, getattr(surface, kind.capitalize())()
    recognition, plane, cylinder = ShapeAnalysis_CanonicalRecognition(face), gp_Pln(), gp_Cylinder()
    if recognition.IsPlane(_SAME_SHAPE_MM, plane):
        return "plane", plane
    if recognition.IsCylinder(_SAME_SHAPE_MM, cylinder):
        return "cylinder", cylinder
    return "other", None


def _frame(simple: Any, kind: FaceKind, point: Vectors) -> tuple[Vectors, Vectors, float, Vectors]:
    """Origin, axis and radius of a surface, and the centre that its curvature turns around at a point."""
    if kind == "plane":
        return point, np.zeros(3), np.nan, point
    if kind == "other":
        return np.zeros(3), np.zeros(3), np.nan, point
    origin = _array(simple.Location())
    if kind == "sphere":
        return origin, _array(simple.Position().Direction()), float(simple.Radius()), origin
    axis = _array(simple.Axis().Direction())
    foot = origin + axis * float(axis @ (point - origin))
    if kind == "torus":
        radial = point - foot
        centre = origin + radial * (simple.MajorRadius() / max(float(np.linalg.norm(radial)), 1e-12))
        return origin, axis, np.nan, centre
    return origin, axis, float(simple.Radius()) if kind == "cylinder" else np.nan, foot


def _sampled(
    curve: Any, chord_error_mm: float
) -> tuple[Literal["line", "circle", "other"], Vectors, Vectors, Vectors, float]:
    """Kind, parameters of the points, centre, axis and radius of a curve; free-form lines and circles as such."""
    start, stop = curve.FirstParameter(), curve.LastParameter()
    if curve.GetType() == GeomAbs_CurveType.GeomAbs_Line:
        return "line", np.array([start, stop]), np.zeros(3), np.zeros(3), np.nan
    if curve.GetType() == GeomAbs_CurveType.GeomAbs_Circle:
        circle = curve.Circle()
        radius = float(circle.Radius())
        parameters = arc_parameters(start, stop, radius, chord_error_mm)
        return "circle", parameters, _array(circle.Location()), _array(circle.Axis().Direction()), radius

    def point(u: float) -> tuple[float, float, float]:
        place = curve.Value(u)
        return place.X(), place.Y(), place.Z()

    parameters = refined_parameters(point, start, stop, chord_error_mm)
    points = np.array([point(float(u)) for u in parameters])
    if is_straight(points, _SAME_SHAPE_MM):
        return "line", np.array([start, stop]), np.zeros(3), np.zeros(3), np.nan
    found = circle_through(points, _SAME_SHAPE_MM)
    return ("circle", parameters, *found) if found else ("other", parameters, np.zeros(3), np.zeros(3), np.nan)


def _without_gaps(normals: Vectors) -> Vectors:
    """The normals, with each missing (zero) one replaced by the nearest one along the edge."""
    there = np.flatnonzero(np.any(normals != 0.0, axis=1))
    if len(there) in (0, len(normals)):
        return normals
    nearest = np.abs(np.arange(len(normals))[:, None] - there).argmin(axis=1)
    return np.asarray(normals[there[nearest]])
