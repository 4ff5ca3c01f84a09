"""A characteristic as it stands on the drawing, as JSON-ready data; the same in ``check --json`` and ``plan.json``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ...part.indication import Indication

__all__ = ["indication_document", "read_indication"]


def indication_document(
    kind: str, nominal: float, tolerance: tuple[float, float] | None, indication: Indication
) -> dict[str, Any]:
    """``record`` to ``features`` of a characteristic: values in ``unit``, mm or deg (of an angle); null if undefined.

    Parameters
    ----------
    nominal, tolerance
        Nominal value and (lower, upper) deviation, mm, but rad of an angle.
    """
    angle = kind == "angle"
    limits = indication.limits if tolerance is None else tuple(nominal + deviation for deviation in tolerance)

    def number(value: float | None) -> float | None:
        if value is None or not math.isfinite(value):
            return None
        return round(math.degrees(value), 9) if angle else float(value)

    return {
        "record": indication.record or None,
        "text": indication.text,
        "nominal": number(nominal),
        "unit": "deg" if angle else "mm",
        "lower": number(limits[0]),
        "upper": number(limits[1]),
        "zone": number(indication.zone_mm),
        "datums": list(indication.datums),
        "modifiers": list(indication.modifiers),
        "features": indication.features,
        "toleranced": indication.toleranced,
    }


def read_indication(entry: Mapping[str, Any]) -> Indication:
    """The indication of what :func:`indication_document` wrote."""
    one_sided = (entry["lower"] is None) != (entry["upper"] is None)
    scale = math.radians(1.0) if entry["unit"] == "deg" else 1.0
    limits = [None if entry[name] is None or not one_sided else entry[name] * scale for name in ("lower", "upper")]
    return Indication(
        record=entry["record"] or 0,
        text=entry["text"],
        zone_mm=entry["zone"],
        datums=tuple(entry["datums"]),
        modifiers=tuple(entry["modifiers"]),
        limits=(limits[0], limits[1]),
        toleranced=bool(entry["toleranced"]),
        features=int(entry["features"]),
    )
