"""The report in a browser: it opens from disk, fetches nothing, and its filter, charts and prints work."""

from __future__ import annotations

import re

import pytest

import viewgauge as vg

playwright = pytest.importorskip("playwright.sync_api")
expect = playwright.expect
expect.set_options(timeout=30_000)  # 5 s by default, which drawing without a GPU may take on a busy machine


@pytest.fixture(scope="module")
def report(plan, inspection, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    vg.write_plan(plan, inspection, folder)
    return (folder / "report.html").as_uri()


@pytest.fixture(scope="module")
def page(browser, report):
    """For all tests, each of which leaves it usable for the others: drawing it without a GPU takes seconds."""
    context = browser.new_context(viewport={"width": 1100, "height": 800})
    page = context.new_page()
    complaints, requests = [], []
    page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(report)
    yield page
    context.close()
    assert complaints == []
    assert [url for url in requests if not url.startswith(("file:", "data:", "blob:"))] == []


def test_rows_are_found_by_words_and_status(page, plan):
    rows = page.locator("#characteristic-table tbody tr")
    total = len(plan.characteristics)
    reported = page.locator("form.filter output")
    expect(reported).to_have_text(f"{total} characteristics")
    page.get_by_label("Find").fill("diameter")
    diameters = [d for d in plan.characteristics if d.kind == "diameter"]
    expect(reported).to_have_text(f"{len(diameters)} of {total} characteristics")
    assert rows.locator("visible=true").count() == len(diameters)
    page.get_by_label("Find").fill("")
    page.get_by_label("Show").select_option("met")
    met = sum(d.status == "met" for d in plan.characteristics)
    expect(reported).to_have_text(f"{total} characteristics" if met == total else f"{met} of {total} characteristics")
    page.get_by_label("Show").select_option("")
    expect(reported).to_have_text(f"{total} characteristics")


def test_laws_are_drawn_when_they_are_opened(page, plan):
    assert page.locator("#law-0-0 .main-svg").count() == 0
    page.locator("details.law summary").first.press("Enter")
    weakest = min(plan.characteristics, key=lambda d: (d.status == "met", d.probability))
    expect(page.locator("#law-0-0 .gtitle")).to_have_text(re.compile(f"Error of {re.escape(weakest.id)}"))
    expect(page.locator("#law-0-1 .gtitle")).to_be_attached()


def test_sections_are_reached_from_the_top(page):
    page.get_by_role("navigation").get_by_role("link", name="Error budget").click()
    expect(page.locator("#budget")).to_be_in_viewport()


def test_it_is_dark_where_the_browser_is_and_light_when_printed(page):
    page.emulate_media(color_scheme="dark")
    expect(page.locator("body")).to_have_css("background-color", "rgb(18, 24, 31)")
    page.emulate_media(color_scheme="dark", media="print")
    expect(page.locator("body")).to_have_css("background-color", "rgb(255, 255, 255)")
    expect(page.get_by_role("navigation", include_hidden=True)).to_be_hidden()
    assert page.locator("details.law:not([open])").first.is_hidden()
    pdf = page.pdf(format="A4")
    page.emulate_media(color_scheme="light", media="screen")
    assert pdf.startswith(b"%PDF")
    assert 1 < len(re.findall(rb"/Type\s*/Page\b", pdf)) <= 12
