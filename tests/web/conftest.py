"""A served workbench, and a browser that looks at it."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "slotted_block"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
WITHOUT_GPU = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
)


@pytest.fixture(scope="session")
def project(tmp_path_factory):
    """A folder with the block and its inspection, with few candidates: it is planned in seconds."""
    folder = tmp_path_factory.mktemp("project")
    shutil.copyfile(EXAMPLE / "slotted_block.step", folder / "slotted_block.step")
    text = (EXAMPLE / "inspection.yaml").read_text(encoding="utf-8")
    few = text.replace("directions: 200", "directions: 40").replace("rolls: 4", "rolls: 2")
    assert few != text
    (folder / "inspection.yaml").write_text(few, encoding="utf-8")
    return folder


@pytest.fixture(scope="session")
def inspection(project):
    import viewgauge as vg

    return vg.load(project / "inspection.yaml")


@pytest.fixture(scope="session")
def plan(inspection):
    import viewgauge as vg

    return vg.plan(replace(inspection), refine=False, prove=False)


@pytest.fixture(scope="session")
def workbench(project, inspection, plan):
    """Served on this machine, at any free port."""
    pytest.importorskip("viser")
    from viewgauge.web import open_workbench

    served = open_workbench(project / "inspection.yaml", inspection, plan, port=0)
    yield served
    served.close()


@pytest.fixture(scope="session")
def browser():
    """The system's Chromium; without one the tests are skipped, but not in CI, which installs it."""
    playwright = pytest.importorskip("playwright.sync_api")
    path = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if path is None:
        if os.environ.get("CI"):
            pytest.fail("CI has to install a browser: scripts/setup.sh")
        pytest.skip("no Chromium or Chrome on this machine: the pages are not looked at")
    playwright.expect.set_options(timeout=60_000)  # of every wait for what a page shows: the machine may be busy
    with playwright.sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=path, args=list(WITHOUT_GPU))
        yield running
        running.close()
