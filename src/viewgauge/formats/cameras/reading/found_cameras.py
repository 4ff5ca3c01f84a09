"""The sections of a file that are cameras, however deep they lie, and the account of what stands around them.

A camera is a mapping with a camera matrix, or with fx. It may lie in a mapping by its name, in a list, or share a
mapping with another camera whose keys differ by a side: ``M1, D1, M2, D2``, ``camera_matrix_left``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

from ...files.problems import KeyPath
from .calibration_document import CalibrationDocument
from .key_account import KeyAccount
from .key_names import (
    DISTORTION,
    FISHEYE_FLAG,
    FOCAL_PAIR,
    HEIGHT,
    MATRIX,
    MODEL,
    PRINCIPAL_PAIR,
    RADIAL,
    SCALARS,
    SIZE,
    SIZE_ROWS_FIRST,
    WIDTH,
    is_matrix,
    plain_name,
)

__all__ = ["FoundCamera", "chosen_camera", "find_cameras", "only_or_named"]

_DEEPEST = 6
_SHARED = WIDTH | HEIGHT | SIZE | SIZE_ROWS_FIRST | FISHEYE_FLAG | {"distortionmodel", "cameramodel"}
_SIDE = r"(left|right|l|r|cam[0-9]|camera[0-9]|[0-9])"
_NAMES = ("camera_name", "name", "label", "id", "camera_id", "cameraName", "frame_id")
_INNER_NAMES = {"matrix", "k", "cameramatrix", "parameters", "params", "values", "data"}


@dataclass(frozen=True)
class FoundCamera:
    """A camera of a file.

    Parameters
    ----------
    section
        Its keys, with what its neighbours share with it.
    around
        Sections that it lies in, with their place; their other keys are accounted for with the camera's.
    without_side
        Keys that say the camera's side, each without it: ``{"M1": "m"}``.
    """

    name: str
    where: KeyPath
    section: dict[str, Any]
    around: tuple[tuple[KeyPath, dict[str, Any]], ...] = field(default=(), compare=False)
    without_side: dict[str, str] = field(default_factory=dict)

    def close_around(self, document: CalibrationDocument) -> None:
        """Note a problem for each key beside the camera's sections that is not known to be harmless."""
        for where, section in self.around:
            KeyAccount(document, where, section).close()

    def account(self, document: CalibrationDocument) -> KeyAccount:
        """The account of its keys."""
        return KeyAccount(document, self.where, self.section, self.without_side)


def find_cameras(values: object) -> list[FoundCamera]:
    """Every camera of a file's values, in the file's order."""
    return _found(values, (), "", {}, ())


def only_or_named(document: CalibrationDocument, names: list[str], name: str | None) -> str | None:
    """The name that is meant; None, with a problem, where it is not there or has to be asked for."""
    if name is None and len(names) == 1:
        return names[0]
    if name is not None and names in ([""], ["camera"]) and name not in names:
        document.problems.add((), "the file has one camera without a name", got=name, hint="leave the name out")
        return None
    same = [each for each in names if each == name] or [each for each in names if each.lower() == str(name).lower()]
    if name is not None and same:
        return same[0]
    problem = "no such camera in the file" if name else "the file has several cameras"
    hint = None if name else "name one: calibration_camera in the inspection file, --name in the command"
    document.problems.add((), problem, got=name, expected=" or ".join(names), hint=hint)
    return None


def chosen_camera(document: CalibrationDocument, cameras: list[FoundCamera], name: str | None) -> FoundCamera | None:
    """The camera that is meant; None where a problem was noted."""
    meant = only_or_named(document, [camera.name for camera in cameras], name)
    return next((camera for camera in cameras if camera.name == meant), None)


def is_camera(section: dict[str, Any]) -> bool:
    """Whether a mapping has a camera's optics."""
    names = {plain_name(key): value for key, value in section.items()}
    if any(name in MATRIX and _is_optics(value) for name, value in names.items()):
        return True
    scalars = [any(name in SCALARS[which] for name in names) for which in ("fx", "cx")]
    pairs = [names.keys() & pair for pair in (FOCAL_PAIR, PRINCIPAL_PAIR)]
    return all(scalars) or all(pairs) or bool(names.keys() & RADIAL) or "mappingcoefficients" in names


def _is_optics(value: object) -> bool:
    return is_matrix(value) or (isinstance(value, dict) and (is_camera(value) or bool(_inner(value))))


def _inner(value: dict[str, Any]) -> list[str]:
    return [key for key in value if plain_name(key) in _INNER_NAMES and is_matrix(value[key])]


def _found(
    value: object, where: KeyPath, name: str, shared: dict[str, Any], around: tuple[tuple[KeyPath, dict[str, Any]], ...]
) -> list[FoundCamera]:
    if len(where) > _DEEPEST:
        return []
    if isinstance(value, list):
        return [
            camera
            for index, item in enumerate(value)
            for camera in _found(item, (*where, index), _name_of(item) or str(index), shared, around)
        ]
    if not isinstance(value, dict):
        return []
    if is_camera(value):
        section = _flattened({**shared, **value})
        return [FoundCamera(name, where, section, around)]
    sides = _sides(value)
    if sides:
        return _of_sides(value, sides, where, (shared, around))
    common = {key: item for key, item in value.items() if plain_name(key) in _SHARED and not isinstance(item, dict)}
    below = {key: item for key, item in value.items() if _has_camera(item, len(where))}
    beside = {key: item for key, item in value.items() if key not in below and key not in common}
    own = _name_of(value)
    found: list[FoundCamera] = []
    for key, item in below.items():
        inner = own if own and len(below) == 1 else str(key)
        if isinstance(item, dict) and len(below) == 1 and name and plain_name(str(key)) in ("camera", "intrinsics"):
            inner = _name_of(item) or name
        found += _found(item, (*where, key), inner, {**shared, **common}, (*around, (where, beside)))
    return found


def _has_camera(value: object, depth: int) -> bool:
    if depth > _DEEPEST:
        return False
    if isinstance(value, dict):
        return is_camera(value) or bool(_sides(value)) or any(_has_camera(item, depth + 1) for item in value.values())
    return isinstance(value, list) and any(_has_camera(item, depth + 1) for item in value if isinstance(item, dict))


def _name_of(value: object) -> str | None:
    if not isinstance(value, dict):
        return None
    name = next((value[key] for key in _NAMES if isinstance(value.get(key), str | int)), None)
    return None if name is None else str(name)


def _sides(value: dict[str, Any]) -> dict[str, dict[str, str]]:
    """Keys of cameras that share a mapping: by side, the key of each and its name without the side."""
    found: dict[str, dict[str, str]] = {}
    for key, item in value.items():
        if not (is_matrix(item) or isinstance(item, dict)):
            continue
        name = plain_name(key)
        match = re.fullmatch(rf"{_SIDE}?(.+?){_SIDE}?", name)
        if match is None or (match[1] is None) == (match[3] is None):
            continue
        base, side = match[2], match[1] or match[3]
        if (base in MATRIX and is_matrix(item)) or (base in DISTORTION and is_matrix(item)):
            found.setdefault(side, {})[key] = base
    return {side: keys for side, keys in found.items() if any(base in MATRIX for base in keys.values())}


def _of_sides(
    value: dict[str, Any],
    sides: dict[str, dict[str, str]],
    where: KeyPath,
    beside: tuple[dict[str, Any], tuple[tuple[KeyPath, dict[str, Any]], ...]],
) -> list[FoundCamera]:
    shared, around = beside
    taken = {key for keys in sides.values() for key in keys}
    common = {key: item for key, item in value.items() if plain_name(key) in _SHARED | MODEL and key not in taken}
    others = {key: item for key, item in value.items() if key not in taken and key not in common}
    return [
        FoundCamera(
            side, where, {**shared, **common, **{key: value[key] for key in keys}}, (*around, (where, others)), keys
        )
        for side, keys in sides.items()
    ]


def _flattened(section: dict[str, Any]) -> dict[str, Any]:
    """A camera's keys with those of the mappings ``intrinsics``, ``distortion`` and ``size`` below it taken up."""
    flat: dict[str, Any] = {}
    for key, value in section.items():
        name = plain_name(key)
        if not isinstance(value, dict) or is_matrix(value):
            flat[key] = value
        elif name in MATRIX:
            for inner, item in value.items():
                flat["camera_matrix" if inner in _inner(value) else inner] = item
        elif name in DISTORTION:
            flat.update(_distortion_keys(value))
        elif name in SIZE:
            flat.update(value)
        elif (name in FOCAL_PAIR and {"x", "y"} <= value.keys()) or (
            name in PRINCIPAL_PAIR and {"x", "y"} <= value.keys()
        ):
            flat[key] = [value["x"], value["y"]]
        else:
            flat[key] = value
    return flat


def _distortion_keys(value: dict[str, Any]) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, item in value.items():
        name = plain_name(key)
        if is_matrix(item) and name in DISTORTION | {"parameters", "params", "values", "k"}:
            flat["distortion_coefficients"] = item
        elif isinstance(item, str) and name in MODEL | {"name"}:
            flat["distortion_model"] = item
        else:
            flat[key] = item
    return flat
