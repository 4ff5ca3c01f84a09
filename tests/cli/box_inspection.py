"""The inspection of a box that the tests of the commands start from."""

from __future__ import annotations

from pathlib import Path

from viewgauge.cli import main

SECTIONS = {
    "part": """
  file: box.stl
  characteristics:
    - id: width
      points: [[0, 0, 40], [80, 0, 40]]
      unit: mm
      tolerance: 0.1 mm
    - id: heel
      points: [[0, 50, 0], [80, 50, 0]]
      unit: mm
      tolerance: '[-0.1, 0.2] mm'""",
    "camera": "{focal_length: 16 mm, pixel_pitch: 3.45 um, resolution: [2448, 2048], "
    "edge_detector: {quantization: 0.1 px}}",
    "pose_uncertainty": "{translation: 0.1 mm, rotation: 0.02 deg}",
    "requirement": "{accuracy: 0.995, probability: 0.95}",
    "candidates": "{directions: 40, rolls: 2}",
}


def write(name="inspection.yaml", **changes):
    Path(name).write_text("".join(f"{key}: {value}\n" for key, value in {**SECTIONS, **changes}.items()))


def refused(capsys, *arguments):
    """The message of a command that has to end with exit code 2."""
    assert main([str(a) for a in arguments]) == 2
    out, err = capsys.readouterr()
    assert err.startswith("viewgauge: ")
    assert "Traceback" not in err
    assert out == ""
    return err
