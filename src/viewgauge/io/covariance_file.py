"""The file of a 6x6 covariance of the head's pose error."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field

from ..exceptions import InputError, InspectionFileError
from .inspection_schema import Section
from .problems import Problems
from .text import read_text
from .units import ANGLE, LENGTH, parse_quantity
from .validation import validate
from .yaml_tree import parse_yaml

__all__ = ["read_covariance"]

_ORDERS = ("translation first", "rotation first")
_EXPECTED = "six rows of six plain numbers, mm and rad, translation first"


def _read_units(value: object) -> tuple[float, float]:
    """Factors to mm and to rad."""
    if not isinstance(value, list) or len(value) != 2 or not all(isinstance(unit, str) for unit in value):
        raise InputError("not a pair of units", got=value, expected="a length's and an angle's, such as [mm, rad]")
    return parse_quantity(f"1 {value[0]}", LENGTH), parse_quantity(f"1 {value[1]}", ANGLE)


def _read_order(value: object) -> str:
    order = str(value).replace("_", " ").replace("-", " ").strip().lower()
    if order not in _ORDERS:
        raise InputError("unknown order", got=value, expected=" or ".join(_ORDERS))
    return order


class CovarianceSection(Section):
    """The file as a mapping; the rows are read apart."""

    covariance: Any = Field(description=_EXPECTED)
    units: Annotated[tuple[float, float], BeforeValidator(_read_units)] = (1.0, 1.0)
    order: Annotated[str, BeforeValidator(_read_order)] = _ORDERS[0]


def read_covariance(path: Path) -> NDArray[np.float64]:
    """Covariance ``(6, 6)`` of [x, y, z, rx, ry, rz], mm and rad, as the file states it.

    The file is YAML: six rows of six numbers, or a mapping with those under ``covariance`` and optional ``units``
    (``[mm, rad]``) and ``order`` (``translation first``, or ``rotation first``, which is converted here).

    Raises
    ------
    InspectionFileError
        If the file is missing or not such a matrix; whether it is a covariance is judged by ``PoseError``.
    """
    problems = Problems(path)
    tree = parse_yaml(read_text(path, InspectionFileError), problems)
    problems.raise_if_any()
    if tree.value is None:
        raise InspectionFileError("the file is empty", file=path, expected=_EXPECTED)
    section, rows = None, tree.value
    where: tuple[str, ...] = ()
    if isinstance(rows, dict):
        section = validate(CovarianceSection, rows, (), problems)
        where = ("covariance",)
        rows = rows.get("covariance", [])
        problems.raise_if_any()
    matrix = _matrix(rows, where, problems)
    problems.raise_if_any()
    return _convert(matrix, section) if section else matrix


def _matrix(rows: object, where: tuple[str, ...], problems: Problems) -> NDArray[np.float64]:
    if not isinstance(rows, list) or len(rows) != 6:
        got = f"{len(rows)} rows" if isinstance(rows, list) else rows
        problems.add(where, "not a 6x6 matrix", got=got, expected=_EXPECTED)
        return np.zeros((6, 6))
    for index, row in enumerate(rows):
        if not isinstance(row, list) or len(row) != 6:
            problems.add((*where, index), "not a row of six numbers", got=row, expected=_EXPECTED)
        elif not all(_is_number(item) for item in row):
            problems.add((*where, index), "not six finite numbers", got=row, expected=_EXPECTED)
    return np.zeros((6, 6)) if problems.found else np.array(rows, dtype=float)


def _is_number(item: object) -> bool:
    return isinstance(item, int | float) and not isinstance(item, bool) and math.isfinite(item)


def _convert(matrix: NDArray[np.float64], section: CovarianceSection) -> NDArray[np.float64]:
    if section.order == _ORDERS[1]:
        swap = [3, 4, 5, 0, 1, 2]
        matrix = matrix[np.ix_(swap, swap)]
    scale = np.repeat(section.units, 3)
    return np.asarray(matrix * np.outer(scale, scale))
