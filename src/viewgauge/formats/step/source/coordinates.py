"""Coordinates that no part has, found before the CAD kernel works on them without end."""

from __future__ import annotations

import re

from ....exceptions import PartFileError

__all__ = ["LARGEST_MM", "LARGEST_PART_MM", "refuse_far_points"]

LARGEST_MM = 1e9  # a thousand kilometres; beyond, a double is coarser than a tenth of a micrometre
LARGEST_PART_MM = 1e7  # ten kilometres

_FAR = re.compile(
    r"(#\d+)\s*=\s*CARTESIAN_POINT\s*\(\s*'[^']*'\s*,\s*"
    r"(\([^()]*?(?:(?<![.\d])\d{7}|[\d.]E\+?0*[1-9])[^()]*\))\s*\)",
    re.I,
)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:E[-+]?\d+)?", re.I)


def refuse_far_points(source: str, factor: float) -> None:
    """Refuse a file with a point farther than a thousand kilometres from the origin.

    Parameters
    ----------
    source
        The file's text.
    factor
        Size of the file's length unit, mm.

    Raises
    ------
    PartFileError
        Naming the first such point.
    """
    for found in _FAR.finditer(source):
        values = [float(number) for number in _NUMBER.findall(found[2])]
        largest = max((abs(value) for value in values), default=0.0)
        if not largest * factor <= LARGEST_MM:
            raise PartFileError(
                "a point lies farther from the origin than any part",
                got=f"{found[1]} = CARTESIAN_POINT with the coordinate {largest:.6g}",
                expected=f"coordinates of at most {LARGEST_MM:.0e} mm",
                hint="the file is damaged, or its unit is wrong: export it again",
            )
