"""docs/paper/equations.md lists every equation once, and every function it names exists and is documented."""

import re
from importlib import import_module
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "paper" / "equations.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE.splitlines() if re.match(r"\| \(\d+\) \|", line)
]
LINKS = re.findall(r"\[`(viewgauge[\w.]*)`\]\(\.\./([\w/]+\.md)#([\w.]+)\)", PAGE)


def resolve(name: str) -> object:
    """The object of a dotted name: modules as far as they go, then attributes."""
    parts = name.split(".")
    thing = import_module(parts[0])
    for k, part in enumerate(parts[1:], start=1):
        thing = getattr(thing, part) if hasattr(thing, part) else import_module(".".join(parts[: k + 1]))
    return thing


def test_every_equation_has_one_row_with_a_function():
    assert [row[0] for row in ROWS] == [f"({k})" for k in range(1, 23)]
    assert all("`viewgauge." in row[2] for row in ROWS)


@pytest.mark.parametrize("name", sorted({link[0] for link in LINKS}))
def test_named_function_exists(name):
    thing = resolve(name)
    assert thing.__doc__


@pytest.mark.parametrize("link", sorted(set(LINKS)))
def test_link_leads_to_a_page_that_documents_it(link):
    name, page, anchor = link
    assert anchor == name
    documented = re.findall(r"^::: ([\w.]+)", (DOCS / page).read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert any(name == entry or name.startswith(f"{entry}.") for entry in documented)


def test_every_erratum_that_is_linked_has_its_section():
    sections = set(re.findall(r"\{ #(e\d+) \}", (DOCS / "paper" / "errata.md").read_text(encoding="utf-8")))
    assert set(re.findall(r"errata\.md#(e\d+)", PAGE)) <= sections
    assert sections == {f"e{k}" for k in range(1, 21)}
