"""Triangle meshes as a kind of part file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from . import MESH_SUFFIXES

if TYPE_CHECKING:  # meshes are read by what takes long to import
    from ...part import Part

__all__ = ["MeshPart"]


class MeshPart:
    """Parts in mesh files: a surface without characteristics of its own."""

    name = "a mesh"
    suffixes = MESH_SUFFIXES

    @contextmanager
    def reading(self, path: Path, chord_error_mm: float | None) -> Iterator[Callable[[], Part]]:  # noqa: ARG002 - a mesh is as it is
        """Nothing is begun; what the block is given reads the part."""
        yield lambda: _part(path)


def _part(path: Path) -> Part:
    from ...part import Part
    from ...part.feature_lines import mesh_feature_lines
    from .meshes import read_mesh

    mesh, notes = read_mesh(path)
    return Part(path.stem, mesh, (), notes=notes, feature_lines=mesh_feature_lines(mesh))
