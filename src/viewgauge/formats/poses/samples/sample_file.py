"""The content of a file of pose-error samples, and the protocol of its readers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Protocol

from ....exceptions import InputError
from ....findings import Finding
from ....measurement import PoseSamples
from ...files.problems import Problems
from ...files.text import read_text
from ...files.yaml_tree import YamlTree, parse_yaml
from ..pose_file import PoseConventions
from .sample_table import SampleTable

__all__ = ["SampleDocument", "SampleFile", "SampleFormat"]


@dataclass(frozen=True)
class SampleFile:
    """The samples, their kind in words, how many commanded poses were visited repeatedly (0 if none), and findings."""

    samples: PoseSamples
    kind: str
    groups: int = 0
    findings: tuple[Finding, ...] = ()


class SampleDocument:
    """A file that may hold samples; it is read as a format asks, as a table or as a tree."""

    def __init__(self, path: Path, conventions: PoseConventions | None = None) -> None:
        self.path, self.conventions = path, conventions

    @property
    def suffix(self) -> str:
        """In lower case, with its point."""
        return self.path.suffix.lower()

    @cached_property
    def table(self) -> SampleTable | None:
        """The columns of a CSV file; None where it is none by its name; raises InputError."""
        return SampleTable.read(self.path, self.conventions) if self.suffix == ".csv" else None

    @cached_property
    def tree(self) -> YamlTree | None:
        """The values of a YAML file; None where it is none by its name; raises InputError."""
        if self.suffix not in (".yaml", ".yml"):
            return None
        problems = Problems(self.path)
        tree = parse_yaml(read_text(self.path, InputError), problems)
        problems.raise_if_any()
        return tree


class SampleFormat(Protocol):
    """Reads one kind of samples."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of its files, in lower case, with their point."""
        ...

    @property
    def expected(self) -> str:
        """Its columns or keys, in messages."""
        ...

    def read(self, document: SampleDocument) -> SampleFile | None:
        """The samples; None where the file is of another kind; raises InputError where one cannot be used."""
        ...
