"""Camera poses laid out for compiled loops over many of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .poses import invert

__all__ = ["VIEWS", "view_block"]

VIEWS = 256
"""Most poses in a block. A constant, so that a compiler sees the rows of a block at fixed distances from each other
and need not ask whether they overlap; 256 poses (30 KiB) stay in the first-level cache."""


def view_block(T_part_camera: NDArray[np.float64]) -> NDArray[np.float64]:
    """Up to 256 poses ``(n, 4, 4)`` mm as rows of one array ``(15 * 256,)``; entries beyond n are zero.

    With ``k = 256 r + s`` the entry k is that of pose s in row r. Rows 0 to 8: the rotation part of ``T_camera_part``,
    row by row; 9 to 11: its translation, mm; 12 to 14: the centre of projection in the part frame, mm.
    """
    n = len(T_part_camera)
    T_camera_part = invert(T_part_camera)
    rows = np.zeros((15, VIEWS))
    rows[:9, :n] = T_camera_part[:, :3, :3].reshape(n, 9).T
    rows[9:12, :n] = T_camera_part[:, :3, 3].T
    rows[12:, :n] = T_part_camera[:, :3, 3].T
    return rows.ravel()
