"""Runs the benchmarks and prints the figures of docs/performance.md.

Usage: python benchmarks/report.py [--from RESULTS.json] [--keep RESULTS.json] [GROUP …]

Without ``--from`` all benchmarks (or those of the groups named) run first, some minutes. A section is a function in
SECTIONS that makes Markdown of the benchmarks of one group.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import platform
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from law_ways import WAYS, hard_pairs, scalar_code
from scipy.integrate import IntegrationWarning

HERE = Path(__file__).resolve().parent
Row = dict[str, Any]
"""One benchmark: the figures that it stated, and ``seconds``, the median of one call."""


def measure(groups: list[str], results: Path) -> None:
    """Run the benchmarks of some groups, or all, in one process; each group is the file ``test_GROUP.py``."""
    files = [str(HERE / f"test_{group}.py") for group in groups] or [str(HERE)]
    command = [sys.executable, "-m", "pytest", *files, "--benchmark-only", f"--benchmark-json={results}"]
    subprocess.run(command, check=True, stdout=sys.stderr)


def rows_of(results: Path) -> dict[str, list[Row]]:
    """The benchmarks of a run, by group."""
    groups: dict[str, list[Row]] = {}
    for benchmark in json.loads(results.read_text())["benchmarks"]:
        row = {**benchmark["extra_info"], "seconds": benchmark["stats"]["median"], "key": benchmark["param"]}
        groups.setdefault(benchmark["group"], []).append(row)
    return groups


def machine() -> str:
    """What the figures were measured on."""
    cpu = platform.processor() or "unknown"
    if (info := Path("/proc/cpuinfo")).exists():
        cpu = next(line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if "model name" in line)
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in ("numpy", "scipy", "numba"))
    return (
        f"Machine: {cpu}, {os.cpu_count()} cores; {platform.system()}; Python {platform.python_version()}, {versions}, "
        f"OpenTURNS {importlib.metadata.version('openturns')}. Medians of several rounds of wall clock; "
        f"load average {os.getloadavg()[0]:.1f} at the end."
    )


def table(columns: list[str], rows: list[list[str]]) -> str:
    """A Markdown table, all columns but the first to the right."""
    lines = ["| " + " | ".join(columns) + " |", "|---|" + "---:|" * (len(columns) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def rounded(value: float) -> str:
    """Three digits, as one would say them."""
    if value == 0 or 0.01 <= value < 1:
        return f"{value:.2g}"
    if 1 <= value < 10:
        return f"{value:.1f}"
    return f"{float(f'{value:.3g}'):,.0f}" if 10 <= value < 1e9 else f"{value:.1e}"


def law(rows: list[Row]) -> str:
    """Speed and error of every way to the probability of one allowed error."""
    ours = next(row["seconds"] / row["count"] for row in rows if row["key"] == "array")
    lines = []
    for row in rows:
        each = row["seconds"] / row["count"]
        errors = ["reference" if row["key"] == "scalar" else f"{row[k]:.0e}" for k in ("largest_error", "median_error")]
        lines.append([row["name"], rounded(1 / each), *errors, rounded(each / ours)])
        if (aim := row["extrapolated_to"]) is not None:  # draws: the cost goes as 1 / accuracy²
            more = (1e-4 / aim) ** 2
            name = f"… extrapolated to {aim:.0e}, as 1 / accuracy²"
            lines.append([name, rounded(1 / each / more), "-", "-", rounded(each * more / ours)])
    columns = ["P(\\|error\\| <= x)", "pairs a second", "largest error", "median error", "times as long"]
    return "\n\n".join([table(columns, lines), "### At hard angles", hard_angles()])


def hard_angles() -> str:
    """Largest error of every way but the slow ones where a segment lies along a pixel axis, or nearly."""
    degrees = (0.0, 1e-9, 1e-4, 0.01, 1.0, 45.0, 90 - 1e-6)
    lines = []
    for key in ("array", "plain", "legendre", "openturns_cdf", "quad"):
        cells = []
        for angle in degrees:
            pairs = hard_pairs(angle)
            try:
                with warnings.catch_warnings(action="ignore", category=IntegrationWarning):
                    error = np.abs(WAYS[key].compute(pairs) - scalar_code(pairs)).max()
                cells.append("not a number" if np.isnan(error) else f"{error:.0e}")
            except (TypeError, ValueError, ZeroDivisionError):
                cells.append("refused")
        lines.append([WAYS[key].name, *cells])
    return table(["Largest error at", *(f"{angle:.8g}°" for angle in degrees)], lines)


def rates(rows: list[Row]) -> str:
    """How many a second, and how long each takes."""
    lines = []
    for row in rows:
        each = row["seconds"] / row["count"]
        flops = f"{row['flops'] / each / 1e9:.1f}" if row.get("flops") else "-"
        lines.append([row["name"], f"{1 / each:,.3g} {row['unit']}".replace("e+0", "e"), f"{each * 1e9:.3g}", flops])
    if all(line[-1] == "-" for line in lines):
        return table(["", "a second", "ns each"], [line[:-1] for line in lines])
    return table(["", "a second", "ns each", "GFLOP/s"], lines)


def stages(rows: list[Row]) -> str:
    """Seconds of each stage of a job."""
    lines = [[row["name"], f"{row['seconds']:.3f}", f"{row['seconds'] / row['count'] * 1e6:.2f}"] for row in rows]
    return table([f"{rows[0]['count']:,} candidates", "seconds", "µs a viewpoint"], lines)


SECTIONS: dict[str, tuple[str, Callable[[list[Row]], str]]] = {
    "law": ("The probability of one allowed error", law),
    "kernel": ("From viewpoint and measurand to probability", rates),
    "visibility": ("Visibility", rates),
    "plan": ("The plan of the example, by stages", stages),
    "limits": ("What the machine can do", rates),
    "tried": ("phi and Phi, ways tried", rates),
}
"""Group of the benchmarks: heading, and the text made of its rows."""


def main() -> None:
    """Measure, unless a file with figures is given, and print."""
    parser = argparse.ArgumentParser(description="The figures of docs/performance.md")
    parser.add_argument("groups", nargs="*", metavar="GROUP", help="groups to run; default: all")
    parser.add_argument("--from", dest="source", type=Path, help="figures of an earlier run, on this machine")
    parser.add_argument("--keep", type=Path, help="where to leave the figures")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        source = options.source or options.keep or Path(folder) / "results.json"
        if options.source is None:
            measure(options.groups, source.absolute())
        groups = rows_of(source)
    print(machine())
    for group, (heading, text) in SECTIONS.items():
        if group in groups:
            print(f"\n## {heading}\n\n{text(groups[group])}")


if __name__ == "__main__":
    main()
