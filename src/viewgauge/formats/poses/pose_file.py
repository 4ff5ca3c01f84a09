"""The content of a file of poses, what was said of its meaning, and the protocol of its readers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ..files.problems import Problems
from ..files.text import read_text
from ..files.yaml_tree import YamlTree, parse_yaml
from .number_table import NumberTable

__all__ = ["PoseConventions", "PoseDocument", "PoseFile", "PoseFormat", "rigid"]

_NEAR_ROTATION = 1e-3  # three printed digits of a matrix
_MAPPING = re.compile(r"^\s*(- )?[\w\"']+\s*:(\s|$)", re.M)


@dataclass(frozen=True)
class PoseConventions:
    """What a user says of a file that does not say it itself; None where nothing was said.

    Parameters
    ----------
    kind
        Key of the format, such as ``kuka``.
    unit
        Of lengths: ``mm``, ``cm``, ``m`` or ``inch``.
    angle
        Of angles: ``deg`` or ``rad``.
    rotation
        What three angles mean: ``rotation-vector``, or axes such as ``fixed-xyz`` or ``turning-zyx``.
    quaternion
        Order of a quaternion whose numbers have no names: ``wxyz`` or ``xyzw``.
    inverse
        The file has the inverse of the poses that are wanted.
    """

    kind: str | None = None
    unit: str | None = None
    angle: str | None = None
    rotation: str | None = None
    quaternion: str | None = None
    inverse: bool = False


@dataclass(frozen=True)
class PoseFile:
    """Poses of a file.

    Parameters
    ----------
    format
        Name of the format.
    names
        Of the n poses.
    poses
        ``(n, 4, 4)`` mm: the moving frame (flange, tool, camera) in the fixed one, as the file states it.
    notes
        What was taken from the format and not from the file, and what has no effect here.
    covariance
        ``(6, 6)`` mm and rad, translation first, along the axes of the fixed frame; None where none is stated.
    """

    format: str
    names: tuple[str, ...]
    poses: NDArray[np.float64]
    notes: tuple[str, ...] = ()
    covariance: NDArray[np.float64] | None = None


class PoseDocument:
    """A file that may hold poses; it is read as a format asks: as text, as a table or as YAML."""

    def __init__(self, path: Path, text: str | None = None) -> None:
        self.path = path
        self.text = read_text(path, InputError) if text is None else text

    @cached_property
    def table(self) -> NumberTable:
        """Rows of cells; empty where the text is no table."""
        return NumberTable.of(self.path, self.text)

    @cached_property
    def trees(self) -> tuple[YamlTree, ...]:
        """The YAML documents; none where the text is no YAML of keys, or is OpenCV's."""
        if self.text.startswith("%YAML:1.0") or not _MAPPING.search(self.text):
            return ()
        trees: list[YamlTree] = []
        lines = self.text.splitlines()
        marks = [k for k, line in enumerate(lines) if line.rstrip() in ("---", "...")]
        for first, last in zip([0, *(mark + 1 for mark in marks)], [*marks, len(lines)], strict=True):
            if any(line.strip() and not line.lstrip().startswith("#") for line in lines[first:last]):
                problems = Problems(self.path)
                tree = parse_yaml("\n" * first + "\n".join(lines[first:last]), problems)
                if problems.found and not trees:
                    return ()
                problems.raise_if_any()
                trees.append(tree)
        return tuple(trees)

    def error(self, problem: str, *, line: int | None = None, key: str | None = None, **said: str | None) -> InputError:
        """An error of this file."""
        return InputError(problem, file=self.path, line=line, key=key, **said)


class PoseFormat(Protocol):
    """Reads one format of poses."""

    @property
    def key(self) -> str:
        """By which a user names it: ``kuka``."""
        ...

    @property
    def name(self) -> str:
        """In messages and in the documentation: "KUKA X Y Z A B C"."""
        ...

    @property
    def form(self) -> str:
        """What the file holds and what the format says of it: units, order, axes."""
        ...

    @property
    def cannot_say(self) -> str:
        """What such a file cannot say, and how the user states it; "-" if nothing."""
        ...

    def recognises(self, document: PoseDocument) -> bool:
        """Whether a file is of this format, by its content."""
        ...

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses; raises InputError where the file cannot be used or more must be said of it."""
        ...


def rigid(
    document: PoseDocument, line: int | None, position_mm: Sequence[float] | NDArray[np.float64], matrix: object
) -> NDArray[np.float64]:
    """A pose ``(4, 4)`` of a position ``(3,)`` mm and a rotation ``(3, 3)``, made orthonormal where digits are few.

    Raises
    ------
    InputError
        If the matrix is no rotation.
    """
    R = np.asarray(matrix, dtype=float)
    u, _, v = np.linalg.svd(R)
    nearest = u @ v
    if np.abs(nearest - R).max() > _NEAR_ROTATION or np.linalg.det(nearest) < 0:
        raise document.error(
            "the 3x3 block is not a rotation",
            line=line,
            got=f"determinant {np.linalg.det(R):.4g}, off an orthonormal matrix by {np.abs(nearest - R).max():.2g}",
            expected="three orthogonal columns of length 1, right-handed",
        )
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = nearest, position_mm
    return T
