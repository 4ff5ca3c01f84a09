"""How fast the workbench answers.

Usage: python benchmarks/workbench.py INSPECTION [INSPECTION …]

For each inspection file: its plan is made, then every knob is turned through values that were not asked before.
"computed" is the time of `WhatIf.answers`; "seen" the time from a key that turns a slider in a browser (the system's
Chromium without a GPU) until the changed table stands on the page. Medians and the largest of each.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import time
from dataclasses import replace
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

import viewgauge as vg
from viewgauge.jobs.workbench.what_if import WhatIf
from viewgauge.web import open_workbench

FACTORS = [0.8 + 0.02 * k for k in range(20)]
FIELDS = ("pixel_pitch_mm", "edge_px", "focal_length_mm", "distance", "translation_mm", "rotation_rad")
LABELS = ("Pixel pitch / µm", "Edge location / px", "Focal length / mm", "Distance / % of the planned")
LABELS += ("Pose: translation / mm", "Pose: rotation / deg", "Probability Th")
WITHOUT_GPU = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
KEYS = 6
WAITS_FOR_TABLE = """
() => { window.changed = new Promise((done) => {
  const table = [...document.querySelectorAll("table")].find((t) => t.textContent.includes("Nominal / mm"));
  const place = table.closest(".vg").parentElement, before = place.textContent, start = performance.now();
  const seen = new MutationObserver(() => {
    if (place.textContent === before) return;
    seen.disconnect();
    done(performance.now() - start);
  });
  seen.observe(place.parentElement, { childList: true, subtree: true, characterData: true });
  setTimeout(() => done(null), 5000);
}); }
"""


def computed_ms(what_if: WhatIf) -> list[float]:
    """Of every knob and factor."""
    times = []
    what_if.answers(what_if.today)
    for field in FIELDS:
        for factor in FACTORS:
            knobs = replace(what_if.today, **{field: factor * getattr(what_if.today, field)})
            start = time.perf_counter()
            what_if.answers(knobs)
            times.append(1000 * (time.perf_counter() - start))
    return times


def seen_ms(page: Page) -> list[float]:
    """Of keys that turn each slider; keys that change no number of the table are left out."""
    times = []
    for label in LABELS:
        slider = page.get_by_role("slider", name=label)
        slider.focus()
        for _ in range(KEYS):
            page.wait_for_timeout(700)  # until charts and view, which come after, are there
            page.evaluate(WAITS_FOR_TABLE)
            page.keyboard.press("ArrowLeft")
            took = page.evaluate("() => window.changed")
            if took is not None:
                times.append(float(took))
        page.get_by_role("button", name="As the inspection has it").click()
    return times


def row(what: str, times: list[float]) -> str:
    """Median and largest."""
    return f"{what}: median {statistics.median(times):.0f} ms, largest {max(times):.0f} ms ({len(times)} answers)"


def main() -> None:
    """All inspections."""
    path = next(found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name)))
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=WITHOUT_GPU)
        for file in map(Path, sys.argv[1:]):
            inspection = vg.load(file)
            plan = vg.plan(inspection, prove=False)
            print(f"{inspection.name}: {len(inspection.part.characteristics)} characteristics, {plan.count} viewpoints")
            print(row("  computed", computed_ms(WhatIf(inspection, plan))))
            workbench = open_workbench(file, inspection, plan, port=0)
            page = browser.new_page(viewport={"width": 1400, "height": 900})
            page.goto(workbench.address)
            page.locator(".verdict").wait_for()
            page.wait_for_timeout(5000)
            page.evaluate("for (const b of document.querySelectorAll('.mantine-Notification-closeButton')) b.click()")
            print(row("  seen", seen_ms(page)))
            page.close()
            workbench.close()
        browser.close()


if __name__ == "__main__":
    main()
