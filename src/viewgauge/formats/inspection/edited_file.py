"""An inspection file with some values changed; all else, comments too, stays as it is written."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

from ..files.yaml_tree import quote_lists_with_unit

__all__ = ["edited_inspection"]

_WIDTH = 4096  # no line is broken


def edited_inspection(text: str, changes: Mapping[tuple[str, ...], Any]) -> str:
    """The file's text with the values of some keys, by their path such as ``("camera", "focal_length")``.

    A key that is absent is added to its section.
    """
    from ruamel.yaml import YAML

    yaml = YAML(typ="rt")
    yaml.preserve_quotes = True
    yaml.width = _WIDTH
    document = yaml.load(quote_lists_with_unit(text.replace("\r\n", "\n")))
    for (*sections, key), value in changes.items():
        place = document
        for section in sections:
            place = place[section]
        place[key] = _written(value)
    written = io.StringIO()
    yaml.dump(document, written)
    return written.getvalue()


def _written(value: Any) -> Any:
    """Lists in one line."""
    if not isinstance(value, list | tuple):
        return value
    from ruamel.yaml.comments import CommentedSeq

    row = CommentedSeq(value)
    row.fa.set_flow_style()
    return row
