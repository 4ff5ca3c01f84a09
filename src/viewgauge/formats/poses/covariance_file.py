"""The file of a 6x6 covariance of the pose error, and how many samples it rests on."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, StrictInt

from ...exceptions import InputError, InspectionFileError
from ..files.atomic import write_text_atomically
from ..files.problems import Problems
from ..files.text import read_text
from ..files.units import ANGLE, LENGTH, parse_quantity
from ..files.yaml_tree import parse_yaml
from ..inspection.validation import validate
from ..inspection.values import Section

__all__ = ["CovarianceFile", "read_covariance", "write_covariance"]

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
    degrees_of_freedom: Annotated[StrictInt, Field(ge=3)] | None = Field(
        default=None, description="a whole number from 3 on"
    )
    mean: Any = None  # what was found beside the covariance: for the reader, of no effect
    made_from: Any = None


@dataclass(frozen=True)
class CovarianceFile:
    """Covariance ``(6, 6)``, mm and rad, translation first, and its degrees of freedom; None where it is known."""

    covariance: NDArray[np.float64]
    degrees_of_freedom: int | None = None


def read_covariance(path: Path) -> CovarianceFile:
    """Covariance of [x, y, z, rx, ry, rz], as the file states it.

    The file is YAML: six rows of six numbers, or a mapping with those under ``covariance`` and optional ``units``
    (``[mm, rad]``), ``order`` (``translation first``, or ``rotation first``, which is converted here), and
    ``degrees_of_freedom`` where it was estimated from samples.

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
    if section is None:
        return CovarianceFile(matrix)
    return CovarianceFile(_convert(matrix, section), section.degrees_of_freedom)


def write_covariance(
    path: str | os.PathLike[str],
    covariance: NDArray[np.float64],
    degrees_of_freedom: int | None,
    mean: NDArray[np.float64],
    made_from: Mapping[str, str],
) -> None:
    """Write a covariance ``(6, 6)`` with the mean that was found beside it ``(6,)``, mm and rad; every digit is kept.

    Parameters
    ----------
    degrees_of_freedom
        None where the covariance was stated and not estimated.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    lines = [
        "# pose error of a pose_uncertainty: [x, y, z, rx, ry, rz], in the pose error frame, perturbation on the left",
        "covariance:",
    ]
    lines += [f"  - [{', '.join(repr(float(value)) for value in row)}]" for row in covariance]
    lines += ["units: [mm, rad]", "order: translation first"]
    if degrees_of_freedom is not None:
        lines += [f"degrees_of_freedom: {degrees_of_freedom}"]
    lines += ["# the systematic part, which calibration should take away; of no effect here"]
    lines += [f"mean: [{', '.join(repr(float(value)) for value in mean)}]", "made_from:"]
    lines += [f"  {json.dumps(name)}: {json.dumps(value)}" for name, value in made_from.items()]
    write_text_atomically(Path(path), "\n".join(lines) + "\n")


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
