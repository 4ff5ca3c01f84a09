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
    def reading(
        self,
        path: Path,
        chord_error_mm: float | None,  # noqa: ARG002 - a mesh is as it is
        unit: str | None,
    ) -> Iterator[Callable[[], Part]]:
        """Nothing is begun; what the block is given reads the part."""
        yield lambda: _part(path, unit)


def _part(path: Path, unit: str | None) -> Part:
    from ...part import Part
    from ...part.feature_lines import mesh_feature_lines
    from ...part.part_size import size_findings
    from .mesh_file import read_mesh_file
    from .meshes import mesh_of

    file = read_mesh_file(path)
    mesh, notes = mesh_of(file, path, unit)
    taken = unit or file.unit or "mm"
    findings = size_findings(mesh, "" if unit or file.unit else "part.unit")
    lines = mesh_feature_lines(mesh)
    return Part(path.stem, mesh, (), notes=notes, length_unit=taken, feature_lines=lines, findings=findings)
