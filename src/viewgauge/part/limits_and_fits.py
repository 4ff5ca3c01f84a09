"""Limits of size by tolerance class: the deviations of "9 H7" or "25 g6" (ISO 286-1:2010), sizes up to 500 mm.

A class is a letter, the fundamental deviation, and a number, the standard tolerance grade IT. The standard makes its
figures from formulas (i = 0.45 D^(1/3) + 0.001 D, IT7 = 16 i, ...) with D the geometric mean of a range of sizes, and
rounds them, not always by one rule; what it prints counts, so its rounded figures stand here, and tests compare them
with the formulas.
"""

from __future__ import annotations

from bisect import bisect_left

__all__ = ["class_deviations_mm"]

# Upper ends of the ranges of sizes, mm ("over 6 up to and including 10")
_RANGES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)
_FINE_RANGES = (
    *(3, 6, 10, 14, 18, 24, 30, 40, 50, 65, 80, 100, 120, 140, 160, 180),
    *(200, 225, 250, 280, 315, 355, 400, 450, 500),
)
# Standard tolerances, um, for each of the ranges; from IT12 on ten times those of five grades before.
_GRADES_UM: dict[str, tuple[float, ...]] = {
    "01": (0.3, 0.4, 0.4, 0.5, 0.6, 0.6, 0.8, 1, 1.2, 2, 2.5, 3, 4),
    "0": (0.5, 0.6, 0.6, 0.8, 1, 1, 1.2, 1.5, 2, 3, 4, 5, 6),
    "1": (0.8, 1, 1, 1.2, 1.5, 1.5, 2, 2.5, 3.5, 4.5, 6, 7, 8),
    "2": (1.2, 1.5, 1.5, 2, 2.5, 2.5, 3, 4, 5, 7, 8, 9, 10),
    "3": (2, 2.5, 2.5, 3, 4, 4, 5, 6, 8, 10, 12, 13, 15),
    "4": (3, 4, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20),
    "5": (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27),
    "6": (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40),
    "7": (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63),
    "8": (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97),
    "9": (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155),
    "10": (40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250),
    "11": (60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400),
    "12": (100, 120, 150, 180, 210, 250, 300, 350, 400, 460, 520, 570, 630),
    "13": (140, 180, 220, 270, 330, 390, 460, 540, 630, 720, 810, 890, 970),
}
_GRADES_UM |= {str(n): tuple(10 * value for value in _GRADES_UM[str(n - 5)]) for n in range(14, 19)}
# Fundamental deviations of shafts, um. Upper deviations (below the nominal size), without their sign:
_UPPER_UM: dict[str, tuple[float, ...]] = {
    "a": (
        *(270, 270, 280, 290, 290, 300, 300, 310, 320, 340, 360, 380, 410, 460, 520, 580),
        *(660, 740, 820, 920, 1050, 1200, 1350, 1500, 1650),
    ),
    "b": (
        *(140, 140, 150, 150, 150, 160, 160, 170, 180, 190, 200, 220, 240, 260, 280, 310),
        *(340, 380, 420, 480, 540, 600, 680, 760, 840),
    ),
    "c": (
        *(60, 70, 80, 95, 95, 110, 110, 120, 130, 140, 150, 170, 180, 200, 210, 230),
        *(240, 260, 280, 300, 330, 360, 400, 440, 480),
    ),
    "d": (20, 30, 40, 50, 65, 80, 100, 120, 145, 170, 190, 210, 230),
    "e": (14, 20, 25, 32, 40, 50, 60, 72, 85, 100, 110, 125, 135),
    "f": (6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68),
    "g": (2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20),
    "h": (0,) * 13,
}
# Lower deviations (above the nominal size):
_LOWER_UM: dict[str, tuple[float, ...]] = {
    "k": (0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5),
    "m": (2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23),
    "n": (4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40),
    "p": (6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68),
    "r": (
        *(10, 15, 19, 23, 23, 28, 28, 34, 34, 41, 43, 51, 54, 63, 65, 68),
        *(77, 80, 84, 94, 98, 108, 114, 126, 132),
    ),
    "s": (
        *(14, 19, 23, 28, 28, 35, 35, 43, 43, 53, 59, 71, 79, 92, 100, 108),
        *(122, 130, 140, 158, 170, 190, 208, 232, 252),
    ),
    "u": (
        *(18, 23, 28, 33, 33, 41, 48, 60, 70, 87, 102, 124, 144, 170, 190, 210),
        *(236, 258, 284, 315, 350, 390, 435, 490, 540),
    ),
    "x": (
        *(20, 28, 34, 40, 45, 54, 64, 80, 97, 122, 146, 178, 210, 248, 280, 310),
        *(350, 385, 425, 475, 525, 590, 660, 740, 820),
    ),
    "z": (
        *(26, 35, 42, 50, 60, 73, 88, 112, 136, 172, 210, 258, 310, 365, 415, 465),
        *(520, 575, 640, 710, 790, 900, 1000, 1100, 1250),
    ),
}


def class_deviations_mm(nominal_mm: float, letter: str, grade: str) -> tuple[float, float] | None:
    """(lower, upper) deviation, mm, of a tolerance class; None where the size or the class is not among those above.

    Parameters
    ----------
    nominal_mm
        Nominal size, mm.
    letter
        Fundamental deviation: capital letters for holes ("H"), small ones for shafts ("g").
    grade
        Standard tolerance grade, such as "7".
    """
    small = letter.lower()
    if not 0 < nominal_mm <= _RANGES[-1] or grade not in _GRADES_UM or (letter != small and letter != letter.upper()):
        return None
    width = _by_size(_GRADES_UM[grade], nominal_mm)
    if small == "js":
        return -width / 2000, width / 2000
    if small in _UPPER_UM:
        if small in "ab" and nominal_mm <= 1:
            return None
        upper = -_by_size(_UPPER_UM[small], nominal_mm)
        lower = upper - width
    elif small in _LOWER_UM:
        fundamental = _fundamental_um(nominal_mm, letter, grade)
        if fundamental is None:
            return None
        lower, upper = fundamental, fundamental + width
    else:
        return None
    if letter != small:
        lower, upper = -upper, -lower
    return lower / 1000 + 0.0, upper / 1000 + 0.0


def _by_size(values: tuple[float, ...], nominal_mm: float) -> float:
    return values[bisect_left(_RANGES if len(values) == len(_RANGES) else _FINE_RANGES, nominal_mm)]


def _fundamental_um(nominal_mm: float, letter: str, grade: str) -> float | None:
    """Lower deviation of a shaft from k on, um; of a hole that of the shaft from which its own follows by the sign."""
    value = _by_size(_LOWER_UM[letter.lower()], nominal_mm)
    step = -1 if grade == "01" else int(grade)
    if letter.islower():
        return value if letter != "k" or 4 <= step <= 7 else 0
    if letter in "KMN" and step > 8:
        if nominal_mm <= 3:
            return value
        return {"K": None, "M": value, "N": 0}[letter]
    if nominal_mm <= 3 or step > (8 if letter in "KMN" else 7):
        return value
    if step < 3:
        return None
    if letter == "M" and step == 6 and 250 < nominal_mm <= 315:
        return 9  # an exception of the standard's
    return value - (_by_size(_GRADES_UM[grade], nominal_mm) - _by_size(_GRADES_UM[str(step - 1)], nominal_mm))
