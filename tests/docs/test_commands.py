"""What the pages show is accepted by the program: commands, files, sections of the inspection file, printed output."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from cyclopts import CycloptsError
from ruamel.yaml import YAML

from viewgauge.cli.app import app, main
from viewgauge.formats.inspection.inspection_file import read_inspection_file

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
EXAMPLE = ROOT / "examples" / "slotted_block"
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted(DOCS.rglob("*.md")),
    *sorted(ROOT.glob("examples/*/*.md")),
]
SECTIONS = {
    "part",
    "camera",
    "pose_uncertainty",
    "requirement",
    "candidates",
    "observation",
    "averaging",
    "accept",
    "seed",
}

# a camchain of Kalibr, which has a camera of the name that docs/howto/camera.md asks for
CAMCHAIN = """cam0:
  camera_model: pinhole
  intrinsics: [4637.2, 4638.1, 1221.4, 1026.7]
  distortion_model: radtan
  distortion_coeffs: [-0.142, 0.061, 2.0e-04, -1.0e-04]
  resolution: [2448, 2048]
"""


def text_of(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def relative(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def commands(page: Path) -> list[str]:
    """Commands that stand on a line of their own, or alone between backticks, without what is to be filled in."""
    alone = re.findall(r"^ {4}(viewgauge .+?)(?: {2,}#.*)?$", text_of(page), flags=re.MULTILINE)
    inline = re.findall(r"`(viewgauge [a-z]+ [^`\[]+)`", text_of(page))
    return [" ".join(command.split()) for command in (*alone, *inline) if "…" not in command]


SHOWN = sorted({(relative(page), command) for page in PAGES for command in commands(page)})


@pytest.mark.parametrize(("page", "command"), SHOWN)
def test_shown_command_is_one_of_the_program(page: str, command: str) -> None:
    try:
        app.parse_args(shlex.split(command)[1:], exit_on_error=False, print_error=False)
    except CycloptsError as error:
        pytest.fail(f"{page} shows: {command}\n{error}", pytrace=False)


@pytest.mark.parametrize("page", PAGES, ids=relative)
def test_named_files_exist(page: Path) -> None:
    """Scripts, tests, modules and folders that a page names between backticks or in a command."""
    text = text_of(page)
    named = re.findall(r"(?:python|pytest|sh) ((?:examples|benchmarks|scripts|tests)/[\w/.-]+)", text)
    named += re.findall(r"`(tests/[\w/]+\.py)", text)
    missing = [name for name in named if not (ROOT / name).exists()]
    modules = re.findall(r"`((?:[a-z_]+/)+[a-z_]+\.py|(?:src|tests|part)/(?:[a-z_]+/)*)`", text)
    missing += [
        name
        for name in modules
        if not any((base / name).exists() for base in (ROOT, ROOT / "src", ROOT / "src" / "viewgauge", page.parent))
    ]
    assert missing == []


def sections(page: Path) -> list[dict[str, object]]:
    """Sections of an inspection file that a page shows; each block is read by a plain YAML 1.2 parser."""
    blocks = re.findall(r"```yaml\n(.*?)```", text_of(page), flags=re.DOTALL)
    read = [YAML(typ="safe").load(block) for block in blocks]
    return [block for block in read if set(block) <= SECTIONS]


def with_section(inspection: dict[str, object], shown: dict[str, object]) -> dict[str, object]:
    """An inspection file with what a block shows in the place of what it had.

    A requirement and a pose uncertainty are shown whole, of other sections only some keys.
    """
    changed = dict(inspection)
    for name, value in shown.items():
        if name in {"part", "camera", "candidates"}:
            before = dict(changed.get(name, {}))
            if "calibration" in value:
                for key in ("focal_length", "resolution", "principal_point", "distortion"):
                    before.pop(key, None)
            if "focal_length" in value:
                for key in ("calibration", "calibration_camera"):
                    before.pop(key, None)
            changed[name] = before | value
        else:
            changed[name] = value
    return changed


@pytest.mark.parametrize("page", [page for page in PAGES if sections(page)], ids=relative)
def test_shown_sections_are_read(page: Path, tmp_path: Path) -> None:
    inspection = YAML(typ="safe").load((EXAMPLE / "inspection.yaml").read_text(encoding="utf-8"))
    covariance = re.search(r"```yaml\n(covariance:.*?)```", text_of(DOCS / "howto" / "covariance.md"), flags=re.DOTALL)
    assert covariance is not None
    for name in ("flange.yaml", "robot.yaml"):
        (tmp_path / name).write_text(covariance[1], encoding="utf-8")
    (tmp_path / "camera.yaml").write_text(CAMCHAIN, encoding="utf-8")
    for k, shown in enumerate(sections(page)):
        inspection = with_section(inspection, shown)
        file = tmp_path / f"inspection_{k}.yaml"
        YAML(typ="safe").dump(inspection, file)
        read_inspection_file(file)


@pytest.fixture(scope="module")
def tutorial() -> list[str]:
    """Blocks of output that the tutorial shows."""
    return re.findall(r"```text\n(.*?)```", text_of(DOCS / "tutorial.md"), flags=re.DOTALL)


def require_lines(shown: str, printed: str) -> None:
    """Every shown line is printed, in this order; an ellipsis stands for some that are left out."""
    rest = printed.splitlines()
    for line in shown.splitlines():
        if line.strip() == "...":
            continue
        assert line in rest, f"not printed: {line}\nbut: {rest}"
        rest = rest[rest.index(line) + 1 :]


def test_tutorial_shows_what_is_printed(
    tutorial: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("OCP")
    monkeypatch.chdir(tmp_path)
    for name in ("inspection.yaml", "slotted_block.step"):
        (tmp_path / name).write_bytes((EXAMPLE / name).read_bytes())
    checked, planned, viewpoints, evaluated, _ = tutorial
    assert main(["check", "inspection.yaml"]) == 0
    require_lines(checked, capsys.readouterr().out)
    assert main(["plan", "inspection.yaml", "-o", "plan"]) == 0
    require_lines(planned, capsys.readouterr().out)
    written = (tmp_path / "plan" / "viewpoints.csv").read_text(encoding="utf-8")
    assert written.startswith(viewpoints.removesuffix("...\n"))
    main(["evaluate", "inspection.yaml", "--viewpoints", "plan/viewpoints.csv", "--method", "monte-carlo"])
    require_lines(evaluated, capsys.readouterr().out)


def test_features_page_shows_what_is_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("OCP")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "slotted_block.step").write_bytes((EXAMPLE / "slotted_block.step").read_bytes())
    page = DOCS / "howto" / "features.md"
    (shown,) = re.findall(r"```text\n(.*?)```", text_of(page), flags=re.DOTALL)
    listing, proposing = commands(page)[:2]
    assert main(shlex.split(listing)[1:]) == 0
    require_lines(shown, capsys.readouterr().out)
    assert main(shlex.split(proposing)[1:]) == 0
    (part,) = sections(page)
    other = YAML(typ="safe").load((EXAMPLE / "inspection.yaml").read_text(encoding="utf-8"))
    proposed = YAML(typ="safe").load((tmp_path / "inspection.yaml").read_text(encoding="utf-8"))
    for section, code in ((proposed, 0), (part, 1)):  # a position is not measured yet
        YAML(typ="safe").dump(other | section, tmp_path / "inspection.yaml")
        assert main(["check", "inspection.yaml"]) == code


def test_improve_page_shows_what_is_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("OCP")
    monkeypatch.chdir(tmp_path)
    text = (EXAMPLE / "inspection.yaml").read_text(encoding="utf-8").replace("directions: 200", "directions: 40")
    (tmp_path / "inspection.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "whole_pixels.yaml").write_text(
        text.replace("quantization: 0.1 px", "quantization: 1 px"), encoding="utf-8"
    )
    (tmp_path / "slotted_block.step").write_bytes((EXAMPLE / "slotted_block.step").read_bytes())
    improved, specified = re.findall(r"```text\n(.*?)```", text_of(DOCS / "howto" / "improve.md"), flags=re.DOTALL)
    assert main(["improve", "whole_pixels.yaml"]) == 1
    require_lines(improved, capsys.readouterr().out)
    assert main(["specify", "inspection.yaml"]) == 0
    require_lines(specified, capsys.readouterr().out)
