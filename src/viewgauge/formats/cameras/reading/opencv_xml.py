"""The XML of OpenCV's ``FileStorage`` as plain values."""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree

from ...files.problems import Problems

__all__ = ["is_opencv_xml", "opencv_xml_values"]

_ROOT = re.compile(r"<\s*opencv_storage\b")
_DECLARATION = re.compile(r"<!\s*(?:DOCTYPE|ENTITY)", re.I)
_INTEGER = re.compile(r"[+-]?\d+")
_DEEPEST = 50


def is_opencv_xml(text: str) -> bool:
    """Whether a file is XML that OpenCV has written."""
    return text.lstrip().startswith("<") and _ROOT.search(text) is not None


def opencv_xml_values(text: str, problems: Problems) -> Any:
    """The values below ``opencv_storage``; None where it is something else, or a problem was noted."""
    if not is_opencv_xml(text):
        return None
    if _DECLARATION.search(text):  # entities could make much of little
        problems.add((), "not the XML of OpenCV: a document type is declared", expected="<opencv_storage> alone")
        return None
    try:
        root = ElementTree.fromstring(text.strip())
        return _value(root)
    except ElementTree.ParseError as error:
        problems.add((), f"not valid XML: {error.msg}", line=error.position[0])
    except (RecursionError, _TooDeepError):
        problems.add((), "not usable XML: nested too deeply", line=1)
    except _TwiceError as error:
        problems.add((), "the key is there twice", got=str(error), hint="remove one")
    return None


class _TooDeepError(Exception):
    """Elements in elements beyond what any calibration has."""


class _TwiceError(Exception):
    """A key that is there twice."""


def _value(element: ElementTree.Element, depth: int = 0) -> Any:
    if depth > _DEEPEST:
        raise _TooDeepError
    children = list(element)
    if not children:
        return _scalars(element.text or "")
    if all(child.tag == "_" for child in children):
        return [_value(child, depth + 1) for child in children]
    found: dict[str, Any] = {}
    for child in children:
        if child.tag in found:
            raise _TwiceError(child.tag)
        found[child.tag] = _value(child, depth + 1)
    if "data" in found and not isinstance(found["data"], list):
        found["data"] = [] if found["data"] is None else [found["data"]]
    return found


def _scalars(text: str) -> Any:
    """A number, a list of numbers, a text, or None where there is nothing."""
    words = text.split()
    if not words:
        return None
    try:
        numbers = [int(word) if _INTEGER.fullmatch(word) and len(word) < 20 else float(word) for word in words]
    except ValueError:
        return text.strip().strip('"')
    return numbers if len(numbers) > 1 else numbers[0]
