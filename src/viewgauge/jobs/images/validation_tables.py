"""A validation as plain data and as a table."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import asdict
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ...formats.files.atomic import write_text_atomically
from ...formats.files.spreadsheet_text import to_cell
from .measure import Edges
from .validation import LEVELS, Coverage, Validation

__all__ = ["describe_validation", "write_validation"]


def describe_validation(found: Mapping[Edges, Validation]) -> list[dict[str, Any]]:
    """As JSON-ready data, px; of each way of finding edges."""
    return [
        {
            "edges": one.edges,
            "viewpoints": one.viewpoints,
            "acquisitions": one.acquisitions,
            "coverage": [_level(c) for c in one.coverage()],
            "drawn_unmeasured": one.drawn_unmeasured,
            "characteristics": [
                _characteristic(one, name) for name in dict.fromkeys(p.characteristic for p in one.pairs)
            ],
            "refused": [list(refusal) for refusal in one.refused],
        }
        for one in found.values()
    ]


def _level(coverage: Coverage) -> dict[str, Any]:
    return {**asdict(coverage), "holds": coverage.holds}


def _characteristic(found: Validation, name: str) -> dict[str, Any]:
    errors = np.concatenate([p.errors_px / p.predicted_px for p in found.pairs if p.characteristic == name])
    good = errors[np.isfinite(errors)]
    return {
        "id": name,
        "acquisitions": len(good),
        "not_measured": int(len(errors) - len(good)),
        "rms_ratio": float(np.sqrt((good**2).mean())) if len(good) else None,
        "coverage": [_level(c) for c in found.coverage_of(name)],
    }


def write_validation(found: Mapping[Edges, Validation], path: str | PathLike[str]) -> None:
    """Write a CSV with a row for each viewpoint and characteristic, px.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [
        "edges",
        "viewpoint",
        "characteristic",
        "length_px",
        "predicted_px",
        "location_px",
        "acquisitions",
        "not_measured",
    ]
    writer.writerow([*names, "mean_px", "deviation_px", *(f"inside_{round(100 * level)}" for level in LEVELS)])
    for one in found.values():
        for pair in one.pairs:
            good = np.isfinite(pair.errors_px)
            errors = pair.errors_px[good]
            inside = [int((pair.probability[good] <= level).sum()) for level in LEVELS]
            spread = [float(errors.mean()), float(errors.std())] if len(errors) else ["", ""]
            predicted = [pair.length_px, pair.predicted_px, pair.location_px]
            counts = [int(good.sum()), int((~good).sum())]
            writer.writerow(
                [
                    one.edges,
                    to_cell(pair.viewpoint),
                    to_cell(pair.characteristic),
                    *predicted,
                    *counts,
                    *spread,
                    *inside,
                ]
            )
    write_text_atomically(Path(path), text.getvalue())
