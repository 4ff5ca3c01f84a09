"""Docstrings are written for Python's help(); this turns their few Sphinx marks into Markdown."""

from __future__ import annotations

import re

import griffe

_ROLE = re.compile(r":(?:class|func|meth|attr|mod|data):`~?([^`]+)`")
_LITERAL = re.compile(r"\s?::\n\n(?=[ \t]+\S)")
_LITERAL_ALONE = re.compile(r"^\s*::\n", re.MULTILINE)


class PlainMarkdown(griffe.Extension):
    """Sphinx roles to code, ``::`` to an indented block."""

    def on_object(self, *, obj: griffe.Object, **_: object) -> None:
        """Rewrite one docstring."""
        if obj.docstring is not None:
            text = _ROLE.sub(lambda match: f"`{match[1].rpartition('.')[2]}`", obj.docstring.value)
            text = _LITERAL_ALONE.sub("", text)
            obj.docstring.value = _LITERAL.sub(":\n\n", text)
