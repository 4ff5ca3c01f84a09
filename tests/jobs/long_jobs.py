"""A part, its inspection file, and what tests of long jobs share."""

from __future__ import annotations

from pathlib import Path

import viewgauge as vg
from inspections import STEPPED, sections, stepped_block
from viewgauge.execution.executor import InProcess
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.planning import CandidateGrid


def write_inspection(folder, **changes):
    """The inspection file with other values of some keys, and its part."""
    import trimesh

    mesh = stepped_block()
    trimesh.Trimesh(mesh.vertices, mesh.triangles).export(folder / "block.stl")
    (folder / "inspection.yaml").write_text(sections(**{**STEPPED, **changes}))
    return vg.load(folder / "inspection.yaml")


def grid(inspection):
    points = MeasurandTable.of(inspection.part.characteristics).points
    return CandidateGrid(points, inspection.part.mesh, inspection.camera, inspection.candidates, inspection.seed)


def tree(folder):
    """Each file of a folder with its bytes, hidden ones too."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in Path(folder).rglob("*") if path.is_file()}


def plan_bytes(inspection, folder, **options):
    made = vg.plan(inspection, **options)
    vg.write_plan(made, inspection, folder)
    return tree(folder)


class Counting:
    """Runs chunks here, and tells how many."""

    def __init__(self):
        self.chunks = []

    def run(self, function, common, items):
        self.chunks.append(len(items))
        yield from InProcess().run(function, common, items)
