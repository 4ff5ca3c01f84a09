"""Everything that is wrong with a file, gathered so that it can be reported at once."""

from __future__ import annotations

import os
from collections.abc import Mapping

from ...exceptions import InspectionFileError

__all__ = ["KeyPath", "Problems", "dotted"]

KeyPath = tuple[str | int, ...]


def dotted(path: KeyPath) -> str | None:
    """A path as it is shown: ``part.characteristics[0].start``; None for the root."""
    text = ""
    for step in path:
        text += f"[{step}]" if isinstance(step, int) else f".{step}"
    return text.lstrip(".") or None


class Problems:
    """The problems of one file and, as they arise, of the files that it names.

    ``lines`` gives the line of each key of the file; a key without one gets the line of its parent.
    """

    def __init__(self, file: str | os.PathLike[str]) -> None:
        self.file = file
        self.lines: Mapping[KeyPath, int] = {}
        self.found: list[InspectionFileError] = []
        self._reported: set[KeyPath] = set()

    def line_of(self, path: KeyPath) -> int | None:
        """Line of a key, or of the nearest key above it."""
        for length in range(len(path), -1, -1):
            if path[:length] in self.lines:
                return self.lines[path[:length]]
        return None

    def add(
        self,
        path: KeyPath,
        problem: str,
        *,
        line: int | None = None,
        got: object = None,
        expected: str | None = None,
        hint: str | None = None,
    ) -> None:
        """Note a problem of the value at a path; further ones of the same value would only follow from the first."""
        if path and path in self._reported:
            return
        self._reported.add(path)
        self.found.append(
            InspectionFileError(
                problem,
                file=self.file,
                line=self.line_of(path) if line is None else line,
                key=dotted(path),
                got=got,
                expected=expected,
                hint=hint,
            )
        )

    def raise_if_any(self) -> None:
        """Raise one InspectionFileError for all that was found, in the order of the lines."""
        if not self.found:
            return
        ordered = sorted(self.found, key=lambda error: (error.file != str(self.file), error.line or 0))
        if len(ordered) == 1:
            raise ordered[0]
        raise InspectionFileError(
            f"{len(ordered)} problems\n" + "\n".join(str(error) for error in ordered), file=self.file
        )
