"""Triangle meshes from STL, PLY and OBJ files."""

from __future__ import annotations

import logging
import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...exceptions import PartFileError
from ...part import Mesh
from . import MESH_SUFFIXES
from .orientation import oriented_outward
from .watertight import is_watertight

__all__ = ["read_mesh"]

_Triangles = NDArray[np.int64]
_SILENT = logging.NullHandler()


def read_mesh(path: str | os.PathLike[str]) -> tuple[Mesh, tuple[str, ...]]:
    """Read a mesh, coordinates taken as mm, and notes on what the user should know about it.

    Equal vertices are merged, triangles without area dropped, and the triangles of a watertight mesh are turned
    counter-clockwise seen from outside. Materials and textures are neither read nor looked for.

    Raises
    ------
    PartFileError
        If the file is missing, empty or no mesh, or has no triangles, no extent or a coordinate that is not finite.
    """
    vertices, triangles = _load(Path(path))
    _require_usable(path, vertices, triangles)
    notes = ["a mesh file names no unit: its coordinates are taken as mm"]
    given = len(triangles)
    vertices, merged = np.unique(vertices + 0.0, axis=0, return_inverse=True)  # + 0.0: -0.0 becomes 0.0
    triangles = merged.reshape(-1)[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    if is_watertight(triangles):
        outward = oriented_outward(vertices, triangles)
        if (turned := int((outward != triangles).any(axis=1).sum())) > 0:
            notes.append(f"{turned} of {given} triangles faced inward and were turned")
        triangles = outward
    else:
        notes.append("the mesh is not watertight: facing tests may be wrong")
    # only now: a triangle whose corners lie on a line closes the mesh though it has no area
    triangles = triangles[np.linalg.norm(Mesh(vertices, triangles).normals, axis=1) > 0]
    if not len(triangles):
        raise PartFileError("every triangle of the mesh is without area", file=path, got=f"{given} triangles")
    if len(triangles) < given:
        notes.append(f"{given - len(triangles)} of {given} triangles have no area and were dropped")
    used, numbers = np.unique(triangles, return_inverse=True)
    return Mesh(vertices[used], numbers.reshape(-1, 3).astype(np.int64)), tuple(notes)


def _load(path: Path) -> tuple[NDArray[np.float64], _Triangles]:
    """Vertices ``(n, 3)`` and triangles ``(m, 3)`` as the file has them."""
    suffix = path.suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise PartFileError(
            "not a mesh file by its name", file=path, got=path.suffix, expected=", ".join(MESH_SUFFIXES)
        )
    try:
        size = path.stat().st_size
    except OSError as error:
        raise PartFileError(f"the file cannot be read: {error.strerror or error}", file=path) from error
    if path.is_dir():
        raise PartFileError("this is a folder, not a file", file=path)
    if size == 0:
        raise PartFileError("the file is empty", file=path)
    import trimesh  # late: slow to import, and only meshes need it

    logging.getLogger("trimesh").addHandler(_SILENT)  # it logs tracebacks of what is reported here
    try:
        # an open file and no resolver: nothing that the mesh refers to can be found, let alone fetched
        with path.open("rb") as file:
            scene = trimesh.load_scene(file, file_type=suffix[1:], process=False, skip_materials=True, resolver=None)
        pieces = [piece for piece in scene.geometry.values() if isinstance(piece, trimesh.Trimesh)]
        return _joined([(np.asarray(piece.vertices), np.asarray(piece.faces)) for piece in pieces])
    except Exception as error:  # a damaged file makes the parsers raise almost anything
        raise PartFileError(
            f"the file cannot be read as {suffix[1:].upper()}",
            file=path,
            got=None if isinstance(error, ImportError) else f"{type(error).__name__}: {error}",  # no optional parsers
            hint="check that it is complete and of the kind that its name says",
        ) from error


def _joined(pieces: list[tuple[NDArray[np.float64], _Triangles]]) -> tuple[NDArray[np.float64], _Triangles]:
    """Vertices and triangles of several pieces (an OBJ file has one per material) as one mesh."""
    vertices, triangles, count = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0
    for points, faces in pieces:
        vertices.append(points)
        triangles.append(faces + count)
        count += len(points)
    return np.concatenate(vertices), np.concatenate(triangles)


def _require_usable(path: str | os.PathLike[str], vertices: NDArray[np.float64], triangles: _Triangles) -> None:
    if not len(triangles):
        raise PartFileError(
            "the mesh has no triangles",
            file=path,
            hint="check that the file is complete and of the kind that its name says",
        )
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise PartFileError("a triangle refers to a vertex that is not there", file=path)
    finite = np.isfinite(vertices).all(axis=1)
    if not finite.all():
        raise PartFileError(
            "a coordinate of the mesh is not finite",
            file=path,
            got=f"{(~finite).sum()} of {len(vertices)} vertices, first {vertices[~finite][0].tolist()}",
        )
    if not np.ptp(vertices[triangles.ravel()], axis=0).max() > 0:
        raise PartFileError("the mesh has no extent: all its vertices are one point", file=path)
