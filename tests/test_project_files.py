"""Files that no other check reads can be read, and say the same as those that are checked."""

from __future__ import annotations

import json
import re
import tomllib
from fnmatch import fnmatch
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from viewgauge.cli.app import app

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
FORMS = sorted((ROOT / ".github/ISSUE_TEMPLATE").glob("*.yml"))


def read(path: str | Path):
    return YAML(typ="safe").load((ROOT / path).read_text())


def dockerfile() -> list[tuple[str, str]]:
    """Its instructions with their arguments, each on one line."""
    text = re.sub(r"^#.*\n", "", (ROOT / "Dockerfile").read_text(), flags=re.MULTILINE)
    lines = text.replace("\\\n", " ").splitlines()
    return [(line.split(maxsplit=1)[0], line.split(maxsplit=1)[1]) for line in lines if line.strip()]


def supported() -> list[str]:
    first, end = re.fullmatch(r">=3\.(\d+),<3\.(\d+)", PROJECT["requires-python"]).groups()
    return [f"3.{minor}" for minor in range(int(first), int(end))]


def test_every_supported_python_is_checked():
    job = read(".github/workflows/ci.yml")["jobs"]["checks"]
    assert job["strategy"]["matrix"]["python"] == supported()
    listed = [entry.rpartition(" ")[2] for entry in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", entry)]
    assert listed == supported()
    assert f"for version in {' '.join(supported())}; do" in (ROOT / ".ci/run").read_text()


def test_the_workflow_runs_all_checks_once():
    job = read(".github/workflows/ci.yml")["jobs"]["checks"]
    assert any(step.get("run") == "bash .ci/run" and "PYTHON" in step["env"] for step in job["steps"])
    assert job["env"]["OTHER_PYTHONS"] == "no"
    assert '"${OTHER_PYTHONS:-yes}" = no' in (ROOT / ".ci/run").read_text()


def test_hooks_need_nothing_from_outside():
    (repository,) = read(".pre-commit-config.yaml")["repos"]
    assert repository["repo"] == "local"
    for hook in repository["hooks"]:
        assert hook["language"] == "system"
        assert hook["entry"].startswith(".venv/bin/")
        command = hook["entry"].removesuffix(" --force-exclude")
        assert command in (ROOT / ".ci/run").read_text()


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.stem)
def test_issue_forms_have_what_forms_need(form):
    document = read(form)
    if form.stem == "config":
        assert isinstance(document["blank_issues_enabled"], bool)
        return
    assert {"name", "description", "body"} <= set(document)
    fields = [field for field in document["body"] if field["type"] != "markdown"]
    assert len({field["id"] for field in fields}) == len(fields) > 0
    for field in document["body"]:
        assert field["type"] in {"markdown", "textarea", "input", "dropdown", "checkboxes"}
        assert field["attributes"]["value" if field["type"] == "markdown" else "label"]


def test_the_citation_is_of_this_version():
    citation = read("CITATION.cff")
    assert {"cff-version", "message", "title", "authors"} <= set(citation)
    assert citation["cff-version"] == "1.2.0"
    assert citation["title"] == PROJECT["name"]
    assert str(citation["version"]) == PROJECT["version"]
    assert citation["license"] == PROJECT["license"]
    (paper,) = citation["references"]
    assert [author["family-names"] for author in paper["authors"]] == ["Yang", "Marefat", "Ciarallo"]
    assert paper["title"].lower() in " ".join((ROOT / "README.md").read_text().split()).lower()


def test_the_container_s_command_is_a_command_of_a_file_that_is_there():
    instructions = dict(dockerfile())
    (program,) = json.loads(instructions["ENTRYPOINT"])
    assert program in PROJECT["scripts"]
    command = json.loads(instructions["CMD"])
    function, bound, _ = app.parse_args(command, exit_on_error=False, print_error=False)
    assert function is app[command[0]].default_command
    inside = bound.arguments["file"].relative_to("/opt/viewgauge")
    assert (ROOT / inside).is_file()


def test_the_container_gets_the_files_that_it_copies_and_is_of_a_supported_python():
    ignored = (ROOT / ".dockerignore").read_text().split("\n")
    let_in = [line[1:] for line in ignored if line.startswith("!")]
    for instruction, arguments in dockerfile():
        if instruction == "COPY":
            for source in arguments.split()[:-1]:
                assert (ROOT / source).exists()
                assert any(fnmatch(source, pattern) for pattern in let_in)
        if instruction == "FROM":
            assert re.fullmatch(r"python:(3\.\d+)-slim", arguments)[1] in supported()
    assert dict(dockerfile())["USER"] != "root"
