"""The command that prints the JSON Schema of the inspection file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .options import DONE

__all__ = ["schema"]


def schema(*, output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None) -> int:
    """Print the JSON Schema of the inspection file, by which editors complete and check it.

    Parameters
    ----------
    output
        A file for the schema, in place of the screen.
    """
    from ..jobs.schema import schema_text, write_schema

    if output is None:
        print(schema_text(), end="")
    else:
        write_schema(output)
        print(f"written to {output}")
    return DONE
