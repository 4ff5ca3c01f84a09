"""3MF files: the core specification's objects, components and build items, with their unit.

References
----------
3MF Consortium, *3MF Core Specification* 1.3, ch. 3 and 4.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from typing import IO, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

__all__ = ["read_3mf"]

_Piece = tuple[NDArray[np.float64], NDArray[np.int64]]

_UNITS = {"micron": "um", "millimeter": "mm", "centimeter": "cm", "inch": "in", "foot": "ft", "meter": "m"}
_MOST_BYTES = 2_000_000_000
_MOST_PIECES = 100_000
_DEEPEST = 32  # components within components


def read_3mf(file: IO[bytes]) -> tuple[list[_Piece], str]:
    """Vertices and triangles of every body that the file builds, in its unit, and the unit; raises ValueError."""
    with zipfile.ZipFile(file) as archive:
        name = next((n for n in archive.namelist() if n.lower().endswith(".model")), None)
        names = [n for n in archive.namelist() if n.lower().lstrip("/") == "3d/3dmodel.model"]
        name = names[0] if names else name
        if name is None:
            raise ValueError("it has no 3D model")
        if archive.getinfo(name).file_size > _MOST_BYTES:
            raise ValueError("its model is too large")
        with archive.open(name) as model:
            root = ElementTree.parse(model).getroot()
    if root.tag.rpartition("}")[2] != "model":
        raise ValueError("its model is no 3MF model")
    unit = root.get("unit", "millimeter")
    if unit not in _UNITS:
        raise ValueError(f"its unit {unit!r} is not one of {', '.join(_UNITS)}")
    objects = {e.get("id", ""): e for e in _named(root, "object")}
    pieces: list[_Piece] = []
    items = list(_named(root, "item"))
    for item in items:
        _gather(objects, item.get("objectid", ""), _transform(item), pieces, 0)
    if not items:
        for key in objects:
            _gather(objects, key, np.eye(4), pieces, 0)
    return pieces, _UNITS[unit]


def _gather(
    objects: dict[str, Any], key: str, T_build_object: NDArray[np.float64], pieces: list[_Piece], depth: int
) -> None:
    if key not in objects:
        raise ValueError(f"object {key!r} is in another file of the archive, or missing")
    if depth > _DEEPEST or len(pieces) > _MOST_PIECES:
        raise ValueError("its components are nested too deeply")
    element = objects[key]
    if element.get("type", "model") not in ("model", "solidsupport", "surface"):
        return  # supports and other helpers are no part
    for mesh in _children(element, "mesh"):
        vertices, triangles = _mesh(mesh)
        moved = vertices @ T_build_object[:3, :3].T + T_build_object[:3, 3]
        pieces.append((moved, triangles if np.linalg.det(T_build_object[:3, :3]) > 0 else triangles[:, ::-1]))
    for components in _children(element, "components"):
        for component in _children(components, "component"):
            _gather(objects, component.get("objectid", ""), T_build_object @ _transform(component), pieces, depth + 1)


def _mesh(mesh: Any) -> _Piece:
    vertices = [[float(v.get(axis)) for axis in "xyz"] for v in _named(mesh, "vertex")]
    triangles = [[int(t.get(corner)) for corner in ("v1", "v2", "v3")] for t in _named(mesh, "triangle")]
    return np.array(vertices, dtype=float).reshape(-1, 3), np.array(triangles, dtype=np.int64).reshape(-1, 3)


def _transform(element: Any) -> NDArray[np.float64]:
    """4x4; the file has the rows of the transposed matrix, without its last column."""
    text = element.get("transform")
    if text is None:
        return np.eye(4)
    values = np.array([float(word) for word in text.split()])
    if values.shape != (12,):
        raise ValueError("a transform is not twelve numbers")
    T = np.eye(4)
    T[:3] = values.reshape(4, 3).T
    return T


def _named(element: Any, name: str) -> Iterator[Any]:
    return (e for e in element.iter() if e.tag.rpartition("}")[2] == name)


def _children(element: Any, name: str) -> Iterator[Any]:
    return (e for e in element if e.tag.rpartition("}")[2] == name)
