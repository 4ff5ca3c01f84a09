"""Plan the five NIST CTC parts and print what was read, made into measurands, met, and why not, as Markdown.

Usage: python survey.py FOLDER_OF_STEP_FILES
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import viewgauge as vg

HERE = Path(__file__).resolve().parent
COMMAND = "python examples/nist/survey.py FOLDER_OF_STEP_FILES > docs/nist.md"
INTRODUCTION = f"""This page is made by `{COMMAND}`
with the inspection files of `examples/nist/`: 12 megapixels, a 25 mm lens, edges located to 0.1 px, a pose uncertainty
of 0.05 mm and 0.01 deg, and a requirement of 10 % of the tolerance with a probability of 95 %.

A dimension or a geometric tolerance is one record of the semantic PMI; on a pattern it makes one characteristic per
feature. Both counts are of records with a tolerance, and are found in the text of the file by other code than the
reader's. *Viewpoints* are those of the refined plan. The next two columns are the proven least numbers among all known
viewpoints and over all poses that the region allows. Below the table stand, for each part, the characteristics that
are not met, those that are not measured, with the reason, and the basic and reference dimensions.
"""

DIMENSIONS = ("angle", "diameter", "distance", "length", "other", "radius")
COLUMNS = (
    *(
        "part",
        "unit",
        "toleranced dimensions",
        "geometric tolerances",
        "characteristics",
        "characteristics with measurands",
        "measurands",
    ),
    *(
        "candidates",
        "viewpoints",
        "least of those known",
        "least anywhere",
        "met",
        "not met",
        "not measurable",
        "out of scope",
    ),
    "weakest probability",
)


def table_row(cells: Sequence[object]) -> str:
    """One row of a Markdown table."""
    return f"| {' | '.join(str(cell) for cell in cells)} |"


def survey(inspection_file: Path, part_file: Path) -> tuple[str, list[str]]:
    """The row of one part in the table, and the lines on what is not met."""
    inspection = vg.load(inspection_file, part=part_file)
    plan = vg.plan(inspection)
    by_status = {
        status: [d for d in plan.characteristics if d.status == status]
        for status in ("met", "not_met", "not_measurable", "out_of_scope")
    }
    counts = inspection.part.pmi_counts
    dimensions = sum(count for kind, count in counts.items() if kind in DIMENSIONS)
    measurands = sum(len(d.measurands) for d in inspection.part.characteristics)
    met = by_status["met"]
    weakest = min((d.probability for d in met), default=float("nan"))
    anywhere = "?" if plan.anywhere is None else plan.anywhere.count
    cells = (
        inspection_file.stem.upper().replace("_", "-"),
        inspection.part.length_unit,
        dimensions,
        sum(counts.values()) - dimensions,
        len(plan.characteristics),
        len(inspection.part.characteristics),
        measurands,
        plan.candidate_count,
        plan.count,
        plan.lower_bound,
        anywhere,
        len(met),
        len(by_status["not_met"]),
        len(by_status["not_measurable"]),
        len(by_status["out_of_scope"]),
        f"{weakest:.4f}",
    )
    reasons = [
        f"- {d.id}, {d.nominal_mm:.6g} mm, allowed error {d.allowed_error_mm:.3g} mm: **not met**, best probability "
        f"{d.probability:.4f}; {d.limit}. {d.proof[0].upper()}{d.proof[1:]}"
        for d in by_status["not_met"]
    ]
    for status, words in (("not_measurable", "not measurable"), ("out_of_scope", "out of scope")):
        reasons += [f"- {d.id}, {d.indication.text}: **{words}**; {d.limit}" for d in by_status[status]]
    reasons += [f"- {d.id}, {d.indication.text}: nothing is demanded" for d in plan.without_tolerance]
    return table_row(cells), [*reasons, *(f"- note: {note}" for note in inspection.part.notes)]


def main(folder: Path) -> None:
    """Print the page."""
    rows, details = [], []
    for inspection_file in sorted(HERE.glob("ctc_*.yaml")):
        number = inspection_file.stem.removeprefix("ctc_")
        part_file = next(iter(sorted(folder.glob(f"nist_ctc_{number}_*_ap242*.stp"))), None)
        if part_file is None:
            sys.exit(f"no nist_ctc_{number}_*_ap242*.stp in {folder}")
        row, reasons = survey(inspection_file, part_file)
        rows.append(row)
        details += [f"\n## {inspection_file.stem.upper().replace('_', '-')}\n", *reasons]
    print("# The NIST CTC parts\n")
    print(INTRODUCTION)
    print(table_row(COLUMNS))
    print(table_row(["---"] * len(COLUMNS)))
    print("\n".join(rows))
    print("\n".join(details))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
