"""What a mesh file holds: vertices and triangles as written, and the unit where the kind of file has one."""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from ...exceptions import PartFileError
from . import MESH_SUFFIXES
from .ply_strips import has_strips, read_strips
from .three_mf import read_3mf

__all__ = ["MeshFile", "read_mesh_file"]

_Piece = tuple[NDArray[np.float64], NDArray[np.int64]]
_SILENT = logging.NullHandler()


@dataclass(frozen=True)
class MeshFile:
    """The content of a mesh file.

    Parameters
    ----------
    vertices
        ``(n, 3)``, in the file's unit.
    triangles
        ``(m, 3)`` indices, one piece of the file after the other.
    unit
        By the file, such as "m"; None for kinds of file that have none.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    unit: str | None


def read_mesh_file(path: Path) -> MeshFile:
    """Read a mesh file; raises PartFileError if it is missing, empty, no mesh, or refers to what is not there."""
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
    try:
        with path.open("rb") as file:
            pieces, unit = _pieces(file, suffix)
        found = MeshFile(*_joined(pieces), unit)
    except Exception as error:  # a damaged file makes the parsers raise almost anything
        raise PartFileError(
            f"the file cannot be read as {suffix[1:].upper()}",
            file=path,
            got=None if isinstance(error, ImportError) else f"{type(error).__name__}: {error}",  # no optional parsers
            hint="check that it is complete and of the kind that its name says",
        ) from error
    _require_usable(path, found.vertices, found.triangles)
    return found


def _pieces(file: IO[bytes], suffix: str) -> tuple[list[_Piece], str | None]:
    if suffix == ".3mf":
        return read_3mf(file)
    if suffix == ".ply" and has_strips(file):
        return [read_strips(file)], None
    import trimesh  # late: slow to import, and only meshes need it

    logging.getLogger("trimesh").addHandler(_SILENT)  # it logs tracebacks of what is reported here
    # an open file and no resolver: nothing that the mesh refers to can be found, let alone fetched
    scene = trimesh.load_scene(file, file_type=suffix[1:], process=False, skip_materials=True, resolver=None)
    pieces = []
    for node in scene.graph.nodes_geometry:  # a piece may stand in several places
        T, name = scene.graph[node]
        piece = scene.geometry[name]
        if isinstance(piece, trimesh.Trimesh):
            vertices, triangles = np.asarray(piece.vertices), np.asarray(piece.faces)
            if not np.array_equal(T, np.eye(4)):
                vertices = vertices @ T[:3, :3].T + T[:3, 3]
                triangles = triangles if np.linalg.det(T[:3, :3]) > 0 else triangles[:, ::-1]
            pieces.append((vertices, triangles))
    return pieces, "m" if suffix == ".glb" else None


def _joined(pieces: list[_Piece]) -> _Piece:
    """Vertices and triangles of several pieces (an OBJ file has one per material) as one mesh."""
    vertices, triangles, count = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0
    for points, faces in pieces:
        if len(faces) and (faces.min() < 0 or faces.max() >= len(points)):
            raise ValueError("a triangle refers to a vertex that is not there")
        vertices.append(points)
        triangles.append(faces + count)
        count += len(points)
    return np.concatenate(vertices), np.concatenate(triangles)


def _require_usable(path: str | os.PathLike[str], vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> None:
    if not len(triangles):
        raise PartFileError(
            "the mesh has no triangles",
            file=path,
            hint="check that the file is complete and of the kind that its name says",
        )
    finite = np.isfinite(vertices).all(axis=1)
    if not finite.all():
        raise PartFileError(
            "a coordinate of the mesh is not finite",
            file=path,
            got=f"{(~finite).sum()} of {len(vertices)} vertices, first {vertices[~finite][0].tolist()}",
        )
    if not np.ptp(vertices[triangles.ravel()], axis=0).max() > 0:
        raise PartFileError("the mesh has no extent: all its vertices are one point", file=path)
