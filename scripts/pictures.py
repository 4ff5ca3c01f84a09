"""Make the pictures of the report and the workbench in the documentation.

Usage: python scripts/pictures.py [FOLDER_OF_NIST_STEP_FILES]

Writes docs/pictures/*.png with the system's Chromium, driven by Playwright; with the folder also those of NIST CTC-02,
whose STEP file is not in this repository.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

import viewgauge as vg
from viewgauge.web import open_workbench

ROOT = Path(__file__).resolve().parents[1]
PICTURES = ROOT / "docs" / "pictures"
BLOCK = ROOT / "examples" / "slotted_block" / "inspection.yaml"
WITHOUT_GPU = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


def save(content: bytes, name: str) -> None:
    """Write a screenshot."""
    image = Image.open(BytesIO(content)).convert("RGB")
    image.save(PICTURES / name, optimize=True)
    print(f"{name}: {image.size[0]} x {image.size[1]}, {(PICTURES / name).stat().st_size // 1000} kB")


def shoot_report(browser: Browser, plan: vg.Plan, inspection: vg.Inspection) -> None:
    """The upper part of the report, and a characteristic's laws."""
    with tempfile.TemporaryDirectory() as folder:
        vg.write_plan(plan, inspection, folder)
        page = browser.new_page(viewport={"width": 1320, "height": 860})
        page.goto((Path(folder) / "report.html").as_uri())
        page.wait_for_timeout(3000)
        save(page.screenshot(), "slotted_block_report.png")
        page.set_viewport_size({"width": 1320, "height": 620})
        page.locator("details.law").nth(0).locator("summary").click()
        page.locator("#views").scroll_into_view_if_needed()
        page.evaluate("document.getElementById('views').scrollIntoView()")
        page.set_viewport_size({"width": 1320, "height": 1180})
        page.wait_for_timeout(1500)
        save(page.screenshot(), "report_views_and_laws.png")
        page.close()


@contextmanager
def visited(browser: Browser, path: Path, inspection: vg.Inspection, plan: vg.Plan, height: int) -> Iterator[Page]:
    """The page of a workbench, settled and without notifications."""
    workbench = open_workbench(path, inspection, plan, port=0)
    page = browser.new_page(viewport={"width": 1500, "height": height})
    try:
        page.goto(workbench.address)
        page.locator(".verdict").wait_for()
        page.wait_for_timeout(4000)
        page.evaluate("for (const b of document.querySelectorAll('.mantine-Notification-closeButton')) b.click()")
        page.wait_for_timeout(1000)
        yield page
    finally:
        page.close()
        workbench.close()


def folder(page: Page, name: str, *, opened: bool = True) -> None:
    """Open or close a folder of controls."""
    button = page.get_by_role("button", name=name, exact=True)
    if button.get_attribute("aria-expanded") != str(opened).lower():
        button.click()
        page.wait_for_timeout(500)


def choose(page: Page, dropdown: str, name: str) -> None:
    """Choose from a list."""
    page.get_by_label(dropdown, exact=True).first.click()
    page.get_by_role("option", name=name, exact=True).click()


def turn(page: Page, label: str, value: str) -> None:
    """Type the number of a knob."""
    box = page.get_by_role("textbox", name=label)
    box.fill(value)
    box.press("Enter")


def shoot_block(browser: Browser, plan: vg.Plan, inspection: vg.Inspection) -> None:
    """The block: as planned, and with a position that is held less well, dark, from all directions."""
    with visited(browser, BLOCK, inspection, plan, 940) as page:
        folder(page, "Show")
        page.get_by_label("Names of the characteristics").check()
        page.get_by_role("button", name="the part").click()
        folder(page, "Show", opened=False)
        page.get_by_role("tab", name="Characteristic", exact=True).click()
        choose(page, "Characteristic", "E7")
        page.wait_for_timeout(3000)
        save(page.screenshot(), "workbench.png")
        turn(page, "Pose: translation / mm", "0.13")
        folder(page, "What if …", opened=False)
        folder(page, "Show")
        page.get_by_role("button", name="everything", exact=True).click()
        for switch in ("Directions of the chosen characteristic", "Dark page"):
            page.get_by_label(switch).check()
        page.get_by_label("Names of the characteristics").uncheck()
        page.mouse.move(1250, 700)
        page.mouse.wheel(0, 1500)
        page.wait_for_timeout(4000)
        save(page.screenshot(), "workbench_directions.png")


def shoot_ctc_02(browser: Browser, steps: Path) -> None:
    """NIST's CTC-02 with what one of its viewpoints sees."""
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "inspection.yaml"
        shutil.copyfile(ROOT / "examples" / "nist" / "ctc_02.yaml", path)
        shutil.copyfile(steps / "nist_ctc_02_asme1_ap242-e2.stp", Path(place) / "nist_ctc_02_asme1_ap242-e2.stp")
        inspection = vg.load(path)
        plan = vg.plan(inspection)
        with visited(browser, path, inspection, plan, 860) as page:
            folder(page, "Show")
            page.get_by_label("See through the part").check()
            page.get_by_role("button", name="the part").click()
            folder(page, "Show", opened=False)
            page.get_by_role("tab", name="Characteristic", exact=True).click()
            choose(page, "Characteristic", "Linear Size.3")
            page.get_by_role("tab", name="Viewpoint", exact=True).click()
            page.wait_for_timeout(3000)
            save(page.screenshot(), "workbench_ctc_02.png")


def main() -> None:
    """All pictures."""
    inspection = vg.load(BLOCK)
    plan = vg.plan(inspection)
    path = next(found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name)))
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=WITHOUT_GPU)
        shoot_report(browser, plan, inspection)
        shoot_block(browser, plan, inspection)
        if len(sys.argv) > 1:
            shoot_ctc_02(browser, Path(sys.argv[1]))
        browser.close()


if __name__ == "__main__":
    main()
