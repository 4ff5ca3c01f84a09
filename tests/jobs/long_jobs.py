"""A part, its inspection file, and what tests of long jobs share."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import viewgauge as vg
from viewgauge.execution.executor import InProcess
from viewgauge.part import Mesh
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.planning import CandidateGrid

# a block with a step, [0, 60] x [0, 60] x [0, 40] and [0, 100] x [0, 60] x [0, 20]
INSPECTION = """
part:
  file: block.stl
  characteristics:
    - {id: upper, points: [[0, 0, 40], [60, 0, 40]], unit: mm, tolerance: 0.1 mm}
    - {id: foot, points: [[60, 10, 20], [60, 50, 20]], unit: mm, tolerance: 0.1 mm}
    - {id: depth, points: [[100, 0, 20], [100, 60, 20]], unit: mm, tolerance: 0.1 mm}
    - {id: edge, points: [[60, 0, 40], [60, 60, 40]], unit: mm, tolerance: 0.1 mm, observed: whole}
    - {id: under, points: [[0, 0, 0], [0, 60, 0]], unit: mm, tolerance: 0.1 mm}
camera: {focal_length: 16 mm, pixel_pitch: 3.45 um, resolution: [2448, 2048], edge_detector: {quantization: 0.1 px}}
pose_uncertainty: {translation: 0.1 mm, rotation: 0.02 deg, frame: {position: "[0, 0, -16] mm"}}
requirement: {accuracy: 0.9985, probability: 0.9}
candidates: {distance: "[200, 400] mm", distances: 3, directions: 40, rolls: 2, targets: 2}
"""


def block() -> Mesh:
    import trimesh

    boxes = [[[0, 0, 0], [100, 60, 20]], [[0, 0, 0], [60, 60, 40]]]
    made = trimesh.util.concatenate([trimesh.creation.box(bounds=box) for box in boxes])
    return Mesh(np.array(made.vertices), np.array(made.faces, dtype=np.int64))


def write_inspection(folder, **changes):
    """The inspection file with other values of some keys, and its part."""
    import trimesh

    mesh = block()
    trimesh.Trimesh(mesh.vertices, mesh.triangles).export(folder / "block.stl")
    lines = [
        f"{line.split(':')[0]}: {changes[line.split(':')[0]]}" if line.split(":")[0] in changes else line
        for line in INSPECTION.splitlines()
    ]
    (folder / "inspection.yaml").write_text("\n".join(lines))
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
