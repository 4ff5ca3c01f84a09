"""Images as PNG files, 8 or 16 bit grey (OpenCV)."""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import NDArray

from ..exceptions import InputError
from ..measurement.board import opencv
from .atomic import atomic_path

__all__ = ["write_png"]


def write_png(path: str | os.PathLike[str], grey: NDArray[np.uint16], bits: int) -> None:
    """Write grey values ``(rows, columns)``: 8 bit, or up to 16 bit as they are; whole or not at all."""
    done, encoded = opencv().imencode(".png", grey.astype(np.uint8) if bits <= 8 else grey)
    if not done:
        raise InputError("the image cannot be encoded", file=path, got=f"shape {grey.shape}")
    with atomic_path(path) as temporary:
        temporary.write_bytes(encoded.tobytes())
