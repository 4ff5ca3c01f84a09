"""An inspection file with some values changed; all else, comments too, stays as it is written."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

__all__ = ["edited_inspection"]

_WIDTH = 4096  # no line is broken


def edited_inspection(text: str, changes: Mapping[tuple[str, ...], Any]) -> str:
    """The file's text with the values of some keys, by their path such as ``("camera", "focal_length")``.

    A key that is absent is added to its section, and a section to the one above it.
    """
    from ruamel.yaml import YAML
    from ruamel.yaml.comments import CommentedMap

    yaml = YAML(typ="rt")
    yaml.preserve_quotes = True
    yaml.width = _WIDTH
    document = yaml.load(text.replace("\r\n", "\n"))
    for (*sections, key), value in changes.items():
        place = document
        for section in sections:
            if section not in place:
                place[section] = _flow(CommentedMap())
            place = place[section]
        place[key] = _written(value)
    written = io.StringIO()
    yaml.dump(document, written)
    return written.getvalue()


def _written(value: Any) -> Any:
    """The value as it is written: a list in one line."""
    if not isinstance(value, list | tuple):
        return value
    from ruamel.yaml.comments import CommentedSeq

    return _flow(CommentedSeq(value))


def _flow(collection: Any) -> Any:
    """The collection, written in one line."""
    collection.fa.set_flow_style()
    return collection
