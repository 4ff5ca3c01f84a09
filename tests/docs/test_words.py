"""The words that the glossary replaced do not occur where users read: pages, help, messages, examples, templates.

docs/glossary.md says which word stands for what.
"""

from __future__ import annotations

import ast
import io
import re
from collections.abc import Iterator
from contextlib import redirect_stdout
from pathlib import Path

import pytest

from viewgauge.cli.app import app, main

ROOT = Path(__file__).resolve().parents[2]

OLD_WORDS = {
    "setting: say viewpoint": r"\bsensor settings?\b|\bsettings?\b",
    "gauge: say measurand": r"(?<!view)\bgauges?\b(?! capability)",
    "locator: say edge detector": r"\blocators?\b",
    "head: say camera pose, robot, pose uncertainty": r"\bheads?\b",
    "pivot: say frame": r"\bpivots?\b",
    "sure: say probable, probability": r"\bsur(?:e|er|est|ely)\b",
    "homeless: say what is missing": r"\bhomeless\b",
    "unmet: say not met": r"\bunmet\b",
    "callout: say PMI record": r"\bcallouts?\b",
    "unusable: say not measurable": r"\bunusable\b",
    "told: say printed, reported, given": r"\btold\b",
    "even: say uniform": r"\beven (?:error|distribution|law|directions?)\b|\b(?:directions?|distances?|errors?) even\b",
    "fragment": r"\bWhose\.|\bSomebody\b",
    "look: say acquisition": r"\b(?:one|two|each|every|single|several|joint|displaced|first|second|of|per) looks?\b"
    r"|\b(?:a|the) look(?!-)\b|\blooks (?:at most|averaged)\b",
    "exact camera: say full camera model": r"\bexact camera\b(?! pose)",
}
"""Why a word is there no more, and the pattern that finds it; upper and lower case are the same."""

ALLOWED: dict[str, tuple[str, ...]] = {
    # the 1998 paper's term, named once as the origin of "viewpoint"
    "docs/glossary.md": (r"\*sensor setting\* of the 1998 paper",),
    # the field's name of the study that Cg and Cgk come from
    "docs/howto/requirements.md": (r"type 1 gauge study",),
    # the Python parameter of PoseError.from_standard_deviations
    "docs/howto/python.md": (r"pivot_mm=",),
    "docs/howto/full_camera_model.md": (r"pivot_mm=",),
    "README.md": (r"pivot_mm=",),
}
"""Expressions that may stay in a file, each with its reason in a comment."""


def old_words(text: str, allowed: tuple[str, ...] = ()) -> list[str]:
    """Each old word in a text with what surrounds it."""
    for expression in allowed:
        text = re.sub(expression, lambda match: "\n" * match[0].count("\n"), text)
    found = []
    for why, pattern in OLD_WORDS.items():
        for match in re.finditer(pattern, text, re.IGNORECASE):
            line = text.count("\n", 0, match.start()) + 1
            around = text[max(match.start() - 30, 0) : match.end() + 30].replace("\n", " ")
            found.append(f"line {line}: {why}: ...{around}...")
    return found


def require_none(found: list[str]) -> None:
    """Fail with one line for each old word."""
    if found:
        pytest.fail("\n".join(["words of old:", *found]), pytrace=False)


def relative(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def pages() -> list[Path]:
    """README and the documentation; the changelog keeps the words of its time."""
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "mkdocs.yml", *sorted((ROOT / "docs").rglob("*.md"))]


def example_files() -> list[Path]:
    return sorted(path for path in (ROOT / "examples").rglob("*") if path.suffix in {".yaml", ".md"})


def modules() -> list[Path]:
    return sorted((ROOT / "src" / "viewgauge").rglob("*.py"))


def messages(path: Path) -> Iterator[tuple[int, str]]:
    """Line and text of every string of a module that users read: it has a space or begins as a label does.

    Docstrings, which stand alone as a statement, are left out; those of the commands are in the help.
    """
    tree = ast.parse(path.read_text(encoding="utf-8"))
    docstrings = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if not isinstance(node, ast.Constant) or not isinstance(node.value, str) or id(node) in docstrings:
            continue
        if " " in node.value.strip() or re.fullmatch(r"[A-Z][a-z]+\.?", node.value):
            yield node.lineno, node.value


@pytest.mark.parametrize("path", [*pages(), *example_files()], ids=relative)
def test_pages_and_examples_use_the_words_of_the_glossary(path: Path) -> None:
    name = relative(path)
    require_none([f"{name}, {why}" for why in old_words(path.read_text(encoding="utf-8"), ALLOWED.get(name, ()))])


def templates() -> list[Path]:
    """What pages are made of beside Python: HTML, pictures, styles and scripts."""
    suffixes = {".html", ".svg", ".css", ".js"}
    return sorted(path for path in (ROOT / "src" / "viewgauge").rglob("*") if path.suffix in suffixes)


def test_templates_use_the_words_of_the_glossary() -> None:
    found = []
    for path in templates():
        # tags such as <head>, and what the template fills in, are no words
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".js":  # of a script its strings
            text = "\n".join(re.findall(r'"([^"\n]*)"', text))
        text = re.sub(r"\{\{.*?\}\}|\{%.*?%\}|<[^<>]*>", " ", text, flags=re.DOTALL)
        found += [f"{relative(path)}: {why}" for why in old_words(text, ALLOWED.get(relative(path), ()))]
    require_none(found)


@pytest.mark.parametrize("command", ["", *sorted(name for name in app if not name.startswith("-"))])
def test_help_uses_the_words_of_the_glossary(command: str) -> None:
    printed = io.StringIO()
    with redirect_stdout(printed):
        assert main([*([command] if command else []), "--help"]) == 0
    text = re.sub(r"[│╭╮╰╯─]", " ", printed.getvalue())
    assert command in text
    require_none([f"viewgauge {command} --help, {why}" for why in old_words(" ".join(text.split()))])


@pytest.mark.parametrize("path", modules(), ids=relative)
def test_messages_use_the_words_of_the_glossary(path: Path) -> None:
    allowed = ALLOWED.get(relative(path), ())
    require_none(
        [
            f"{relative(path)}:{line}: {why}"
            for line, text in messages(path)
            for why in old_words(text.replace("\n", " "), allowed)
        ]
    )


def test_old_words_are_found_and_others_are_not() -> None:
    assert len(old_words("How surely does the head hold each setting?")) == 3
    assert len(old_words("an even error,\nas he was told; one look more")) == 3
    assert old_words("viewgauge looks for a feature; gauge capability; even so, ahead of the measure") == []


def test_allowed_expressions_are_still_needed() -> None:
    for name, expressions in ALLOWED.items():
        text = (ROOT / name).read_text(encoding="utf-8")
        for expression in expressions:
            assert re.search(expression, text), f"{name} has no {expression} any more"
