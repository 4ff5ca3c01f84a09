"""Measured values of a STEP file in mm and rad."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .step_text import Enumeration, Record, Ref, StepText

__all__ = ["Units"]

_PREFIXES = {
    "PICO": 1e-12,
    "NANO": 1e-9,
    "MICRO": 1e-6,
    "MILLI": 1e-3,
    "CENTI": 1e-2,
    "DECI": 1e-1,
    "DECA": 1e1,
    "HECTO": 1e2,
    "KILO": 1e3,
}
_PLAIN = ((1.0, "mm"), (10.0, "cm"), (1000.0, "m"), (0.001, "um"), (25.4, "inch"), (304.8, "foot"))
_DEPTH = 8


@dataclass(frozen=True)
class Units:
    """Converts the measured values of a file.

    Parameters
    ----------
    text
        The file's records.
    """

    text: StepText

    def value(self, number: int) -> float | None:
        """Length in mm or angle in rad of a record that measures one, None of any other."""
        return self._measure(number, 0)

    def summary(self) -> str:
        """The file's length unit, such as "mm", "inch", or "mm, dimensions in inch" where they differ."""
        geometry, dimensions = self.of_geometry() or "mm", self.of_dimensions()
        return geometry if dimensions in ("", geometry) else f"{geometry}, dimensions in {dimensions}"

    def of_geometry(self) -> str:
        """Name of the length unit of the first geometric context, empty where there is none."""
        for _, context in self.text.parts("GLOBAL_UNIT_ASSIGNED_CONTEXT"):
            for number in _references(context.parameters):
                name = self._length_name(number)
                if name:
                    return name
        return ""

    def of_dimensions(self) -> str:
        """Name of the length unit of the first dimension's value, empty where there is none."""
        for _, representation in self.text.parts("SHAPE_DIMENSION_REPRESENTATION"):
            for item in _references(representation.parameters):
                part = self.text.part(item, "MEASURE_WITH_UNIT") or self.text.part(item, "LENGTH_MEASURE_WITH_UNIT")
                for unit in _references(part.parameters if part else ()):
                    name = self._length_name(unit)
                    if name:
                        return name
        return ""

    def geometry_factor(self) -> float:
        """Size of the length unit of the first geometric context, mm; 1 where there is none."""
        for _, context in self.text.parts("GLOBAL_UNIT_ASSIGNED_CONTEXT"):
            for number in _references(context.parameters):
                factor = self._factor(number, 0) if self.text.part(number, "LENGTH_UNIT") else None
                if factor:
                    return factor
        return 1.0

    def _length_name(self, number: int) -> str:
        if self.text.part(number, "LENGTH_UNIT") is None:
            return ""
        factor = self._factor(number, 0)
        if factor is None:
            return ""
        plain = (name for size, name in _PLAIN if math.isclose(size, factor, rel_tol=1e-6))
        return next(plain, f"{factor:g} mm")

    def _measure(self, number: int, depth: int) -> float | None:
        for part in self.text.records(number):
            if not part.type.endswith("MEASURE_WITH_UNIT") and part.type != "MEASURE_REPRESENTATION_ITEM":
                continue
            amounts = [amount for p in part.parameters if (amount := _amount(p)) is not None]
            units = _references(part.parameters)
            if amounts and units:
                factor = self._factor(units[-1], depth + 1)
                return None if factor is None else amounts[0] * factor
        return None

    def _factor(self, number: int, depth: int) -> float | None:
        """Size of a unit in mm or rad."""
        if depth > _DEPTH:
            return None
        conversion = self.text.part(number, "CONVERSION_BASED_UNIT")
        if conversion is not None:
            sizes = _references(conversion.parameters)
            return self._measure(sizes[-1], depth + 1) if sizes else None
        metric = self.text.part(number, "SI_UNIT")
        if metric is None:
            return None
        words = [p.name for p in metric.parameters if isinstance(p, Enumeration)]
        scale = math.prod(_PREFIXES.get(word, 1.0) for word in words)
        return scale * 1000.0 if "METRE" in words else scale if "RADIAN" in words else None


def _amount(parameter: object) -> float | None:
    """The number of ``LENGTH_MEASURE(5.)``, or of a bare ``5.``, which some writers leave."""
    if isinstance(parameter, Record) and len(parameter.parameters) == 1:
        parameter = parameter.parameters[0]
    return parameter if isinstance(parameter, float) else None


def _references(parameters: object) -> list[int]:
    if isinstance(parameters, Ref):
        return [parameters.number]
    if isinstance(parameters, tuple):
        return [number for parameter in parameters for number in _references(parameter)]
    return []
