"""The inspection files that tests start from, each once, and the parts they are of: a box, and a block with a step."""

from __future__ import annotations

from pathlib import Path

import numpy as np

# sections of a file, on one line each
CAMERA = "{focal_length: 16 mm, pixel_pitch: 3.45 um, resolution: [2448, 2048], edge_detector: {quantization: 0.1 px}}"
WHOLE_PIXELS = "{focal_length: 16 mm, pixel_pitch: 3.45 um, resolution: [2448, 2048]}"
POSE_UNCERTAINTY = "{translation: 0.1 mm, rotation: 0.02 deg}"

# the same with a line for each key: messages name lines
PART_LINES = "part:\n  file: part.step\n"
CAMERA_KEYS = "  focal_length: 16 mm\n  pixel_pitch: 3.45 um\n  resolution: [2448, 2048]\n"
POSE_UNCERTAINTY_LINES = "pose_uncertainty:\n  translation: 0.1 mm\n  rotation: 0.02 deg\n"
REQUIREMENT_LINES = "requirement:\n  error: 0.05 mm\n  probability: 0.95\n"
MINIMAL = PART_LINES + "camera:\n" + CAMERA_KEYS + POSE_UNCERTAINTY_LINES + REQUIREMENT_LINES
"""All that an inspection file has to say."""


def entry(name: str, start: str, end: str, tolerance: str = "0.1 mm", **more: str) -> str:
    """A characteristic of a file, with what else is to be said of it."""
    said = {"points": f"[{start}, {end}]", "unit": "mm", "tolerance": tolerance, **more}
    return f"\n    - id: {name}" + "".join(f"\n      {key}: {value}" for key, value in said.items())


def sections(**of: str) -> str:
    """The text of a file, section by section."""
    return "".join(f"{name}: {text}\n" for name, text in of.items())


def changed(old: str, new: str, base: str) -> str:
    """A file that says something else in one place."""
    assert old in base
    return base.replace(old, new)


# --- a box, [0, 80] x [0, 50] x [0, 40] ----------------------------------------------------------------------------

WIDTH = entry("width", "[0, 0, 40]", "[80, 0, 40]")
HEEL = entry("heel", "[0, 50, 0]", "[80, 50, 0]", "'[-0.1, 0.2] mm'")


def box_part(*characteristics: str) -> str:
    """The section of the part."""
    return "\n  file: box.stl\n  characteristics:" + "".join(characteristics)


BOX = {
    "part": box_part(WIDTH, HEEL),
    "camera": CAMERA,
    "pose_uncertainty": POSE_UNCERTAINTY,
    "requirement": "{accuracy: 0.995, probability: 0.95}",
    "candidates": "{directions: 40, rolls: 2}",
    "accept": "[allowed_error_above_tolerance]",
}
"""Sections of a file; its requirement is relative to the lengths, and none of the tests is about the tolerances."""


def write_box(folder: str | Path = ".") -> None:
    """The box itself."""
    import trimesh

    trimesh.creation.box(bounds=[(0, 0, 0), (80, 50, 40)]).export(Path(folder) / "box.stl")


# --- a block with a step, [0, 60] x [0, 60] x [0, 40] and [0, 100] x [0, 60] x [0, 20] ------------------------------

STEPPED = {
    "part": "\n  file: block.stl\n  characteristics:"
    + entry("upper", "[0, 0, 40]", "[60, 0, 40]")
    + entry("foot", "[60, 10, 20]", "[60, 50, 20]")
    + entry("depth", "[100, 0, 20]", "[100, 60, 20]")
    + entry("edge", "[60, 0, 40]", "[60, 60, 40]", observed="whole")
    + entry("under", "[0, 0, 0]", "[0, 60, 0]"),
    "camera": CAMERA,
    "pose_uncertainty": "{translation: 0.1 mm, rotation: 0.02 deg, frame: {position: '[0, 0, -16] mm'}}",
    "requirement": "{accuracy: 0.9985, probability: 0.9}",
    "candidates": "{distance: '[200, 400] mm', distances: 3, directions: 40, rolls: 2, targets: 2}",
}
"""Sections of a file."""


def stepped_block():
    """Its surface."""
    import trimesh

    from viewgauge.part import Mesh

    boxes = [[[0, 0, 0], [100, 60, 20]], [[0, 0, 0], [60, 60, 40]]]
    made = trimesh.util.concatenate([trimesh.creation.box(bounds=box) for box in boxes])
    return Mesh(np.array(made.vertices), np.array(made.faces, dtype=np.int64))
