"""The kinds of part file: STEP and meshes, recognised by the file's suffix.

A further kind is a class like :class:`PartFormat` in a file of its own, and its place in ``PART_FORMATS``, or
``PART_FORMATS.register(...)`` from outside. What takes long to import is imported by its ``reading``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from ..exceptions import PartFileError
from .files.registry import SuffixRegistry
from .mesh.mesh_part import MeshPart
from .step.step_part import StepPart

if TYPE_CHECKING:
    from ..part import Part

__all__ = ["PART_FORMATS", "PartFormat", "reading_part"]


class PartFormat(Protocol):
    """Reads one kind of part file."""

    @property
    def name(self) -> str:
        """The kind, as messages call it: "STEP"."""
        ...

    @property
    def suffixes(self) -> tuple[str, ...]:
        """In lower case, with their point."""
        ...

    def reading(
        self, path: Path, chord_error_mm: float | None, unit: str | None
    ) -> AbstractContextManager[Callable[[], Part]]:
        """Begin to read a part; what the block is given gives the part, or raises PartFileError.

        Parameters
        ----------
        chord_error_mm
            How far the mesh of a CAD part may be from its curved faces; None to choose it by the part's size.
        unit
            Of the file's lengths as the user states it, such as "inch"; None where they do not.
        """
        ...


PART_FORMATS: SuffixRegistry[PartFormat] = SuffixRegistry(StepPart(), MeshPart())


@contextmanager
def reading_part(
    path: Path, chord_error_mm: float | None = None, unit: str | None = None
) -> Iterator[Callable[[], Part]]:
    """Begin to read a part file; the block has time for other work until it calls what it is given.

    That call gives the part, or raises PartFileError for whatever is wrong with it, a kind that is not known too.
    """
    found = PART_FORMATS.of(path)
    if found is None:
        yield lambda: _refuse(path)
    else:
        with found.reading(path, chord_error_mm, unit) as finish:
            yield finish


def _refuse(path: Path) -> Part:
    kinds = [f"{format_.name} ({', '.join(format_.suffixes)})" for format_ in PART_FORMATS]
    raise PartFileError(
        "this kind of part file is not known",
        file=path,
        got=f"suffix {path.suffix!r}",
        expected=" or ".join(kinds),
    )
