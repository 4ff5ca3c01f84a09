"""Triangle meshes from files, made fit to hide what lies behind them: welded, turned outward, united."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...exceptions import PartFileError
from ...part import Mesh
from ..files.units import LENGTH, parse_quantity
from .bodies import closed_bodies
from .mesh_file import MeshFile, read_mesh_file
from .orientation import oriented_outward
from .union import united
from .weld import welded

__all__ = ["mesh_of", "read_mesh"]

_LARGEST_MM = 1e9  # beyond it the squares and cubes of coordinates are no lengths any more


def read_mesh(path: str | os.PathLike[str], unit: str | None = None) -> tuple[Mesh, tuple[str, ...]]:
    """Read a mesh and notes on what the user should know about it.

    Vertices of nearly one place are merged (:func:`~viewgauge.formats.mesh.weld.welded`), triangles without area
    dropped, the triangles of a closed mesh turned counter-clockwise seen from outside, and bodies that touch united.
    Materials and textures are neither read nor looked for.

    Parameters
    ----------
    unit
        Of the coordinates, such as "inch"; None for the file's own, and mm where it has none.

    Raises
    ------
    PartFileError
        If the file is missing, empty or no mesh, or has no triangles, no extent or a coordinate that is not finite.
    """
    return mesh_of(read_mesh_file(Path(path)), path, unit)


def mesh_of(file: MeshFile, path: str | os.PathLike[str], unit: str | None = None) -> tuple[Mesh, tuple[str, ...]]:
    """What :func:`read_mesh` gives, of a file that is read already; the path is for messages."""
    scale, note = _scale(file, unit)
    notes = [note] if note else []
    vertices, triangles = file.vertices * scale, file.triangles
    if not np.abs(vertices).max() <= _LARGEST_MM:
        raise PartFileError(
            "the mesh is too large",
            file=path,
            got=f"a coordinate of {np.abs(vertices).max():.3g} mm",
            expected=f"at most {_LARGEST_MM:g} mm",
        )
    given = len(triangles)
    vertices, triangles, merged_mm = welded(vertices, triangles)
    if merged_mm:
        notes.append(f"corners within {merged_mm:.2g} mm were merged")
    triangles = _dropped_twins(triangles)
    bodies = closed_bodies(triangles)
    if bodies is None:
        notes.append("the mesh is not watertight: facing tests may be wrong")
    else:
        vertices, triangles = _apart(vertices, triangles, bodies)
        outward = oriented_outward(vertices, triangles)
        if (turned := int((outward != triangles).any(axis=1).sum())) > 0:
            notes.append(f"{turned} of {given} triangles faced inward and were turned")
        triangles = outward
    # only now: a triangle whose corners lie on a line closes the mesh though it has no area
    area = np.linalg.norm(Mesh(vertices, triangles).normals, axis=1) > 0
    if not area.any():
        raise PartFileError("every triangle of the mesh is without area", file=path, got=f"{given} triangles")
    if (lost := given - int(area.sum())) > 0:
        notes.append(f"{lost} of {given} triangles have no area, or are there twice, and were dropped")
    if bodies is not None:
        union = united(vertices, triangles)
        vertices, triangles = union.vertices, union.triangles
        notes += [union.note] if union.note else []
        area = np.linalg.norm(Mesh(vertices, triangles).normals, axis=1) > 0
    used, numbers = np.unique(triangles[area], return_inverse=True)
    return Mesh(vertices[used], numbers.reshape(-1, 3).astype(np.int64)), tuple(notes)


def _scale(file: MeshFile, unit: str | None) -> tuple[float, str]:
    """Millimetres in a unit of the coordinates, and a note on how it is known; empty where the file alone says it."""
    stated = unit or file.unit
    if stated is None:
        return 1.0, "a mesh file names no unit: its coordinates are taken as mm"
    scale = parse_quantity(f"1 {stated}", LENGTH)
    if unit is None or file.unit is None or scale == parse_quantity(f"1 {file.unit}", LENGTH):
        return scale, ""
    return scale, f"the file's unit is {file.unit} by its kind; part.unit says {unit}, which is used"


def _dropped_twins(triangles: NDArray[np.int64]) -> NDArray[np.int64]:
    """The triangles without those that are there a second time with the same sense."""
    turned = np.argmin(triangles, axis=1)
    first = np.take_along_axis(triangles, (turned[:, None] + np.arange(3)) % 3, axis=1)
    _, index = np.unique(first, axis=0, return_index=True)
    return triangles if len(index) == len(triangles) else triangles[np.sort(index)]


def _apart(
    vertices: NDArray[np.float64], triangles: NDArray[np.int64], bodies: list[NDArray[np.int64]]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The mesh with vertices of its own for each body."""
    if len(bodies) == 1:
        return vertices, triangles[bodies[0]]
    points, faces, count = [], [], 0
    for body in bodies:
        used, numbers = np.unique(triangles[body], return_inverse=True)
        points.append(vertices[used])
        faces.append(numbers.reshape(-1, 3).astype(np.int64) + count)
        count += len(used)
    return np.concatenate(points), np.concatenate(faces)
