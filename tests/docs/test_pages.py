"""The pages' form: lines of prose fit 120 columns, and every page is in the navigation."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.rglob("*.md"))]
COLUMNS = 120


def prose(text: str) -> list[str]:
    """Lines outside of code and formulas that are no row of a table, no heading, no picture and no printed finding."""
    text = re.sub(r"^```.*?^```|^\$\$.*?\$\$", "", text, flags=re.MULTILINE | re.DOTALL)
    return [line for line in text.splitlines() if not re.match(r" {4}|\||#|!\[|- note: |- .*\*\*(not m|out of)", line)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_lines_fit(page: Path) -> None:
    assert [line for line in prose(page.read_text(encoding="utf-8")) if len(line) > COLUMNS] == []


def test_every_page_is_in_the_navigation() -> None:
    navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:\n")[2]
    listed = re.findall(r"([\w/]+\.md)$", navigation, flags=re.MULTILINE)
    assert sorted(listed) == sorted(page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md"))
