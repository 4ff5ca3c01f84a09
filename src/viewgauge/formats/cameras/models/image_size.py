"""The size of the image that a calibration is of, under any of its names."""

from __future__ import annotations

from typing import Any

from ..reading.key_account import KeyAccount
from ..reading.key_names import HEIGHT, SIZE, SIZE_ROWS_FIRST, WIDTH, is_matrix

__all__ = ["read_image_size"]


def read_image_size(account: KeyAccount, *, rows_first: bool = False) -> tuple[int, int] | None:
    """Columns and rows; None where the section does not say, or a problem was noted.

    Parameters
    ----------
    rows_first
        Whether the format's keys of size state rows before columns.
    """
    document = account.document
    found: list[tuple[tuple[str | int, ...], tuple[int, int] | None]] = []
    wide, high = account.take(WIDTH, _is_scalar), account.take(HEIGHT, _is_scalar)
    if (wide is None) != (high is None):
        given = wide or high
        assert given is not None  # one of the two is
        document.problems.add(given.where, "only one side of the image is stated", expected="width and height")
    elif wide is not None and high is not None:
        sides = [document.number(entry.where, entry.value) for entry in (wide, high)]
        size = [side for side in sides if side is not None]
        found.append((wide.where, document.resolution(wide.where, size) if len(size) == 2 else None))
    for names, reverse in ((SIZE, rows_first), (SIZE_ROWS_FIRST, True)):
        entry = account.take(names, is_matrix)
        if entry is None:
            continue
        numbers = document.numbers(entry.where, entry.value, (2, 3) if names is SIZE_ROWS_FIRST else (2,))
        if numbers is not None:
            pair = numbers[:2][::-1] if reverse else numbers[:2]
            found.append((entry.where, document.resolution(entry.where, pair)))
    sizes = {size for _, size in found if size is not None}
    if len(sizes) > 1:
        got = " and ".join(f"{columns} x {rows}" for columns, rows in sorted(sizes))
        document.problems.add(found[-1][0], "the file states two sizes of the image", got=got)
    return next(iter(sizes), None) if len(sizes) == 1 else None


def _is_scalar(value: Any) -> bool:
    return not isinstance(value, list | dict)
