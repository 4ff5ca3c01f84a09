"""What every conversion of foreign files has in common: the protocol, what it tells, and the option ``--as``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from ...findings import Finding

__all__ = ["Conversion", "Converted"]


@dataclass(frozen=True)
class Converted:
    """What was written.

    Parameters
    ----------
    source, target
        The format that was read, and the one that was written, in words: "Kalibr", "OpenCV".
    findings
        What is implausible in what was read, accepted or not.
    document
        What was read, as JSON-ready data.
    """

    source: str
    target: str
    findings: tuple[Finding, ...] = ()
    document: Mapping[str, Any] | None = None


class Conversion(Protocol):
    """Reads every format of one kind of content and writes it in another."""

    @property
    def kind(self) -> str:
        """The kind of content: "camera"."""
        ...

    @property
    def targets(self) -> Mapping[str, str]:
        """What ``--as`` takes, each with what it writes; the first is the default. No two kinds have one name."""
        ...

    @property
    def meanings(self) -> tuple[str, ...]:
        """Names of the options by which a user states what a file cannot say: ``("name", "model")``."""
        ...

    def recognises(self, path: Path) -> bool:
        """Whether a file has content of this kind, whether or not it can be used."""
        ...

    def write(
        self, source: Path, output: Path, target: str, meanings: Mapping[str, str], accept: tuple[str, ...]
    ) -> Converted:
        """Write the content of a file in the format of the target; raises InputError.

        Parameters
        ----------
        meanings
            What the user states beside the file, by the names of :attr:`meanings`.
        accept
            Names of findings that the user accepts; another that is refused is an InputError.
        """
        ...
