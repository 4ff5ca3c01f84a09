"""fx, fy, cx and cy from a camera matrix or from numbers of their own, and what a matrix is that is none in px."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....findings import Finding
from ...files.problems import KeyPath, dotted
from ..reading.calibration_document import CalibrationDocument
from ..reading.key_account import Entry, KeyAccount
from ..reading.key_names import FOCAL_PAIR, MATRIX, PRINCIPAL_PAIR, SCALARS, SKEW, is_matrix

__all__ = ["Pinhole", "read_pinhole"]

_ROUNDING = 1e-6  # of fx: a skew that comes from printing the matrix
_LARGEST_SHARE = 1.5  # a principal point in parts of the image
_SMALLEST_FOCAL_PX = 20.0  # with a principal point in parts of the image, no focal length is longer


@dataclass(frozen=True)
class Pinhole:
    """What a calibration says without its lens, px.

    Parameters
    ----------
    where
        Where it stands in the file.
    """

    focal_length_px: tuple[float, float]
    principal_point_px: tuple[float, float]
    where: KeyPath
    findings: tuple[Finding, ...] = ()


def read_pinhole(account: KeyAccount, *, transposed: bool = False, first_pixel: float = 0.0) -> Pinhole | None:
    """The pinhole of a camera's section; None where a problem was noted.

    Parameters
    ----------
    transposed
        Whether the format writes the matrix with the principal point in row 3.
    first_pixel
        The coordinate that the format gives to the centre of the first pixel: 0, 0.5 or 1.
    """
    entry = account.take(MATRIX, is_matrix)
    read = _from_numbers(account) if entry is None else _from_matrix(account.document, entry, transposed)
    _require_no_skew(account)
    if read is None:
        return None
    if entry is not None:
        _require_agreement(account, read)
    (cx, cy), document = read.principal_point_px, account.document
    if min(read.focal_length_px) <= 0:
        document.problems.add(
            read.where,
            "the focal length must be positive",
            got=list(read.focal_length_px),
            hint="0 stands in files of a camera that is not calibrated" if max(read.focal_length_px) == 0 else None,
        )
        return None
    if max(abs(cx), abs(cy)) <= _LARGEST_SHARE and max(read.focal_length_px) < _SMALLEST_FOCAL_PX:
        fx, fy = read.focal_length_px
        document.problems.add(
            read.where,
            f"fx {fx:g} is no focal length in px: the matrix is in parts of the image",
            got=f"fx {fx:g}, fy {fy:g}, cx {cx:g}, cy {cy:g}",
            expected="fx, fy, cx and cy in px",
            hint="multiply fx and cx by the image's columns, fy and cy by its rows",
        )
        return None
    return Pinhole(read.focal_length_px, (cx - first_pixel, cy - first_pixel), read.where, read.findings)


def _from_matrix(document: CalibrationDocument, entry: Entry, transposed: bool) -> Pinhole | None:
    numbers = document.numbers(entry.where, entry.value, (4, 9, 12))
    if numbers is None:
        return None
    if len(numbers) == 4:  # fx, fy, cx, cy
        return Pinhole((numbers[0], numbers[1]), (numbers[2], numbers[3]), entry.where)
    K = np.array(numbers).reshape(3, -1)
    if K.shape == (3, 4):
        if K[:, 3].any():
            expected = "a camera matrix of 3 x 3, or a fourth column of zeros"
            document.problems.add(
                entry.where, "a projection with a translation", got=K[:, 3].tolist(), expected=expected
            )
            return None
        K = K[:, :3]
    findings: tuple[Finding, ...] = ()
    is_transposed = bool(K[2, :2].any()) and not K[:2, 2].any()
    if is_transposed:
        if not transposed:
            findings = (_transposed(document, entry.where, K),)
        K = K.T
    return _of_matrix(document, entry.where, K, findings)


def _require_agreement(account: KeyAccount, read: Pinhole) -> None:
    """Note a problem where numbers beside the matrix say something else."""
    document = account.document
    for pair, names, values in (
        (FOCAL_PAIR, ("fx", "fy"), read.focal_length_px),
        (PRINCIPAL_PAIR, ("cx", "cy"), read.principal_point_px),
    ):
        entries = [account.take(SCALARS[name], _is_scalar) for name in names]
        both = account.take(pair, _is_few)
        for entry, meant in ((entries[0], values[:1]), (entries[1], values[1:]), (both, values)):
            if entry is None or entry.value is None:
                continue
            given = document.numbers(entry.where, entry.value if isinstance(entry.value, list) else [entry.value], None)
            expected = meant if given is not None and len(given) == len(meant) else meant[:1]
            if given is not None and not np.allclose(given, expected, rtol=1e-6, atol=1e-6):
                got = f"{given} beside {[float(value) for value in expected]} in the matrix"
                document.problems.add(entry.where, "the file says it differently in the matrix", got=got)


def _is_few(value: Any) -> bool:
    return _is_scalar(value) or (isinstance(value, list) and len(value) <= 2)


def _of_matrix(
    document: CalibrationDocument, where: KeyPath, K: NDArray[np.float64], findings: tuple[Finding, ...]
) -> Pinhole | None:
    if K[2, 0] or K[2, 1] or K[2, 2] != 1:
        got = f"row 3 is {K[2].tolist()}"
        hint = "the principal point stands in column 3 of rows 1 and 2"
        if not K.any():
            hint = "a matrix of zeros stands in files of a camera that is not calibrated"
        document.problems.add(where, "not a camera matrix", got=got, expected="0, 0, 1 in row 3", hint=hint)
        return None
    if abs(K[0, 1]) > _ROUNDING * abs(K[0, 0]) or K[1, 0]:
        got = K[0, 1] if K[0, 1] else K[1, 0]
        document.problems.add(
            where,
            "skew is not known here",
            got=f"{got:g}",
            expected="0 in row 1, column 2, and in row 2, column 1",
            hint="calibrate without skew: no sensor of today has any",
        )
        return None
    return Pinhole((float(K[0, 0]), float(K[1, 1])), (float(K[0, 2]), float(K[1, 2])), where, findings)


def _transposed(document: CalibrationDocument, where: KeyPath, K: NDArray[np.float64]) -> Finding:
    row = ", ".join(f"{value:g}" for value in K[2])
    return Finding(
        "transposed_matrix",
        f"row 3 of the camera matrix is ({row}), with the principal point in it",
        "0, 0, 1 in row 3",
        "the matrix is transposed, as MATLAB writes it, whose first pixel has the coordinate 1 where it is 0 here; "
        "accepted, the matrix is transposed and the principal point taken as it is",
        f"{document.path}: {dotted(where)}",
        refused=True,
    )


def _from_numbers(account: KeyAccount) -> Pinhole | None:
    pair = account.take(FOCAL_PAIR, is_matrix)
    centre = account.take(PRINCIPAL_PAIR, is_matrix)
    document = account.document
    focal = _pair(account, pair, ("fx", "fy"))
    middle = _pair(account, centre, ("cx", "cy"))
    if focal is None or middle is None:
        return None
    entry = pair or centre
    key = entry.where if entry else account.where
    del document
    return Pinhole(focal, middle, key)


def _pair(account: KeyAccount, entry: Entry | None, names: tuple[str, str]) -> tuple[float, float] | None:
    document = account.document
    if entry is not None:
        numbers = document.numbers(entry.where, entry.value, (1, 2))
        return None if numbers is None else (numbers[0], numbers[-1])
    found = [account.take(SCALARS[name], _is_scalar) for name in names]
    if found[0] is None and found[1] is None and names[0] == "fx":
        one = account.take(FOCAL_PAIR, _is_scalar)  # of square pixels
        found = [one, one]
    values: list[float | None] = []
    for name, each in zip(names, found, strict=True):
        if each is None:
            document.problems.add((*account.where, name), "the key is missing", expected="fx, fy, cx and cy in px")
            return None
        values.append(document.number(each.where, each.value))
    first, second = values
    return None if first is None or second is None else (first, second)


def _is_scalar(value: Any) -> bool:
    return not isinstance(value, list | dict)


def _require_no_skew(account: KeyAccount) -> None:
    entry = account.take(SKEW, _is_scalar)
    if entry is None or entry.value is None:
        return
    skew = account.document.number(entry.where, entry.value)
    if skew:
        account.document.problems.add(entry.where, "skew is not known here", got=skew, expected="0")
