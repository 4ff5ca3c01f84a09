"""Pose errors from poses that were commanded and measured, or measured again and again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...exceptions import InputError
from ...geometry import invert

__all__ = ["PoseSamples", "errors_about_group_means", "errors_of_poses"]

_MEAN_STEPS = 20


@dataclass(frozen=True)
class PoseSamples:
    """Pose errors of n samples.

    Parameters
    ----------
    errors
        ``(n, 6)`` [x, y, z, rx, ry, rz], mm and rad, translation first, pose error frame, perturbation on the left: as
        in :class:`~viewgauge.geometry.PoseError`.
    names
        Of the samples, for messages.
    parameters
        How many of the ``6 n`` numbers a model was fitted with, which the errors are residuals of.
    repeated
        The errors are about the means of groups: they have no mean of their own.
    noise
        ``(n, 6, 6)``: covariance of what measuring the pose added to each error, same units and frame; None where that
        counts for nothing.
    """

    errors: NDArray[np.float64]
    names: tuple[str, ...]
    parameters: int = 0
    repeated: bool = False
    noise: NDArray[np.float64] | None = None


def errors_of_poses(T_base_commanded: NDArray[np.float64], T_base_measured: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(n, 6)``: the error with which each pose was reached, pose error frame.

    A point of the scene, seen from the pose error frame, is displaced by ``Trans(d) Rot_x Rot_y Rot_z`` (paper, eq. 6),
    the inverse of the measured pose times the commanded one; from that matrix d and the three angles, exactly.

    Parameters
    ----------
    T_base_commanded, T_base_measured
        ``(n, 4, 4)`` mm: the pose error frame in a fixed frame.
    """
    displacement = invert(np.asarray(T_base_measured)) @ np.asarray(T_base_commanded)
    return displacement_parameters(displacement)


def displacement_parameters(displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(..., 6)`` of displacements ``Trans(d) Rot_x Rot_y Rot_z`` ``(..., 4, 4)``; angles below 90 degrees."""
    from scipy.spatial.transform import Rotation  # late: slow to import

    R = displacement[..., :3, :3]
    angles = Rotation.from_matrix(R.reshape(-1, 3, 3)).as_euler("XYZ").reshape(*R.shape[:-2], 3)
    return np.concatenate([displacement[..., :3, 3], angles], axis=-1)


def errors_about_group_means(
    T_base_measured: NDArray[np.float64], group: Sequence[str]
) -> tuple[NDArray[np.float64], int]:
    """``(n, 6)`` errors about the mean pose of each group of repeated visits, pose error frame, and the number of
    groups.

    The mean pose is the one about which the errors have no mean. Groups of one visit say nothing and raise.

    Parameters
    ----------
    T_base_measured
        ``(n, 4, 4)`` mm.
    group
        For each of them the pose that was commanded, by any name.
    """
    names = np.asarray(group)
    errors = np.zeros((len(names), 6))
    groups = np.unique(names)
    for name in groups:
        rows = np.flatnonzero(names == name)
        if len(rows) < 2:
            raise InputError(
                "a pose was visited only once", key="pose", got=str(name), expected="each pose twice or more"
            )
        poses = T_base_measured[rows]
        mean = poses[0]
        for _ in range(_MEAN_STEPS):
            found = errors_of_poses(np.broadcast_to(mean, poses.shape), poses)
            step = found.mean(axis=0)
            if np.abs(step).max() < 1e-13:
                break
            mean = mean @ invert(_displacement(step))
        errors[rows] = found
    return errors, len(groups)


def _displacement(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(4, 4)``: ``Trans(d) Rot_x Rot_y Rot_z``."""
    from scipy.spatial.transform import RigidTransform, Rotation

    turn = Rotation.from_euler("XYZ", parameters[3:])
    return np.asarray(RigidTransform.from_components(parameters[:3], turn).as_matrix())
