"""The text of the inspection file, before its sections are checked: soon enough to begin with the part it names."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar, cast

from ...exceptions import InspectionFileError
from ...findings import Finding
from ..files.problems import KeyPath, Problems, dotted
from ..files.text import read_text
from ..files.units import LENGTH, unit_names
from ..files.yaml_tree import parse_yaml

__all__ = ["InspectionText", "read_inspection_text"]

_Content = TypeVar("_Content")
_MOST_BYTES = 64 << 20


@dataclass(frozen=True)
class InspectionText:
    """The sections of an inspection file as plain YAML values, and the problems that were found with the YAML.

    Parameters
    ----------
    within
        The only folder from which other files may be read; None for any.
    findings
        What readers of sections and of files that they name found implausible; they add to it.
    """

    path: Path
    sections: dict[str, object]
    problems: Problems
    within: Path | None = None
    findings: list[Finding] = field(default_factory=list)

    @property
    def part_file(self) -> Path | None:
        """The file that ``part.file`` seems to name; None where that is nothing that could be one."""
        part = self.sections.get("part")
        name = part.get("file") if isinstance(part, dict) else None
        return self.beside(name, "part.file") if isinstance(name, str) and name.strip() else None

    @property
    def part_unit(self) -> str | None:
        """The unit that ``part.unit`` names; None where it names none that is known."""
        unit = self.below("part", "unit")
        return unit if isinstance(unit, str) and unit in unit_names(LENGTH) else None

    def beside(self, name: str, key: str) -> Path:
        """Where a file lies that this one names: as written where absolute, else from this one's folder.

        Raises
        ------
        InspectionFileError
            If that is outside the folder from which files may be read, symbolic links followed.
        """
        path = self.path.parent / name
        if self.within is not None and not path.resolve().is_relative_to(self.within.resolve()):
            raise InspectionFileError(
                "a file outside the project's folder is named",
                file=self.path.name,
                key=key,
                got=name,
                hint="give it along with the inspection file, and name it without a folder",
            )
        return path

    def below(self, section: str, key: str) -> object:
        """A value below a section, read apart so that its problems are reported even where the section has others."""
        value = self.sections.get(section)
        return value.get(key) if isinstance(value, dict) else None

    def read_beside(
        self, read: Callable[..., _Content], name: str, where: KeyPath, *arguments: object
    ) -> _Content | None:
        """The content of another file; None, and the reason in the problems, where it cannot be read."""
        path = self.beside(name, dotted(where) or "")
        try:
            return read(path, *arguments)
        except InspectionFileError as error:
            if os.path.isfile(path):
                self.problems.found.append(error)
            else:  # then the place to mend is here
                self.problems.add(where, error.problem, got=path, hint=error.hint)
            return None


def read_inspection_text(path: str | os.PathLike[str], within: Path | None = None) -> InspectionText:
    """Read an inspection file as far as its sections.

    Parameters
    ----------
    within
        The only folder from which the files that it names may be read; None for any.

    Raises
    ------
    InspectionFileError
        If it cannot be read or has none.
    """
    text = read_text(path, InspectionFileError, _MOST_BYTES)
    if text.startswith("ISO-10303-21"):
        raise InspectionFileError(
            "this is a STEP file, not an inspection file",
            file=path,
            hint="give an inspection file (YAML), whose part.file names the STEP file",
        )
    problems = Problems(path)
    value = parse_yaml(text, problems).value
    if value is None and not problems.found:
        problems.add((), "the file is empty", line=1, expected="the sections camera, pose_uncertainty and requirement")
    elif value is not None and not isinstance(value, dict):
        problems.add((), "not an inspection file", got=_start(value), expected="sections such as 'camera:'")
    if not isinstance(value, dict):
        problems.raise_if_any()
    return InspectionText(Path(path), cast(dict[str, object], value), problems, within)


def _start(value: object) -> str:
    text = str(value)
    return text if len(text) <= 60 else text[:60] + " …"
