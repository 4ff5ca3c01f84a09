"""All pictures of the block's plan, and what the plan would be worth with another pose uncertainty.

Usage: python pictures.py FOLDER

Plans the block, or reads plan/ beside this file if it is there, and writes the pictures as HTML files to the folder.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import viewgauge as vg
from viewgauge.jobs.workbench.what_if import WhatIf

HERE = Path(__file__).parent
OF_ALL, OF_ONE = ("scene", "table", "budget"), ("laws", "accuracy", "directions")


def main(folder: Path) -> None:
    """Draw, and print what the plan would be worth with a camera position that is held more or less well."""
    folder.mkdir(parents=True, exist_ok=True)
    inspection = vg.load(HERE / "inspection.yaml")
    plan = vg.read_plan(HERE / "plan") if (HERE / "plan" / "plan.json").exists() else vg.plan(inspection)
    for what in (*OF_ALL, *OF_ONE):
        chart = vg.plan_chart(inspection, plan, what, "E7" if what in OF_ONE else None)
        vg.write_chart(chart, folder / f"{what}.html", f"{inspection.name}: {what}")
    print(f"{len(OF_ALL) + len(OF_ONE)} pictures in {folder}")

    what_if = WhatIf(inspection, plan)  # what the workbench asks when a knob is turned
    for translation in (0.08, 0.1, 0.12, 0.15):
        answers = what_if.answers(replace(what_if.today, translation_mm=translation))
        weakest = answers.weakest
        assert weakest is not None
        reported = (
            f"{answers.met} of {len(answers.characteristics)} met, weakest {weakest.characteristic.id} "
            f"{weakest.probability:.5f}"
        )
        print(f"position held to {translation} mm: {reported}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
