"""The page of camera files lists each format of the registry with what it cannot say, and each harmless kind of key."""

from __future__ import annotations

from pathlib import Path

from viewgauge.formats.cameras.camera_formats import CAMERA_FORMATS
from viewgauge.formats.cameras.reading.harmless_keys import HARMLESS_NAMES, HARMLESS_WORDS
from viewgauge.formats.cameras.writing.camera_writers import CAMERA_WRITERS

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "camera_formats.md").read_text(encoding="utf-8")


def rows(table: str) -> list[list[str]]:
    lines = PAGE.partition(table)[2].partition("\n\n")[0].splitlines()
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines if line.startswith("|")][1:]


def test_the_table_is_that_of_the_registry() -> None:
    shown = rows("| format | file |")
    assert [(row[0], row[1], row[3]) for row in shown] == [(f.name, f.described, f.cannot_say) for f in CAMERA_FORMATS]
    pixels = {
        f.name: f.conventions.first_pixel for f in CAMERA_FORMATS if hasattr(f, "conventions")
    }  # the others are compared in their own tests
    assert {row[0]: float(row[2]) for row in shown if row[0] in pixels} == pixels


def test_every_reason_for_a_harmless_key_is_there() -> None:
    text = " ".join(PAGE.split())
    assert [r for r in {*HARMLESS_NAMES.values(), *HARMLESS_WORDS.values()} if r not in text] == []


def test_what_is_written_is_there() -> None:
    assert [name for name in CAMERA_WRITERS if f"`{name}`" not in PAGE] == []
