"""Write what a plan or an evaluation gave."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..exceptions import InputError

if TYPE_CHECKING:  # what takes long to import is imported where it is used
    import xarray as xr

    from ..planning import Plan
    from ..planning.improve.improvement import Improvement, Specification
    from ..planning.inspection import Inspection

__all__ = [
    "describe_answers",
    "describe_plan",
    "output_folder",
    "require_answer_suffix",
    "require_table_name",
    "write_answers",
    "write_evaluation",
    "write_plan",
]


def describe_plan(plan: Plan, inspection: Inspection) -> dict[str, Any]:
    """The content of plan.json."""
    from ..formats.plan.plan_files import plan_document
    from .budgets import capability_of_characteristics, error_budgets

    budgets = error_budgets(inspection, plan)
    figures = capability_of_characteristics(inspection, plan, budgets)
    return plan_document(plan, inspection.requirement, inspection.inputs, budgets, figures, inspection.findings)


def describe_answers(answers: Improvement | Specification, inspection: Inspection) -> dict[str, Any]:
    """What to improve, or cameras for a part, as JSON-ready data."""
    from ..formats.plan.improvement_document import improvement_document, specification_document
    from ..planning.improve.improvement import Improvement

    if isinstance(answers, Improvement):
        return improvement_document(answers, inspection.requirement, inspection.inputs)
    return specification_document(answers, inspection.requirement, inspection.inputs)


def write_answers(answers: Improvement | Specification, inspection: Inspection, path: str | PathLike[str]) -> None:
    """Write what to improve, or cameras for a part, as .json or as a page, .html; whole or not at all.

    Raises
    ------
    InputError
        If the file's suffix is another.
    """
    from ..formats.files.atomic import write_text_atomically
    from ..planning.improve.improvement import Improvement
    from ..report import render_improvement, render_specification

    if require_answer_suffix(path) == ".json":
        document = describe_answers(answers, inspection)
        text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    else:
        name, inputs = inspection.name, {f"{name} (SHA-256)": digest for name, digest in inspection.inputs.items()}
        if isinstance(answers, Improvement):
            text = render_improvement(answers, inspection.requirement, title=name, inputs=inputs)
        else:
            text = render_specification(answers, inspection.requirement, title=name, inputs=inputs)
    write_text_atomically(Path(path), text)


def require_answer_suffix(path: str | PathLike[str]) -> str:
    """The suffix, .json or .html; raises InputError for another."""
    suffix = Path(path).suffix.lower()
    if suffix not in (".json", ".html"):
        raise InputError(
            "unknown kind of file for answers", file=Path(path), got=suffix or "no suffix", expected=".json or .html"
        )
    return suffix


def require_table_name(path: str | PathLike[str]) -> None:
    """Raise InputError unless a table can be written under this name."""
    from ..formats.tables.table_store import require_table_suffix

    require_table_suffix(path)


def make_folder(path: str | PathLike[str]) -> Path:
    """The folder, made where it is absent; raises InputError where it cannot be, or cannot be written to."""
    folder, hint = Path(path), "choose another place with -o"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        raise InputError("this is to be a folder, but there is a file in its place", file=folder, hint=hint) from error
    except OSError as error:
        raise InputError(f"this folder cannot be made: {error.strerror}", file=folder, hint=hint) from error
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError("nothing can be written to this folder", file=folder, hint=hint)
    return folder


@contextmanager
def output_folder(path: str | PathLike[str], *, alone: bool = False) -> Iterator[Path]:
    """A folder for what the block writes, made before any work is done for it.

    If the block fails, the folders that were made are taken away again as far as they are empty.

    Parameters
    ----------
    alone
        All files of the folder belong together: no other process on this machine may write it meanwhile (InputError).
    """
    folder = Path(path)
    absent = [place for place in (folder, *folder.parents) if not os.path.exists(place)]
    try:
        with _claimed(folder) if alone else nullcontext():
            yield make_folder(folder)
    except BaseException:  # KeyboardInterrupt too
        with suppress(OSError):
            for place in absent:
                place.rmdir()
        raise


@contextmanager
def _claimed(folder: Path) -> Iterator[None]:
    """A lock for the folder, kept apart from it; raises InputError where another process holds it."""
    from ..formats.files.lock import lock_folder

    place = os.path.realpath(folder)
    name = f"viewgauge-lock-{hashlib.sha256(os.fsencode(place)).hexdigest()[:24]}"
    locks = Path(tempfile.gettempdir()) / name
    try:
        lock = lock_folder(locks, folder)
    except OSError:  # no place for locks, or another user's
        yield
        return
    try:
        yield
    finally:
        shutil.rmtree(locks, ignore_errors=True)
        lock.release()


def write_plan(plan: Plan, inspection: Inspection, folder: str | PathLike[str]) -> None:
    """Write ``plan.json, viewpoints.csv, assignments.csv, report.html`` into a folder: all of them or none."""
    from ..formats.files.atomic import replaced_in_one_step, write_text_atomically
    from ..formats.plan.plan_files import plan_document, write_plan_files
    from .write_report import plan_details, plan_report

    place = make_folder(folder)
    details = plan_details(plan, inspection)
    report = plan_report(plan, inspection, details)
    document = plan_document(
        plan, inspection.requirement, inspection.inputs, details.budgets, details.figures, inspection.findings
    )
    with replaced_in_one_step(place) as made:
        write_text_atomically(made / "report.html", report)
        write_plan_files(plan, document, made)


def write_evaluation(table: xr.Dataset, path: str | PathLike[str]) -> None:
    """Write the table as CSV, Parquet or Zarr, by suffix."""
    from ..evaluation import COLUMNS
    from ..formats.tables.whole_table import write_table

    optional = ("validity", "probability_low", "probability_high")  # after the standard columns, where there
    write_table(table, path, (*COLUMNS, *(name for name in optional if name in table)))
