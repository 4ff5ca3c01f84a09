"""Triangle strips of PLY files: an element ``tristrips`` whose lists of vertices -1 divides."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import IO

import numpy as np
from numpy.typing import NDArray

__all__ = ["has_strips", "read_strips"]

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}
_LONGEST_HEADER = 65_536


@dataclass
class _Element:
    name: str
    count: int
    properties: list[tuple[str, str, str]] = field(default_factory=list)
    """Name, type, and the type of the count where it is a list, else empty."""


def has_strips(file: IO[bytes]) -> bool:
    """Whether the header of a PLY file declares triangle strips; the file is read from its start and left there."""
    start = file.read(_LONGEST_HEADER)
    file.seek(0)
    return any(line.split()[:2] == [b"element", b"tristrips"] for line in start.split(b"end_header")[0].splitlines())


def read_strips(file: IO[bytes]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices ``(n, 3)`` and triangles ``(m, 3)`` of a PLY file with triangle strips; raises ValueError.

    Every second triangle of a strip is turned, so that all face as the first does.
    """
    order, elements = _header(file)
    values = _AsciiValues(file) if order == "" else _BinaryValues(file, order)
    vertices = np.zeros((0, 3))
    triangles: list[tuple[int, int, int]] = []
    for element in elements:
        names = [name for name, _, _ in element.properties]
        rows = [values.row(element) for _ in range(element.count)]
        if element.name == "vertex":
            try:
                axes = [names.index(axis) for axis in "xyz"]
            except ValueError:
                raise ValueError("its vertices lack x, y or z") from None
            vertices = np.array([[row[axis][0] for axis in axes] for row in rows], dtype=float).reshape(-1, 3)
        elif element.name in ("tristrips", "face"):
            for row in rows:
                for name, of_row in zip(names, row, strict=True):
                    if name in ("vertex_indices", "vertex_index"):
                        triangles += _of_strips(of_row) if element.name == "tristrips" else _of_polygon(of_row)
    return vertices, np.array(triangles, dtype=np.int64).reshape(-1, 3)


def _header(file: IO[bytes]) -> tuple[str, list[_Element]]:
    order: str | None = None
    elements: list[_Element] = []
    for _ in range(10_000):
        words = file.readline(_LONGEST_HEADER).decode("ascii", "replace").split()
        if not words:
            continue
        if words[0] == "end_header":
            break
        if words[0] == "format":
            order = _ORDERS[words[1]]
        elif words[0] == "element":
            elements.append(_Element(words[1], int(words[2])))
        elif words[0] == "property" and words[1] == "list":
            elements[-1].properties.append((words[4], _TYPES[words[3]], _TYPES[words[2]]))
        elif words[0] == "property":
            elements[-1].properties.append((words[2], _TYPES[words[1]], ""))
    else:
        raise ValueError("its header has no end")
    if order is None:
        raise ValueError("its header names no format")
    return order, elements


class _AsciiValues:
    def __init__(self, file: IO[bytes]) -> None:
        self._file = file

    def row(self, element: _Element) -> list[list[float]]:
        words = self._file.readline().split()
        if not words:
            raise ValueError(f"it ends within the element {element.name}")
        found, at = [], 0
        for _, _, of_count in element.properties:
            count, at = (int(words[at]), at + 1) if of_count else (1, at)
            if len(words) < at + count:
                raise ValueError(f"a line of the element {element.name} is too short")
            found.append([float(word) for word in words[at : at + count]])
            at += count
        return found


class _BinaryValues:
    def __init__(self, file: IO[bytes], order: str) -> None:
        self._file, self._order = file, order

    def row(self, element: _Element) -> list[list[float]]:
        found = []
        for _, kind, of_count in element.properties:
            count = int(self._numbers(of_count, 1)[0]) if of_count else 1
            found.append(self._numbers(kind, count))
        return found

    def _numbers(self, kind: str, count: int) -> list[float]:
        form = np.dtype(self._order + kind)
        if count < 0:
            raise ValueError("a list of negative length")
        data = self._file.read(count * form.itemsize)
        if len(data) != count * form.itemsize:
            raise ValueError("it ends too soon")
        return [float(value) for value in np.frombuffer(data, form)]


def _of_strips(values: list[float]) -> list[tuple[int, int, int]]:
    """Triangles of strips that -1 divides."""
    triangles: list[tuple[int, int, int]] = []
    strip: list[int] = []
    for value in [*map(int, values), -1]:
        if value >= 0:
            strip.append(value)
            continue
        for k in range(len(strip) - 2):
            a, b, c = strip[k : k + 3]
            triangles.append((a, b, c) if k % 2 == 0 else (b, a, c))
        strip = []
    return triangles


def _of_polygon(values: list[float]) -> list[tuple[int, int, int]]:
    corners = [int(value) for value in values]
    return [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
