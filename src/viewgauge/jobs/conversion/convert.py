"""A foreign file in another format: the kind of its content is found by asking each conversion."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from ...exceptions import InputError
from ...formats.files.registry import Registry
from .camera_conversion import CameraConversion
from .conversion import Conversion, Converted
from .pose_conversion import PoseConversion

__all__ = ["CONVERSIONS", "convert"]

CONVERSIONS: Registry[Conversion] = Registry(PoseConversion(), CameraConversion())


def convert(
    source: str | os.PathLike[str],
    output: str | os.PathLike[str],
    target: str | None = None,
    meanings: Mapping[str, str] | None = None,
    accept: Iterable[str] = (),
) -> Converted:
    """Write the content of a foreign file in another format.

    Parameters
    ----------
    target
        The format to write; by default the first of the kind of content that the file has.
    meanings
        What the user states because the file cannot say it, such as ``{"model": "fisheye"}``.
    accept
        Names of findings that the user accepts.

    Raises
    ------
    InputError
        If the file is of no known format, cannot be used, or the target is of another kind of content.
    """
    path = Path(source)
    if not path.is_file():
        raise InputError("the file does not exist, or is not a file", file=path, hint="check the path")
    found = _conversion(path, target)
    stated = dict(meanings or {})
    foreign = [name for name in stated if name not in found.meanings]
    if foreign:
        raise InputError(
            f"--{foreign[0]} says nothing of a {found.kind} file",
            file=path,
            got=stated[foreign[0]],
            expected=", ".join(f"--{name}" for name in found.meanings),
        )
    return found.write(path, Path(output), target or next(iter(found.targets)), stated, tuple(accept))


def _conversion(path: Path, target: str | None) -> Conversion:
    """The conversion of the kind of content that the file has; raises InputError."""
    known = {name: conversion for conversion in CONVERSIONS for name in conversion.targets}
    if target is not None and target not in known:
        raise InputError("an unknown format to write", key="--as", got=target, expected=", ".join(known))
    recognised = [conversion for conversion in CONVERSIONS if conversion.recognises(path)]
    if target is not None and (not recognised or known[target] in recognised):
        return known[target]  # which says what is wrong with the file
    if not recognised:
        kinds = " or ".join(f"a {conversion.kind} file" for conversion in CONVERSIONS)
        raise InputError("the format of the file is not known", file=path, expected=kinds, hint="see --as")
    if target is not None:
        raise InputError(
            f"the file has a {recognised[0].kind}, which is not written in this format",
            file=path,
            key="--as",
            got=target,
            expected=", ".join(recognised[0].targets),
        )
    return recognised[0]
