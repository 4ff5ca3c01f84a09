"""Every error that viewgauge raises on purpose.

::

    ViewgaugeError
    ├── InputError (also a ValueError)      what the user gave cannot be used; exit code 2
    │   ├── InspectionFileError             the inspection file (YAML)
    │   ├── PartFileError                   the CAD file or mesh
    │   └── ViewpointsFileError             the file of viewpoints, that is, camera poses (CSV)
    ├── JobCancelledError                   a user cancelled the work, such as a plan in the workbench
    └── NoCandidateError                    nothing is left to plan with; exit code 2

An :class:`InputError` says what was found, what was expected, where, and what to do about it.
"""

from __future__ import annotations

from os import PathLike

__all__ = [
    "InputError",
    "InspectionFileError",
    "JobCancelledError",
    "NoCandidateError",
    "PartFileError",
    "ViewgaugeError",
    "ViewpointsFileError",
]


class ViewgaugeError(Exception):
    """Base of all errors raised by viewgauge on purpose."""


class JobCancelledError(ViewgaugeError):
    """A user cancelled the work."""


class InputError(ViewgaugeError, ValueError):
    """Something the user gave cannot be used.

    Parameters
    ----------
    problem
        One sentence: what is wrong.
    file, line, key
        Where: path, 1-based line, dotted key such as ``camera.focal_length``.
    got, expected
        The offending value and what would have been right.
    hint
        What to do.
    """

    def __init__(
        self,
        problem: str,
        *,
        file: str | PathLike[str] | None = None,
        line: int | None = None,
        key: str | None = None,
        got: object = None,
        expected: str | None = None,
        hint: str | None = None,
    ) -> None:
        self.problem = problem
        self.file = None if file is None else str(file)
        self.line = line
        self.key = key
        self.got = got
        self.expected = expected
        self.hint = hint
        super().__init__(self._message())

    def _message(self) -> str:
        where = ":".join(str(part) for part in (self.file, self.line, self.key) if part is not None)
        text = f"{where}: {self.problem}" if where else self.problem
        if self.got is not None:
            text += f"\n  got:      {self.got}"
        if self.expected is not None:
            text += f"\n  expected: {self.expected}"
        if self.hint is not None:
            text += f"\n  hint:     {self.hint}"
        return text


class InspectionFileError(InputError):
    """The inspection file cannot be used."""


class PartFileError(InputError):
    """The part's file (STEP or mesh) cannot be used."""


class ViewpointsFileError(InputError):
    """The file of viewpoints cannot be used."""


class NoCandidateError(ViewgaugeError):
    """No candidate viewpoint is left to plan with."""
