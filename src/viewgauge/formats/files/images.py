"""Images as PNG files, 8 or 16 bit grey (OpenCV), and small ones for pages."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...measurement.pose.board import opencv
from .atomic import atomic_path

__all__ = ["encoded_png", "image_size", "read_grey", "write_overlay", "write_png"]


def write_png(path: str | os.PathLike[str], grey: NDArray[np.uint16], bits: int) -> None:
    """Write grey values ``(rows, columns)``: 8 bit, or up to 16 bit as they are; whole or not at all."""
    done, encoded = opencv().imencode(".png", grey.astype(np.uint8) if bits <= 8 else grey)
    if not done:
        raise InputError("the image cannot be encoded", file=path, got=f"shape {grey.shape}")
    with atomic_path(path) as temporary:
        temporary.write_bytes(encoded.tobytes())


def encoded_png(grey: NDArray[np.uint8]) -> bytes:
    """A small 8-bit image ``(rows, columns)`` as the content of a PNG file, for a page."""
    from PIL import Image  # here: slow to import

    content = io.BytesIO()
    Image.fromarray(grey).save(content, "png", optimize=True)
    return content.getvalue()


def image_size(path: str | os.PathLike[str]) -> tuple[int, int]:
    """Columns and rows that an image's header states; nothing is decoded, so that a small file cannot fill the memory.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    from PIL import Image  # here: slow to import

    most, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None  # whether it is too large is for the caller to say
    try:
        with Image.open(path) as image:
            columns, rows = image.size
            return int(columns), int(rows)
    except (OSError, ValueError, SyntaxError) as error:
        raise InputError("the image cannot be read", file=path, expected="PNG, TIFF, BMP or JPEG") from error
    finally:
        Image.MAX_IMAGE_PIXELS = most


def read_grey(path: str | os.PathLike[str]) -> NDArray[np.float64]:
    """Grey values ``(rows, columns)`` of an image, share of full scale (12 bit where 16-bit values stay below 4096).

    Raises
    ------
    InputError
        If it cannot be read.
    """
    cv2 = opencv()
    image = cv2.imread(os.fspath(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise InputError("the image cannot be read", file=path, expected="PNG, TIFF, BMP or JPEG")
    if image.ndim == 3:
        image = cv2.cvtColor(image[..., :3], cv2.COLOR_BGR2GRAY)
    full = 255 if image.dtype == np.uint8 else 4095 if image.max() <= 4095 else 65535
    return np.asarray(image, dtype=np.float64) / full


def write_overlay(
    path: str | os.PathLike[str],
    grey: NDArray[np.float64],
    lines: Sequence[tuple[str, NDArray[np.float64], tuple[int, int, int]]],
) -> None:
    """Write an image with lines drawn over it.

    Parameters
    ----------
    lines
        The name of each line, its ends ``(2, 2)`` px, and its colour (blue, green, red).
    """
    cv2 = opencv()
    image = cv2.cvtColor(np.clip(grey * 255, 0, 255).astype(np.uint8), cv2.COLOR_GRAY2BGR)
    size = max(image.shape) / 2400
    for name, ends, colour in lines:
        start, end = (tuple(np.rint(16 * point).astype(int).tolist()) for point in ends)
        cv2.line(image, start, end, colour, max(round(2 * size), 1), cv2.LINE_AA, shift=4)
        for point in (start, end):
            cv2.circle(image, point, int(16 * 7 * size), colour, max(round(2 * size), 1), cv2.LINE_AA, shift=4)
        u, v = ends.mean(axis=0)
        place, width = (int(u + 8 * size), int(v - 8 * size)), max(round(2 * size), 1)
        cv2.putText(image, name, place, cv2.FONT_HERSHEY_SIMPLEX, 0.9 * size, colour, width, cv2.LINE_AA)
    done, encoded = cv2.imencode(".png", image)
    if not done:
        raise InputError("the overlay cannot be encoded", file=path)
    with atomic_path(path) as temporary:
        temporary.write_bytes(encoded.tobytes())
