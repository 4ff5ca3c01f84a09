"""Validation by a schema, each problem in the words of house style: what was got, what was expected, where."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import BaseModel, ValidationError

from ...exceptions import InputError
from ..files.physical_bounds import within_bounds
from ..files.problems import KeyPath, Problems

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

__all__ = ["build", "validate"]

_Model = TypeVar("_Model", bound=BaseModel)
_Built = TypeVar("_Built")
_UNIT_SUFFIXES = ("_mm", "_px", "_rad")

_EXPECTED = {
    "string_type": "text (a number that is meant as text goes in quotes)",
    "int_type": "a whole number",
    "float_type": "a number",
    "list_type": "a list",
}


def validate(model: type[_Model], value: object, path: KeyPath, problems: Problems) -> _Model | None:
    """The section at a path as its model; None, and the reasons in ``problems``, if it cannot be."""
    if not isinstance(value, dict):
        keys = ", ".join(model.model_fields)
        problem = "the section is empty" if value is None else "not a section of keys"
        problems.add(path, problem, got=value, expected=f"keys with values: {keys}")
        return None
    try:
        section = model.model_validate(value)
        return section if within_bounds(section, path, problems) else None
    except ValidationError as error:
        details = error.errors(include_url=False)
    misspelt = _misspelt(model, details)
    for detail in details:
        if detail["type"] == "missing" and detail["loc"][-1] in misspelt.values():
            continue  # it is there, under the misspelt name, which is reported
        _add(detail, model, path, misspelt, problems)
    return None


def build(make: Callable[..., _Built], path: KeyPath, problems: Problems, *arguments: Any) -> _Built | None:
    """What ``make`` returns; None, and the reason in ``problems``, if it raises InputError."""
    try:
        return make(*arguments)
    except InputError as error:
        add_error(error, path, problems)
        return None


def add_error(error: InputError, path: KeyPath, problems: Problems) -> None:
    """Note an error of an object whose fields are the keys of the section at a path (or a value at that path)."""
    key = error.key
    for suffix in _UNIT_SUFFIXES if key else ():
        key = key.removesuffix(suffix) if key else key
    where = (*path, *key.split(".")) if key else path
    problems.add(where, error.problem, got=error.got, expected=error.expected, hint=error.hint)


def _misspelt(model: type[BaseModel], details: Iterable[ErrorDetails]) -> dict[object, str]:
    """The known key that each unknown one is nearest to."""
    result: dict[object, str] = {}
    for detail in details:
        if detail["type"] == "extra_forbidden":
            name = detail["loc"][-1]
            near = difflib.get_close_matches(str(name).lower().replace("-", "_"), model.model_fields, 1, 0.6)
            if near:
                result[name] = near[0]
    return result


def _add(
    detail: ErrorDetails, model: type[BaseModel], path: KeyPath, misspelt: dict[object, str], problems: Problems
) -> None:
    where, kind, got = (*path, *detail["loc"]), detail["type"], detail["input"]
    if kind == "extra_forbidden":
        near = misspelt.get(detail["loc"][-1])
        problems.add(
            where,
            "unknown key",
            expected=f"one of {', '.join(model.model_fields)}",
            hint=f"did you mean '{near}'?" if near else None,
        )
    elif kind == "missing":
        expected = model.model_fields[str(detail["loc"][-1])].description
        problems.add(where, "required key missing", line=problems.line_of(path), expected=expected)
    elif isinstance(cause := detail.get("ctx", {}).get("error"), InputError):
        add_error(cause, where, problems)
    elif got is None:
        problems.add(where, "the key has no value", expected=_EXPECTED.get(kind))
    else:
        problems.add(where, "the value cannot be used", got=got, expected=_EXPECTED.get(kind, _plain(detail["msg"])))


def _plain(message: str) -> str:
    """Pydantic's "Input should be 'ends' or 'whole'" without its beginning."""
    return message.removeprefix("Input should be ")
