"""Texts as cells of CSV that no spreadsheet takes for a formula, and back.

A cell that begins with ``=``, ``+``, ``-``, ``@``, a tab or a carriage return is computed by spreadsheets, whatever
quotes are about it. Such a text gets an apostrophe before it, which spreadsheets take as "this is text".
"""

from __future__ import annotations

__all__ = ["from_cell", "to_cell"]

_COMPUTED = ("=", "+", "-", "@", "\t", "\r")
_MARK = "'"


def to_cell(text: str) -> str:
    """The text as a cell that is not computed; :func:`from_cell` gives it back."""
    return _MARK + text if text.startswith(_COMPUTED) or text.lstrip(_MARK).startswith(_COMPUTED) else text


def from_cell(cell: str) -> str:
    """The text that a cell stands for."""
    return cell[1:] if cell.startswith(_MARK) and cell.lstrip(_MARK).startswith(_COMPUTED) else cell
