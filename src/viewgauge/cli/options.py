"""Options that several commands have, and how their values are read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, Token

__all__ = ["DONE", "NOT_MET", "Chunk", "Json", "PartFile", "Scheduler", "Workers", "count", "whole_number"]

DONE, NOT_MET = 0, 1
"""Exit codes."""


def whole_number(_: object, tokens: Sequence[Token]) -> int:
    """An int from its digits only: 1.5 is an error and not 1."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"{tokens[0].value!r} is not a whole number") from None


def count(kind: object, tokens: Sequence[Token]) -> int:
    """A whole number from 1 on, refused before anything is read."""
    number = whole_number(kind, tokens)
    if number < 1:
        raise ValueError(f"{tokens[0].value!r} is not a whole number from 1 on")
    return number


PartFile = Annotated[Path | None, Parameter(name="--part", help="CAD file or mesh, in place of the file's own.")]
Json = Annotated[bool, Parameter(name="--json", negative="", help="Print the result as JSON.")]
Scheduler = Annotated[str | None, Parameter(name="--scheduler", help="Run on the Dask scheduler at this address.")]
Workers = Annotated[
    int | None,
    Parameter(name="--workers", converter=count, help="Run on this many processes (Dask) of this machine."),
]
Chunk = Annotated[
    int, Parameter(name="--chunk", converter=count, help="Viewpoints evaluated at once; bounds the memory.")
]
