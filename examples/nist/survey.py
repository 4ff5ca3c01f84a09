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


COLUMNS = (
    *(
        "part",
        "unit",
        "pmi_records",
        "with tolerance",
        "PLUS_MINUS_TOLERANCE",
        "characteristics with measurands",
        "measurands",
    ),
    *("candidates", "viewpoints", "least of those known", "least anywhere", "met", "not met", "not measurable"),
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
        for status in ("met", "not_met", "not_measurable")
    }
    pmi_records = {d.id.rsplit("/", 1)[0] if "/" in d.id else d.id for d in plan.characteristics}
    toleranced = {d.id.rsplit("/", 1)[0] if "/" in d.id else d.id for d in plan.characteristics if d.tolerance_mm}
    plus_minus = part_file.read_text(errors="replace").count("PLUS_MINUS_TOLERANCE(")
    measurands = sum(len(d.measurands) for d in inspection.part.characteristics)
    met = by_status["met"]
    weakest = min((d.probability for d in met), default=float("nan"))
    anywhere = "?" if plan.anywhere is None else plan.anywhere.count
    cells = (
        inspection_file.stem.upper().replace("_", "-"),
        inspection.part.length_unit,
        len(pmi_records),
        len(toleranced),
        plus_minus,
        len(inspection.part.characteristics),
        measurands,
        plan.candidate_count,
        plan.count,
        plan.lower_bound,
        anywhere,
        len(met),
        len(by_status["not_met"]),
        len(by_status["not_measurable"]),
        f"{weakest:.4f}",
    )
    reasons = [
        f"- {d.id}, {d.nominal_mm:.6g} mm, allowed error {d.allowed_error_mm:.3g} mm: **not met**, best probability "
        f"{d.probability:.4f}; {d.limit}. {d.proof[0].upper()}{d.proof[1:]}"
        for d in by_status["not_met"]
    ]
    reasons += [f"- {d.id}: **not measurable**; {d.limit}" for d in by_status["not_measurable"]]
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
    print(f"Made by `{COMMAND}`, with the inspection files of `examples/nist/`: 12 megapixels, a 25 mm lens,")
    print("0.1 px edges, a camera pose good to 0.05 mm and 0.01 deg; 10 % of the tolerance at 95 %.\n")
    print(
        "A PMI record is one characteristic of the semantic PMI; on a pattern it is one characteristic per "
        "feature. Viewpoints are "
        "those of the refined plan, beside the proven least number among all viewpoints known, and over all poses that "
        "the region allows. Where more PMI records have a tolerance than the file has PLUS_MINUS_TOLERANCE "
        "entities, the "
        "others are toleranced by limits, as the notes say.\n"
    )
    print(table_row(COLUMNS))
    print(table_row(["---"] * len(COLUMNS)))
    print("\n".join(rows))
    print("\n".join(details))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
