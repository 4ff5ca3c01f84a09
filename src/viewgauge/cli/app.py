"""The commands and their exit codes.

0: done and every dimension met; 1: done, some dimension not met; 2: bad input, one clear message.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, CycloptsError, Parameter

from ..exceptions import ViewgaugeError
from .output import print_check, print_error, print_json, print_plan, print_table_summary
from .progress import Bars

__all__ = ["main"]

_DONE, _NOT_MET, _BAD_INPUT, _INTERRUPTED = 0, 1, 2, 130

_Part = Annotated[Path | None, Parameter(name="--part", help="CAD file or mesh, in place of the file's own.")]
_Json = Annotated[bool, Parameter(name="--json", negative="", help="Print the result as JSON.")]


def _version() -> str:
    from importlib.metadata import version

    return version("viewgauge")


app = App(
    name="viewgauge",
    help="Plan camera poses that measure every toleranced dimension of a part accurately enough.",
    help_format="plaintext",
    version=_version,
    result_action="return_value",
)


@app.command(name="plan")
def _plan(
    file: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    part: _Part = None,
    seed: int | None = None,
    json: _Json = False,
) -> int:
    """Choose the fewest settings that measure every dimension as required.

    Parameters
    ----------
    file
        The inspection file (YAML).
    output
        Folder for plan.json, settings.csv, assignments.csv and report.html.
    seed
        In place of the file's own; the same seed gives the same plan.
    """
    from .. import workflow

    workflow.make_folder(output)
    bars = Bars()
    with bars.stage("Reading the inspection and its part"):
        inspection = workflow.load(file, part=part)
    plan = workflow.plan(inspection, seed=seed, progress=bars)
    with bars.stage("Writing the report"):
        workflow.write_plan(plan, inspection, output)
    document = workflow.describe_plan(plan, inspection)
    if json:
        print_json(document)
    else:
        print_plan(document, str(output))
    return _DONE if plan.all_met else _NOT_MET


@app.command(name="evaluate")
def _evaluate(
    file: Path,
    /,
    *,
    settings: Path | None = None,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    method: Literal["joint", "independent", "monte-carlo"] = "joint",
    draws: int = 100_000,
    part: _Part = None,
    json: _Json = False,
) -> int:
    """Evaluate every dimension from every given setting.

    Parameters
    ----------
    file
        The inspection file (YAML).
    settings
        Settings file (CSV) with id, x, y, z, qw, qx, qy, qz; by default the one that the inspection file names.
    output
        The table: .csv, .parquet or .zarr.
    method
        The error model: joint (both ends of a dimension share the pose error), independent (the 1998 paper's),
        or monte-carlo (the exact camera).
    draws
        Draws for each pair with monte-carlo.
    """
    from .. import workflow

    if output is not None:
        workflow.require_table_suffix(output)
    bars = Bars()
    with bars.stage("Reading the inspection and its part"):
        inspection = workflow.load(file, part=part)
    table = workflow.evaluate(inspection, settings, method=method, draws=draws, progress=bars)
    if output is not None:
        workflow.write_evaluation(table, output)
    best = workflow.best_of_each(table)
    if json:
        print_json({"settings": table.sizes["setting"], "method": method, "best": best})
    else:
        print_table_summary(best, table.sizes["setting"])
        if output is not None:
            print(f"written to {output}")
    everything = workflow.check(inspection)
    all_met = not everything["not_measurable"] and all(row["accepted"] for row in best.values())
    return _DONE if all_met else _NOT_MET


@app.command(name="check")
def _check(file: Path, /, *, part: _Part = None, json: _Json = False) -> int:
    """Validate the inputs and say what was read.

    Parameters
    ----------
    file
        The inspection file (YAML).
    """
    from .. import workflow

    with Bars().stage("Reading the inspection and its part"):
        document = workflow.check(workflow.load(file, part=part))
    if json:
        print_json(document)
    else:
        print_check(document)
    return _NOT_MET if document["not_measurable"] else _DONE


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    logging.getLogger("viewgauge").addHandler(logging.NullHandler())
    given = sys.argv[1:] if arguments is None else list(arguments)
    try:
        result = app(given, exit_on_error=False, print_error=False)
    except CycloptsError as error:
        print(f"viewgauge: {error}\n  hint:     see viewgauge --help", file=sys.stderr)
        return _BAD_INPUT
    except ViewgaugeError as error:
        print_error(error, as_json="--json" in given)
        return _BAD_INPUT
    except KeyboardInterrupt:
        print("viewgauge: interrupted; nothing was left half-written", file=sys.stderr)
        return _INTERRUPTED
    return result if isinstance(result, int) else _DONE
