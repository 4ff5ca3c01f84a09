"""From a plan to measured characteristics: plan with a calibrated camera, simulate images of the plan's viewpoints,
measure.

Usage: python images.py [FOLDER]

Writes the plan, the images and pictures of what was found into FOLDER (by default a temporary one). Exit code 1 if a
characteristic fails although the part is right.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from pathlib import Path

import viewgauge as vg

FILE = Path(__file__).parent / "real_camera.yaml"
REPEATS = 4


def main(folder: Path) -> int:
    """Print what was measured."""
    inspection = vg.load(FILE, chord_error_mm=0.002)
    plan = vg.plan(inspection, prove=False)
    vg.write_plan(plan, inspection, folder / "plan")
    sensor = vg.ImageSensor(blur_px=0.6, noise=0.005)
    vg.simulate(inspection, folder / "images", folder / "plan" / "viewpoints.csv", repeats=REPEATS, sensor=sensor)
    rows = vg.measure(inspection, folder / "plan", folder / "images", folder / "measured")
    print(f"{plan.count} viewpoints, {REPEATS} images of each\n")
    print("characteristic | nominal | mean of measured / mm | U / mm | verdicts")
    for name in dict.fromkeys(row.characteristic for row in rows):
        mine = [row for row in rows if row.characteristic == name]
        values = [row.measured_mm for row in mine if row.measured_mm is not None]
        mean = f"{sum(values) / len(values):.4f}" if values else "-"
        largest = max((row.expanded_uncertainty_mm or 0.0 for row in mine), default=0.0)
        reported = ", ".join(f"{count} {verdict}" for verdict, count in Counter(row.verdict for row in mine).items())
        print(f"{name:14} | {mine[0].nominal_mm:7g} | {mean:>21} | {largest:6.4f} | {reported}")
    return int(any(row.verdict == "fail" for row in rows))


if __name__ == "__main__":
    if len(sys.argv) > 1:
        sys.exit(main(Path(sys.argv[1])))
    with tempfile.TemporaryDirectory() as made:
        sys.exit(main(Path(made)))
