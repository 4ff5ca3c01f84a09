"""Tessellated geometry of a STEP file (ISO 10303-42, edition 2014): solids and shells of triangles without surfaces.

Triangles of annotations, which stand in a TESSELLATED_GEOMETRIC_SET, are drawings of PMI and no part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ....exceptions import PartFileError
from ....part.brep import Brep
from ....part.mesh import Mesh
from ...mesh.watertight import is_watertight
from ..step_text import Record, Ref, StepText
from .coordinates import LARGEST_MM

__all__ = ["has_surfaces", "tessellated_bodies", "tessellated_brep"]

_SURFACES = (
    "ADVANCED_FACE",
    "FACE_SURFACE",
    "SHELL_BASED_SURFACE_MODEL",
    "CSG_SOLID",
    "SOLID_REPLICA",
    "SWEPT_FACE_SOLID",
)
_SOLIDS = ("TESSELLATED_SOLID",)
_SHELLS = ("TESSELLATED_SHELL", "TESSELLATED_CLOSED_SHELL", "TESSELLATED_OPEN_SHELL")
_REPRESENTATIONS = ("TESSELLATED_SHAPE_REPRESENTATION",)
_FACES = (
    "TRIANGULATED_FACE",
    "COMPLEX_TRIANGULATED_FACE",
    "TRIANGULATED_SURFACE_SET",
    "COMPLEX_TRIANGULATED_SURFACE_SET",
)
_UNUSABLE = ("CUBIC_BEZIER_TRIANGULATED_FACE", "CUBIC_BEZIER_TESSELLATED_EDGE", "FACETED_PRIMITIVE")
_ASSEMBLY = "NEXT_ASSEMBLY_USAGE_OCCURRENCE"
_ONLY = "the file holds only tessellated geometry"
_INSTEAD = "export the part as a B-rep (exact surfaces), or as a mesh (STL, PLY, OBJ)"

_Vectors = NDArray[np.float64]
_Triangles = NDArray[np.int64]


@dataclass(frozen=True)
class _Piece:
    """Triangles ``(m, 3)`` into vertices ``(n, 3)``, in the file's unit."""

    vertices: _Vectors
    triangles: _Triangles


def has_surfaces(text: StepText) -> bool:
    """Whether there is geometry that the CAD kernel reads."""
    return bool(text.numbers(*_SURFACES))


def tessellated_bodies(text: StepText) -> list[int]:
    """Records of the tessellated solids, and of the shells that belong to none."""
    solids = text.numbers(*_SOLIDS)
    shells = text.numbers(*_SHELLS)
    used = {number for solid in solids for number in text.references(solid)}
    bodies = [*solids, *(shell for shell in shells if shell not in used)]
    within = {number for body in (*solids, *shells) for number in text.references(body)}
    known = {*bodies, *within}
    items = {item for number in text.numbers(*_REPRESENTATIONS) for item in text.references(number)}
    return sorted([*bodies, *(item for item in items - known if text.type_of(item) in _FACES)])


def tessellated_brep(text: StepText, name: str, factor: float, unit: str) -> Brep:
    """The part of a file whose geometry is all tessellated: a mesh, without faces and edges.

    Parameters
    ----------
    factor
        Size of the file's length unit, mm.
    unit
        Its name.

    Raises
    ------
    PartFileError
        If there is something tessellated that cannot be used.
    """
    bodies = tessellated_bodies(text)
    instances = len(text.numbers(_ASSEMBLY))
    if instances and (len(bodies) > 1 or instances > 1):
        raise PartFileError(
            f"{_ONLY}, placed in an assembly",
            got=f"{len(bodies)} bodies, {instances} instances",
            expected="B-rep geometry, or the tessellated geometry of one part",
            hint=_INSTEAD,
        )
    pieces: list[_Piece] = []
    for body in bodies:
        pieces += _pieces(text, body, set())
    vertices, triangles = _welded(pieces, factor)
    if not len(triangles):
        raise PartFileError(f"{_ONLY}, and no triangle of it has an area", expected="a solid part", hint=_INSTEAD)
    notes = ["The file holds only tessellated geometry (triangles, no surfaces): it is used as a mesh."]
    if is_watertight(triangles):
        from ...mesh.orientation import oriented_outward  # late: it loads SciPy, which other STEP files do not need

        triangles = oriented_outward(vertices, triangles)
    else:
        notes.append("The mesh is not watertight: the part's surface has gaps.")
    solids = len(text.numbers(*_SOLIDS))
    return Brep(name, unit, (), (), Mesh(vertices, triangles), (), notes=tuple(notes), solids=solids)


def _pieces(text: StepText, number: int, seen: set[int]) -> list[_Piece]:
    """The triangles of a solid, a shell or a face."""
    if number in seen:
        return []
    seen.add(number)
    parts = text.records(number)
    types = {part.type for part in parts}
    if "REPOSITIONED_TESSELLATED_ITEM" in types or types & {*_UNUSABLE}:
        raise PartFileError(
            f"{_ONLY}, of a kind that cannot be used",
            got=f"#{number} = {text.type_of(number)}",
            expected="TESSELLATED_SOLID or TESSELLATED_SHELL of TRIANGULATED_FACE or COMPLEX_TRIANGULATED_FACE",
            hint=_INSTEAD,
        )
    if types & {*_SOLIDS, *_SHELLS}:
        items = [item for part in parts for item in _items(part)]
        return [piece for item in items for piece in _pieces(text, item, seen)]
    face = next((part for part in parts if part.type in _FACES), None)
    if face is None or len(parts) > 1:
        raise PartFileError(
            f"{_ONLY}, of a kind that cannot be used",
            got=f"#{number} = {text.type_of(number) or 'a record that cannot be read'}",
            expected=" or ".join(_FACES),
            hint=_INSTEAD,
        )
    return [_face(text, number, face)]


def _items(body: Record) -> list[int]:
    """The faces that a solid or shell is made of: its first list."""
    lists = [parameter for parameter in body.parameters if isinstance(parameter, tuple)]
    return [item.number for item in (lists[0] if lists else ()) if isinstance(item, Ref)]


def _face(text: StepText, number: int, face: Record) -> _Piece:
    """``(name, coordinates, pnmax, normals, [geometric link,] pnindex, triangles | strips, fans)``."""
    complex_face = face.type.startswith("COMPLEX")
    coordinates = face.parameters[1] if len(face.parameters) > 1 else None
    lists = list(face.parameters[-3:] if complex_face else face.parameters[-2:])
    points = _coordinates(text, coordinates.number) if isinstance(coordinates, Ref) else None
    try:
        if points is None:
            raise ValueError("no coordinates")
        index = _whole_numbers(lists[0])
        local = points[index - 1] if len(index) else points
        if len(index) and index.min() < 1:
            raise ValueError("an index below 1")
        triangles = _from_strips_and_fans(lists[1], lists[2]) if complex_face else _rows(lists[1])
        if len(triangles) and not 1 <= triangles.min() <= triangles.max() <= len(local):
            raise ValueError(f"an index outside 1 to {len(local)}")
    except (ValueError, TypeError, IndexError) as error:
        raise PartFileError(
            "tessellated geometry cannot be read", got=f"#{number} = {face.type}: {error}", hint=_INSTEAD
        ) from error
    return _Piece(local, triangles - 1)


def _coordinates(text: StepText, number: int) -> _Vectors | None:
    record = text.part(number, "COORDINATES_LIST")
    if record is None or not isinstance(record.parameters[-1], tuple):
        return None
    points = np.array(record.parameters[-1], dtype=float).reshape(-1, 3)
    if not np.all(np.isfinite(points)):
        raise ValueError("a coordinate is no number")
    return points


def _whole_numbers(values: object) -> _Triangles:
    return np.array(values if isinstance(values, tuple) else (), dtype=float).astype(np.int64).reshape(-1)


def _rows(values: object) -> _Triangles:
    return np.array(values if isinstance(values, tuple) else (), dtype=float).astype(np.int64).reshape(-1, 3)


def _from_strips_and_fans(strips: object, fans: object) -> _Triangles:
    """Triangles of strips (every second one turned) and of fans (all with the first corner)."""
    triangles: list[tuple[int, int, int]] = []
    for strip in strips if isinstance(strips, tuple) else ():
        corners = _whole_numbers(strip).tolist()
        for k in range(len(corners) - 2):
            a, b, c = corners[k : k + 3]
            triangles.append((a, b, c) if k % 2 == 0 else (b, a, c))
    for fan in fans if isinstance(fans, tuple) else ():
        corners = _whole_numbers(fan).tolist()
        triangles += [(corners[0], b, c) for b, c in pairwise(corners[1:])]
    return np.array(triangles, dtype=np.int64).reshape(-1, 3)


def _welded(pieces: Sequence[_Piece], factor: float) -> tuple[_Vectors, _Triangles]:
    """Vertices mm and triangles of all pieces, equal corners joined, without triangles that have no area."""
    if not pieces:
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    starts = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    vertices = np.concatenate([piece.vertices for piece in pieces]) * factor
    triangles = np.concatenate([piece.triangles + start for piece, start in zip(pieces, starts, strict=False)])
    if float(np.abs(vertices).max(initial=0.0)) > LARGEST_MM:
        raise PartFileError(
            "a point lies farther from the origin than any part",
            got=f"{np.abs(vertices).max():.6g} mm",
            expected=f"coordinates of at most {LARGEST_MM:.0e} mm",
        )
    vertices, same = np.unique(vertices + 0.0, axis=0, return_inverse=True)  # + 0.0: -0.0 becomes 0.0
    triangles = same.reshape(-1)[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    used, numbers = np.unique(triangles, return_inverse=True)
    return vertices[used], numbers.reshape(-1, 3).astype(np.int64)
