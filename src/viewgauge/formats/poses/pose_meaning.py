"""What a file of poses does not say: asked for by name, with a proposal that was found by trying each meaning."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from .pose_columns import ANGLES, LENGTHS
from .pose_file import PoseDocument

__all__ = ["angle_unit", "ask", "length_unit", "rotation_matrices"]

_FEWEST = 3  # rows from which on the size of angles says something
_REACH_M, _LEAST_MM = 20.0, 5.0
"""No arm reaches farther than the first; no set of poses of a robot stays within the second of its base."""


def ask(document: PoseDocument, missing: Sequence[tuple[str, str, str]]) -> InputError:
    """The error that asks for what a file does not say.

    Parameters
    ----------
    missing
        For each: what is not said ("whether lengths are mm or m"), how to say it ("--unit mm or --unit m"), and the
        proposal with its reason, or an empty text.
    """
    where = "say it to viewgauge convert or characterize"
    proposals = "; ".join(proposal for _, _, proposal in missing if proposal)
    return document.error(
        f"the file does not say {', nor '.join(what for what, _, _ in missing)}",
        expected="; ".join(how for _, how, _ in missing),
        hint=f"{where}; proposal: {proposals}" if proposals else f"{where}, as the program that wrote the file has it",
    )


def length_unit(positions: NDArray[np.float64], usual: str | None) -> tuple[str, str, str] | None:
    """What to ask of the unit of positions ``(n, 3)`` as written; None where the format's usual unit is sane."""
    largest = float(np.abs(positions).max(initial=0.0))
    if usual is not None and (largest == 0 or _LEAST_MM < largest * LENGTHS[usual] < 1e3 * _REACH_M):
        return None
    sane = "m" if largest < _REACH_M else "mm"
    what = "whether lengths are in mm, cm, m or inch"
    if usual is not None:
        what += f" (usual is {usual}, of which the largest coordinate, {largest:g}, would be implausible)"
    return what, "--unit mm, cm, m or inch", f"--unit {sane} (the largest coordinate is {largest:g})"


def angle_unit(angles: NDArray[np.float64], usual: str | None) -> tuple[str, str, str] | None:
    """What to ask of the unit of angles ``(n, 3)`` as written; None where the format's usual unit is sane."""
    largest = float(np.abs(angles).max(initial=0.0))
    sane = "rad" if largest <= 2 * np.pi else "deg"
    if usual == sane or (usual is not None and (largest == 0 or (usual == "deg" and len(angles) < _FEWEST))):
        return None
    what = "whether angles are in deg or rad"
    if usual is not None:
        what += f" (usual is {usual}, but the largest is {largest:g})"
    return what, "--angle deg or --angle rad", f"--angle {sane} (the largest angle is {largest:g})"


def rotation_matrices(meaning: str, angles_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(n, 3, 3)`` of angles ``(n, 3)`` rad: ``rotation-vector``, or axes such as ``turning-zyx``.

    With ``fixed`` axes the first angle turns first, about an axis that stays; with ``turning`` axes each next angle
    turns about an axis that the earlier ones have turned.
    """
    from scipy.spatial.transform import Rotation

    if meaning == "rotation-vector":
        return np.asarray(Rotation.from_rotvec(angles_rad).as_matrix())
    frame, _, axes = meaning.partition("-")
    valid = len(axes) == 3 and set(axes) <= set("xyz") and axes[0] != axes[1] != axes[2]
    if frame not in ("fixed", "turning") or not valid:
        raise InputError(
            "unknown meaning of three angles",
            key="--rotation",
            got=meaning,
            expected="rotation-vector, or axes such as fixed-xyz (roll, pitch, yaw) or turning-zyx",
        )
    return np.asarray(Rotation.from_euler(axes if frame == "fixed" else axes.upper(), angles_rad).as_matrix())


def to_mm(unit: str) -> float:
    """Factor of a unit of length."""
    if unit not in LENGTHS:
        raise InputError("unknown unit of length", key="--unit", got=unit, expected=", ".join(LENGTHS))
    return LENGTHS[unit]


def to_rad(unit: str) -> float:
    """Factor of a unit of angles."""
    if unit not in ANGLES:
        raise InputError("unknown unit of angles", key="--angle", got=unit, expected=", ".join(ANGLES))
    return ANGLES[unit]
