"""A file that may be a calibration: its text, its values, and the checks of numbers that all formats share."""

from __future__ import annotations

import json
import math
import os
import re
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...files.problems import KeyPath, Problems
from ...files.yaml_tree import parse_yaml
from .opencv_xml import is_opencv_xml, opencv_xml_values

__all__ = ["CalibrationDocument"]

_TAGS = re.compile(r"!!(?:opencv-[a-z-]+|python/tuple)|!<tag:yaml\.org,2002:opencv-[a-z-]+>")
_MESSAGE_END = re.compile(r"^---[ \t]*$", re.M)
_DATA_KEYS = {"data", "rows", "cols", "dt", "type_id", "sizes", "shape", "channels"}
_DEEPEST = 4  # lists in lists that are taken for one list of numbers


class CalibrationDocument:
    """A file that may be a calibration, with the problems that were found in it.

    Parameters
    ----------
    text
        The whole file.
    """

    def __init__(self, path: str | os.PathLike[str], text: str) -> None:
        self.path, self.text, self.problems = path, text, Problems(path)

    @property
    def is_opencv(self) -> bool:
        """Whether OpenCV's ``FileStorage`` has written it, by its first lines or its matrices."""
        return "%YAML:1.0" in self.text or "opencv-matrix" in self.text or is_opencv_xml(self.text)

    @cached_property
    def values(self) -> Any:
        """The content as plain values, keys such as ``Camera.fx`` taken apart at their first point."""
        values = self._parsed()
        return _taken_apart(values) if isinstance(values, dict) else values

    def _parsed(self) -> Any:
        """The whole file as dicts, lists, numbers and texts, where it is YAML, JSON or OpenCV's XML; else None."""
        text = self.text
        if text.lstrip().startswith("<"):
            return opencv_xml_values(text, self.problems)
        if text.lstrip()[:1] in ("{", "["):
            try:
                return json.loads(text, object_pairs_hook=_once)
            except (ValueError, RecursionError):
                pass  # YAML may know it, and else says where it is wrong
        plain = _TAGS.sub("", text.replace("%YAML:1.0", "#", 1))
        messages = [message for message in _MESSAGE_END.split(plain) if _has_content(message)]
        if len(messages) < 2:
            return parse_yaml(plain if not messages else _blank_ends(plain), self.problems).value
        return self._one_message(messages)

    @property
    def sections(self) -> dict[str, Any]:
        """Its keys, where it is a mapping; none where it is not."""
        return self.values if isinstance(self.values, dict) else {}

    def _one_message(self, messages: list[str]) -> Any:
        """The content of a topic that was printed several times; a problem where the messages differ."""
        values = [parse_yaml(message, self.problems).value for message in messages]
        bare = [{k: v for k, v in value.items() if k != "header"} for value in values if isinstance(value, dict)]
        if len(bare) < len(values) or any(other != bare[0] for other in bare[1:]):
            expected = "one camera, or the same message again"
            self.problems.add((), "the file has several documents that differ", got=len(values), expected=expected)
            return None
        return values[0]

    def matrix(self, where: KeyPath, value: object, shape: tuple[int, int]) -> NDArray[np.float64] | None:
        """A matrix as rows, as one row, or as OpenCV's mapping with ``data``; None where a problem was noted."""
        numbers = self.numbers(where, value, (shape[0] * shape[1],))
        return None if numbers is None else np.array(numbers).reshape(shape)

    def numbers(self, where: KeyPath, value: object, counts: tuple[int, ...] | None) -> list[float] | None:
        """Finite numbers, of one of the counts, from a list, lists in it, or a mapping with ``data``.

        None where a problem was noted.
        """
        expected = "finite numbers" if counts is None else f"{' or '.join(map(str, counts))} finite numbers"
        flat = _flat(value)
        if flat is None or not all(_is_number(item) for item in flat):
            self.problems.add(where, "not a list of numbers", got=_short(value), expected=expected)
            return None
        if counts is not None and len(flat) not in counts:
            self.problems.add(where, "another number of values", got=f"{len(flat)} values", expected=expected)
            return None
        rows, cols = (value.get(key) for key in ("rows", "cols")) if isinstance(value, dict) else (None, None)
        if isinstance(rows, int) and isinstance(cols, int) and len(flat) % max(rows * cols, 1):
            got = f"{len(flat)} values for {rows} rows and {cols} columns"
            self.problems.add(where, "another number of values than rows and columns say", got=got)
            return None
        return [float(item) for item in flat if isinstance(item, int | float)]

    def number(self, where: KeyPath, value: object) -> float | None:
        """One finite number; None where a problem was noted."""
        if not _is_number(value):
            self.problems.add(where, "not a number", got=_short(value), expected="a finite number")
            return None
        return float(value)  # type: ignore[arg-type]  # it is a number

    def resolution(self, where: KeyPath, size: list[float] | None) -> tuple[int, int] | None:
        """Columns and rows; None where there are none or a problem was noted."""
        if size is None:
            return None
        if any(not 1 <= count < 1e9 or count % 1 for count in size):
            self.problems.add(where, "not columns and rows", got=size, expected="two positive whole numbers")
            return None
        return int(size[0]), int(size[1])


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A mapping; ValueError where a key is there twice, which YAML then reports with its line."""
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key is there twice")
    return found


def _taken_apart(values: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in values.items():
        head, point, tail = str(key).partition(".")
        if point and head and tail and head not in values:
            found.setdefault(head, {})[tail] = value
        else:
            found[key] = value
    return found


def _has_content(message: str) -> bool:
    lines = (line.strip() for line in message.splitlines())
    return any(line and not line.startswith(("#", "%")) for line in lines)


def _blank_ends(text: str) -> str:
    """Without the lines that end a message, so that the lines keep their numbers."""
    return _MESSAGE_END.sub("", text)


def _flat(value: object, depth: int = 0) -> list[object] | None:
    """The items of lists in lists, or of a mapping with ``data``; None where it is neither."""
    if isinstance(value, dict) and "data" in value and value.keys() <= _DATA_KEYS:
        value = value["data"]
    if not isinstance(value, list) or depth > _DEEPEST:
        return None
    flat: list[object] = []
    for item in value:
        inner = _flat(item, depth + 1) if isinstance(item, list) else [item]
        if inner is None:
            return None
        flat += inner
    return flat


def _is_number(item: object) -> bool:
    if isinstance(item, bool) or not isinstance(item, int | float):
        return False
    try:
        return math.isfinite(float(item))
    except OverflowError:  # a whole number beyond all doubles
        return False


def _short(value: object) -> str:
    text = str(value)
    return text if len(text) <= 80 else text[:80] + " …"
