"""A dimension in the words of a drawing."""

from __future__ import annotations

import math

from .dimension_values import DimensionValue

__all__ = ["amount", "dimension_text"]

_SAID_OTHERWISE = ("maximum", "minimum", "basic", "reference")


def dimension_text(kind: str, label: str, value: DimensionValue) -> str:
    """Such as "diameter 9 H7 (+0.015 / 0)" or "distance 84 ±0.08", in mm, of an angle in degrees."""
    scale, mark = (math.degrees(1.0), "°") if kind == "angle" else (1.0, "")

    def number(length: float) -> str:
        return f"{amount(length * scale)}{mark}"

    words = label.lower() if kind == "other" and label else kind
    nominal = "without a value" if math.isnan(value.nominal) else number(value.nominal)
    lower, upper = value.limits
    if upper is not None:
        nominal = f"at most {number(upper)}"
    elif lower is not None:
        nominal = f"at least {number(lower)}"
    elif "reference" in value.modifiers and not value.toleranced:
        nominal = f"({nominal}) reference"
    elif not value.toleranced and "basic" in value.modifiers:
        nominal = f"[{nominal}] basic"
    parts = [words, nominal, value.tolerance_class]
    if value.tolerance is not None:
        low, high = (deviation * scale for deviation in value.tolerance)
        if math.isclose(-low, high, rel_tol=1e-9, abs_tol=1e-12) and high > 0:
            deviations = f"±{amount(high)}{mark}"
        else:
            deviations = f"{amount(high, sign=True)}{mark} / {amount(low, sign=True)}{mark}"
        parts.append(f"({deviations})" if value.tolerance_class else deviations)
    parts += [modifier for modifier in value.modifiers if modifier not in _SAID_OTHERWISE]
    return " ".join(part for part in parts if part)


def amount(value: float, *, sign: bool = False) -> str:
    """A number to a nanometre, without trailing zeros."""
    text = f"{round(value, 6) + 0.0:.10g}"
    return f"+{text}" if sign and value > 0 and text != "0" else text
