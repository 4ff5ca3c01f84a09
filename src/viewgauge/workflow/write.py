"""Write what a plan or an evaluation gave."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

import xarray as xr

from ..evaluation import COLUMNS
from ..exceptions import InputError
from ..io.atomic import write_text_atomically
from ..io.plan_files import plan_document, write_plan_files
from ..io.tables import require_table_suffix, write_table
from ..planning import Plan
from ..report import render_report
from .inspection import Inspection

__all__ = ["describe_plan", "make_folder", "require_table_suffix", "write_evaluation", "write_plan"]


def describe_plan(plan: Plan, inspection: Inspection) -> dict[str, Any]:
    """The content of plan.json."""
    return plan_document(plan, inspection.requirement, inspection.inputs)


def make_folder(path: str | PathLike[str]) -> Path:
    """The folder, made where it is absent; raises InputError where it cannot be."""
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"this folder cannot be made: {error.strerror}", file=folder, hint="choose another place with -o"
        ) from error
    return folder


def write_plan(plan: Plan, inspection: Inspection, folder: str | PathLike[str]) -> None:
    """Write ``plan.json, settings.csv, assignments.csv, report.html`` into a folder, each whole or not at all."""
    place = make_folder(folder)
    report = render_report(
        plan,
        inspection.part,
        inspection.camera,
        inspection.requirement,
        title=inspection.name,
        inputs={f"{name} (SHA-256)": digest for name, digest in inspection.inputs.items()},
    )
    write_text_atomically(place / "report.html", report)
    write_plan_files(plan, inspection.requirement, inspection.inputs, place)


def write_evaluation(table: xr.Dataset, path: str | PathLike[str]) -> None:
    """Write the table as CSV, Parquet or Zarr, by suffix."""
    write_table(table, path, COLUMNS)
