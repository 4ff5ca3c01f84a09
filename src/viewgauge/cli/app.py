"""The commands and their exit codes.

0: done and every characteristic met; 1: done, some characteristic not met; 2: bad input, one clear message.
"""

from __future__ import annotations

import atexit
import gc
import logging
import sys
from collections.abc import Sequence
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, CycloptsError, Parameter

import viewgauge as vg

from ..exceptions import ViewgaugeError
from .camera import camera
from .characterize import characterize
from .convert import convert
from .features import features
from .images import measure, simulate, validate
from .improve import improve, specify
from .options import DONE, NOT_MET, Chunk, Json, PartFile, Scheduler, Seed, Workers
from .plot import plot
from .schema import schema
from .terminal.first_run import report_compiling
from .terminal.output import print_check, print_error, print_json, print_plan, print_table_summary
from .terminal.progress import Bars
from .terminal.reading import read_inspection
from .terminal.streams import OutputError, discard_output, open_standard_streams, plain_output
from .workbench import workbench

__all__ = ["main"]

_BAD_INPUT = 2
_INTERRUPTED, _NOBODY_READS = 130, 141  # as shells number the signals SIGINT and SIGPIPE

# as execution/chunks.py and planning/cover/minimum_cover.py have them, which take long to import; a test compares
_VIEWPOINTS_PER_CHUNK, _TIME_LIMIT_S = 16_384, 60.0


def _version() -> str:
    from importlib.metadata import version

    return version("viewgauge")


app = App(
    name="viewgauge",
    help="Plan camera poses that measure every toleranced characteristic of a part accurately enough.",
    help_format="plaintext",
    version=_version,
    result_action="return_value",
    suppress_keyboard_interrupt=False,  # main says what became of the files
)


@app.command(name="plan")
def _plan(
    file: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    part: PartFile = None,
    seed: Seed = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    chunk: Chunk = _VIEWPOINTS_PER_CHUNK,
    refine: bool = True,
    prove: bool = True,
    time_limit: float = _TIME_LIMIT_S,
    gap: float = 0.0,
    json: Json = False,
) -> int:
    """Choose the fewest viewpoints that measure every characteristic as required.

    A long job that was stopped goes on where it was when it is started again.
    Ctrl-C while viewpoints are chosen or refined ends that step: the plan is the best so far.

    Parameters
    ----------
    file
        Read this inspection file (YAML).
    output
        Write plan.json, viewpoints.csv, assignments.csv and report.html to this folder.
    refine
        Improve the viewpoints over all poses that the region allows; --no-refine takes the best of the candidates.
    prove
        Bound the number of viewpoints, and what is not met, over all poses that the region allows.
    time_limit
        Spend at most this many seconds on each search: for the fewest, the most probable and better viewpoints.
    gap
        End the search for the fewest viewpoints when the lower bound is within this share of their number.
    """
    from ..jobs.write import describe_plan, output_folder

    bars = Bars()
    with output_folder(output, alone=True):
        inspection = read_inspection(file, part, meanwhile=lambda: vg.plan)  # which imports it
        with vg.open_executor(scheduler, workers) as executor:
            plan = vg.plan(
                inspection,
                seed=seed,
                progress=bars,
                executor=executor,
                viewpoints_per_chunk=chunk,
                journal=output / ".partial",
                refine=refine,
                prove=prove,
                time_limit_s=time_limit,
                gap=gap,
            )
        with bars.stage("Writing the report"):
            vg.write_plan(plan, inspection, output)
    document = describe_plan(plan, inspection)
    if json:
        print_json(document)
    else:
        print_plan(document, str(output))
    return DONE if plan.all_met else NOT_MET


@app.command(name="evaluate")
def _evaluate(
    file: Path,
    /,
    *,
    viewpoints: Path | None = None,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    method: Literal["joint", "independent", "monte-carlo"] = "joint",
    precision: float = 1e-3,
    sampled: Annotated[bool, Parameter(negative="")] = False,
    columns: str | None = None,
    part: PartFile = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    chunk: Chunk = _VIEWPOINTS_PER_CHUNK,
    json: Json = False,
) -> int:
    """Evaluate every characteristic from every given viewpoint.

    A Zarr table that was interrupted goes on where it was when the same command is given again.

    Parameters
    ----------
    file
        Read this inspection file (YAML).
    viewpoints
        Read viewpoints (id, x, y, z, qw, qx, qy, qz) from this CSV file; by default from the inspection file's.
    output
        Write the table to this file: .csv, .parquet or .zarr.
    method
        Use the joint error model, the independent one of the 1998 paper, or the full camera model (monte-carlo).
    precision
        With monte-carlo, sample until the 99 % confidence interval of each probability has this half-width.
    sampled
        Evaluate the candidates that a plan would sample, in place of given viewpoints.
    columns
        Write these columns, separated by commas; by default all.
    """
    from ..jobs.write import output_folder, require_table_name

    if output is not None:
        require_table_name(output)
    bars = Bars()
    with output_folder(output.parent) if output is not None else nullcontext():
        inspection = read_inspection(file, part, meanwhile=lambda: vg.evaluate_into)  # which imports it
        with vg.open_executor(scheduler, workers) as executor:
            evaluation = vg.evaluate_into(
                inspection,
                output,
                viewpoints,
                sampled=sampled,
                columns=None if columns is None else [name.strip() for name in columns.split(",")],
                method=method,
                precision=precision,
                progress=bars,
                executor=executor,
                viewpoints_per_chunk=chunk,
            )
    best, count = evaluation.best_of_each(), evaluation.viewpoints
    refused = vg.check(inspection)["not_measurable"]
    if json:
        print_json({"viewpoints": count, "method": method, "best": best, "not_measurable": refused})
    else:
        print_table_summary(best, refused, count, method)
        if output is not None:
            print(f"written to {output}")
    return DONE if not refused and all(row["accepted"] for row in best.values()) else NOT_MET


@app.command(name="check")
def _check(file: Path, /, *, part: PartFile = None, json: Json = False) -> int:
    """Validate the inputs and report what was read.

    Parameters
    ----------
    file
        Read this inspection file (YAML).
    """

    document = vg.check(read_inspection(file, part, may_be_empty=True))
    if json:
        print_json(document)
    else:
        print_check(document)
    return NOT_MET if document["not_measurable"] else DONE


app.command(improve, name="improve")
app.command(specify, name="specify")
app.command(characterize, name="characterize")
app.command(camera, name="camera")
app.command(features, name="features")
app.command(convert, name="convert")
app.command(simulate, name="simulate")
app.command(measure, name="measure")
app.command(validate, name="validate")
app.command(workbench, name="workbench")
app.command(plot, name="plot")
app.command(schema, name="schema")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    if arguments is None:  # the process is this command and nothing else
        # Imports make a great many objects and no garbage: looking for some, as often as by default and once more
        # as the process ends, takes most of a second.
        gc.set_threshold(100_000, 50, 50)
        atexit.register(gc.freeze)
        report_compiling()
        open_standard_streams()
    logging.getLogger("viewgauge").addHandler(logging.NullHandler())
    given = sys.argv[1:] if arguments is None else list(arguments)
    with plain_output(escape=not {"--help", "-h"} & {*given} and bool(given)):
        return _run(given)


def _run(given: Sequence[str]) -> int:
    try:
        result = app(given, exit_on_error=False, print_error=False)
        sys.stdout.flush()
    except CycloptsError as error:
        print(f"viewgauge: {error}\n  hint:     see viewgauge --help", file=sys.stderr)
        return _BAD_INPUT
    except ViewgaugeError as error:
        print_error(error, as_json="--json" in given)
        return _BAD_INPUT
    except (KeyboardInterrupt, SystemError) as error:
        # Ctrl-C while compiled code hands over its result comes as a SystemError that is caused by it
        if not isinstance(error, KeyboardInterrupt) and not isinstance(error.__cause__, KeyboardInterrupt):
            raise
        what = "nothing was left half-written, and a long job goes on when started again"
        print(f"viewgauge: interrupted; {what}", file=sys.stderr)
        return _INTERRUPTED
    except OutputError as error:
        discard_output()
        with suppress(OutputError):
            print(f"viewgauge: {error}", file=sys.stderr)
        return _BAD_INPUT
    except BrokenPipeError:  # such as "| head": no more can be told
        discard_output()
        return _NOBODY_READS
    return result if isinstance(result, int) else DONE
