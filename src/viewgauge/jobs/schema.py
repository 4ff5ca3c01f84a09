"""The JSON Schema of the inspection file, for editors and for other programs."""

from __future__ import annotations

import json
from os import PathLike
from pathlib import Path

from ..formats.files.atomic import write_text_atomically
from ..formats.inspection.schema import inspection_schema

__all__ = ["schema_text", "write_schema"]


def schema_text() -> str:
    """The schema as JSON."""
    return json.dumps(inspection_schema(), indent=2, ensure_ascii=False) + "\n"


def write_schema(path: str | PathLike[str]) -> None:
    """Write the schema to a file.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    write_text_atomically(Path(path), schema_text())
