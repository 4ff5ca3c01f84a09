"""Are the predictions true of images? The example's dimensions, the paper's five settings, and where the model ends.

Usage: python benchmarks/validation.py FOLDER [--looks N] [--settings N] [--part images|quantization|paper]

Writes Markdown and pictures into FOLDER; without ``--part`` all parts. What is there of a part's runs is kept: a study
that was stopped goes on.

images: displaced looks of the slotted block, rendered and measured, against the law, for noise, pixels and edges;
quantization: where whole pixels are not the uniform errors that the model takes them for; paper: images and edge maps of
the reconstructed five-setting experiment (the paper's Fig. 7).
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import viewgauge as vg
from viewgauge.workflow import Sensor, describe_validation

BLOCK = Path(__file__).resolve().parents[1] / "examples" / "slotted_block" / "inspection.yaml"
CHORD_ERROR_MM = 0.001
RUNS: dict[str, dict[str, Any]] = {
    "3.45 µm, noise 0.2 %": {"noise": 0.002},
    "3.45 µm, noise 1 %": {"noise": 0.01},
    "6.9 µm, noise 0.5 %": {"noise": 0.005, "pixels": 2},
}


def images(folder: Path, settings: int, looks: int) -> list[str]:
    """Part images: Markdown."""
    inspection = vg.load(BLOCK, chord_error_mm=CHORD_ERROR_MM)
    documents = {}
    for number, (name, run) in enumerate(RUNS.items()):
        kept = folder / f"images_{number}_{settings}_{looks}.json"
        if not kept.exists():
            camera = inspection.camera
            pitch, (columns, rows) = run.get("pixels", 1) * camera.pixel_pitch_mm[0], camera.resolution
            size = (columns // run.get("pixels", 1), rows // run.get("pixels", 1))
            mine = replace(inspection, camera=replace(camera, pixel_pitch_mm=(pitch, pitch), resolution=size))
            sensor = Sensor(blur_px=0.6, noise=run["noise"])
            with vg.open_executor(workers=2) as executor:
                found = vg.validate(
                    mine,
                    sample=settings,
                    looks=looks,
                    sensor=sensor,
                    edges=("sub-pixel", "whole-pixel"),
                    seed=inspection.seed + number,
                    executor=executor,
                )
            kept.write_text(json.dumps(describe_validation(found)))
        documents[name] = json.loads(kept.read_text())
    return [*_pooled(documents), "", *_by_dimension(documents)]


def _pooled(documents: dict[str, list[dict[str, Any]]]) -> list[str]:
    lines = [
        "| images | edges | looks | inside 68 % | 95 % | 99 % |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name, found in documents.items():
        for one in found:
            shares = []
            for c in one["coverage"]:
                n = c["looks"]
                limits = f"{100 * c['low'] / n:.1f} to {100 * c['high'] / n:.1f}"
                share = f"{100 * c['inside'] / n:.1f}"
                shares.append(f"{share if c['holds'] else f'**{share}**'} ({limits})")
            lines.append(f"| {name} | {one['edges']} | {one['coverage'][0]['looks']} | " + " | ".join(shares) + " |")
    return lines


def _by_dimension(documents: dict[str, list[dict[str, Any]]]) -> list[str]:
    names = sorted({d["id"] for found in documents.values() for d in found[0]["dimensions"]}, key=_order)
    lines = [
        "| dimension | " + " | ".join(documents) + " |",
        "| --- |" + " --- |" * len(documents),
    ]
    for name in names:
        cells = []
        for found in documents.values():
            row = next((d for d in found[0]["dimensions"] if d["id"] == name), None)
            if row is None or row["rms_ratio"] is None:
                cells.append("not seen")
                continue
            shares = (100 * c["inside"] / max(c["looks"], 1) for c in row["coverage"])
            told = " / ".join(f"{s:.1f}{'' if c['holds'] else '*'}" for s, c in zip(shares, row["coverage"], strict=True))
            cells.append(f"{row['rms_ratio']:.2f}; {told} ({row['looks']})")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return lines


def _order(name: str) -> tuple[int, str]:
    digits = "".join(c for c in name.split("/")[0] if c.isdigit())
    return int(digits or 0), name


PARTS: dict[str, Callable[[Path, int, int], list[str]]] = {"images": images}


def main() -> int:
    """Run the parts."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--looks", type=int, default=100)
    parser.add_argument("--settings", type=int, default=20)
    parser.add_argument("--part", choices=list(PARTS))
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for name, part in PARTS.items():
        if given.part in (None, name):
            lines = part(given.folder, given.settings, given.looks)
            (given.folder / f"{name}.md").write_text("\n".join(lines) + "\n")
            print("\n".join([f"## {name}", "", *lines, ""]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
