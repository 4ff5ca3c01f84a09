"""Options that several commands have, and how their values are read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter, Token

__all__ = ["DONE", "NOT_MET", "Chunk", "Json", "PartFile", "Scheduler", "Seed", "Workers", "count", "whole_number"]

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


PartFile = Annotated[
    Path | None, Parameter(name="--part", help="Read this CAD file or mesh in place of the one that the file names.")
]
Json = Annotated[bool, Parameter(name="--json", negative="", help="Print the result as JSON.")]
Seed = Annotated[
    int | None,
    Parameter(
        name="--seed",
        converter=whole_number,
        help="Use this seed in place of the file's own; the same seed gives the same result.",
    ),
]
Scheduler = Annotated[str | None, Parameter(name="--scheduler", help="Run on the Dask scheduler at this address.")]
Workers = Annotated[
    int | None,
    Parameter(name="--workers", converter=count, help="Run in this many processes (Dask) on this machine."),
]
Chunk = Annotated[
    int, Parameter(name="--chunk", converter=count, help="Evaluate this many viewpoints at once; it bounds the memory.")
]
