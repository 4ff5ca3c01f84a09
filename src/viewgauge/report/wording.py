"""Numbers and marks as the report prints them."""

from __future__ import annotations

import math

__all__ = ["DASH", "length", "probability", "rounded", "tolerance"]

DASH = "–"
PROBABILITY_DIGITS = 4


def probability(value: float) -> str:
    """A probability or an accuracy to four digits, rounded down: what is printed is reached, and nothing is certain.

    0.94999 reads 0.9499 and not 0.9500; 0.99996 and 1 read > 0.9999; 0.00002 reads < 0.0001.
    """
    if math.isnan(value):
        return DASH
    step = 10**PROBABILITY_DIGITS
    if value == 0:
        return "0"
    if value > 1 - 1 / step:
        return f"> {1 - 1 / step:.{PROBABILITY_DIGITS}f}"
    if 0 < value < 1 / step:
        return f"< {1 / step:.{PROBABILITY_DIGITS}f}"
    # 0.9321 * 10000 is 9320.999...: a value on a step stays there
    return f"{math.floor(value * step + 1e-6) / step:.{PROBABILITY_DIGITS}f}"


def length(value: float) -> str:
    """A length in mm without trailing zeros, to a tenth of a micrometre; a dash where it is undefined."""
    if not math.isfinite(value):
        return DASH
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text.replace("-", "−")


def rounded(value: float, *, up: bool = False) -> str:
    """Four digits, rounded down (up): a limit that is printed is kept."""
    if value == 0:
        return "0"
    scale = 10.0 ** (PROBABILITY_DIGITS - 1 - math.floor(math.log10(abs(value))))
    steps = math.ceil(value * scale - 1e-9) if up else math.floor(value * scale + 1e-9)
    return f"{steps / scale:.{PROBABILITY_DIGITS}g}"


def _deviation(value: float) -> str:
    return f"+{length(value)}" if value > 0 else length(value)


def tolerance(deviations: tuple[float, float] | None) -> str:
    """A tolerance such as ±0.1 or +0.1 / −0.05; a dash where there is none."""
    if deviations is None:
        return DASH
    lower, upper = deviations
    if math.isclose(-lower, upper) and upper > 0:
        return f"±{length(upper)}"
    return f"{_deviation(upper)} / {_deviation(lower)}"
