"""STEP as a kind of part file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from ...exceptions import PartFileError
from .kernel_process import reading_step

if TYPE_CHECKING:  # the child process that reads is started before anything slow is imported
    from ...part import Brep, Part

__all__ = ["StepPart"]


class StepPart:
    """Parts in STEP files, with the characteristics of their semantic PMI."""

    name = "STEP"
    suffixes = (".stp", ".step", ".p21", ".stpz", ".stp.gz", ".step.gz", ".p21.gz")

    @contextmanager
    def reading(self, path: Path, chord_error_mm: float | None, unit: str | None) -> Iterator[Callable[[], Part]]:
        """Begin to read a part in a child process; what the block is given waits for it."""
        if unit is not None:
            raise PartFileError(
                "a STEP file names its own unit",
                file=path,
                got=f"part.unit: {unit}",
                expected="part.unit with a mesh only",
                hint="remove part.unit, or correct the unit in the STEP file",
            )
        with reading_step(path, chord_error_mm=chord_error_mm) as finish:
            yield lambda: _part(finish(), path)


def _part(brep: Brep, path: Path) -> Part:
    from ...part import Part
    from ...part.characteristics import derive_characteristics
    from ...part.feature_lines import brep_feature_lines, mesh_feature_lines
    from ...part.part_size import size_findings

    characteristics, not_measurable = derive_characteristics(brep)
    return Part(
        name=brep.name or path.stem,
        mesh=brep.mesh,
        characteristics=characteristics,
        not_measurable=not_measurable,
        notes=brep.notes,
        length_unit=brep.length_unit,
        pmi_counts=brep.pmi_counts,
        findings=(*brep.findings, *size_findings(brep.mesh)),
        feature_lines=brep_feature_lines(brep) if brep.faces else mesh_feature_lines(brep.mesh),
        solids=brep.solids,
        brep=brep if brep.faces else None,
    )
