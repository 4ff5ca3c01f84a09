"""Record numbers that are too large for the CAD kernel, which holds them in 32 bits."""

from __future__ import annotations

import re

from ....exceptions import PartFileError

__all__ = ["renumbered"]

_LARGEST = 2**31 - 1
_LONG = re.compile(r"#\s*(\d{10,})")
_MOST_DIGITS = 40
_NUMBER = re.compile(r"'[^']*+(?:'|\Z)|/\*(?s:.*?)(?:\*/|\Z)|#\s*(\d+)")


def renumbered(text: str) -> tuple[str, dict[int, int]]:
    """The text with records numbered from 1 on, and the new number of each old one, where any number is too large.

    Elsewhere the text itself, and an empty dict. Strings and comments are left as they are.

    Raises
    ------
    PartFileError
        If a number has more digits than any writer gives.
    """
    long = [found[1].lstrip("0") for found in _LONG.finditer(text)]
    if not any(len(digits) > 10 or int(digits or "0") > _LARGEST for digits in long):
        return text, {}
    endless = next((digits for digits in long if len(digits) > _MOST_DIGITS), None)
    if endless is not None:
        raise PartFileError(
            "a record number is too long", got=f"#{endless[:20]}... with {len(endless)} digits", expected="#1, #2, ..."
        )
    numbers: dict[int, int] = {}

    def replaced(found: re.Match[str]) -> str:
        if found[1] is None:
            return found[0]
        return f"#{numbers.setdefault(int(found[1]), len(numbers) + 1)}"

    return _NUMBER.sub(replaced, text), numbers
