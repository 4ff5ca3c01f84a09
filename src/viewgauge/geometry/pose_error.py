"""The error of the camera's pose, with the frame in which it acts."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..exceptions import InputError
from .poses import require_poses, skew

__all__ = ["PoseError", "covariance_factor"]

_RELATIVE_PSD_TOLERANCE = 1e-9  # of the largest eigenvalue after scaling: what rounding of six printed digits leaves
_UNDERFLOWS = 1e-150  # when squared


@dataclass(frozen=True, eq=False)  # arrays do not compare to one truth value
class PoseError:
    """A normally distributed small error of the camera's pose (paper, eq. 6 and 9).

    The error is stated in the frame in which it acts, such as that of a robot's flange, the *pose error frame*. A point
    of the scene at position q in that frame is displaced by ``delta x q + d``: (d, delta) is a perturbation on the
    left.

    Parameters
    ----------
    covariance
        ``(6, 6)`` covariance of [x, y, z, rx, ry, rz], mm and rad, translation first, in the frame in which the error
        acts, left perturbation.
    pivot_mm
        ``(3,)`` mm, camera frame: origin of the frame in which the error acts, its axes parallel to the camera's.
    T_camera_frame
        ``(4, 4)`` pose of the frame in which the error acts, in the camera frame, in place of ``pivot_mm``.
    common_covariance
        ``(6, 6)``: the part of ``covariance`` that is the same error in every acquisition (calibration, hand-eye), same
        frame and order; None where it is not stated. The rest is drawn anew in each acquisition.

    Raises
    ------
    InputError
        If a covariance is not a finite, symmetric, positive semidefinite 6x6 matrix, if the common part is more than
        the whole, or if the pose is not rigid.
    """

    covariance: NDArray[np.float64]
    pivot_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    T_camera_frame: NDArray[np.float64] | None = field(default=None)
    common_covariance: NDArray[np.float64] | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "covariance", _require_covariance(self.covariance))
        if self.common_covariance is not None:
            common = _require_covariance(self.common_covariance, "common covariance")
            _require_part(common, self.covariance)
            object.__setattr__(self, "common_covariance", common)
        if self.T_camera_frame is not None:
            if tuple(self.pivot_mm) != (0.0, 0.0, 0.0):
                raise InputError("give pivot_mm or T_camera_frame, not both")
            pose = require_poses(self.T_camera_frame, "T_camera_frame")
            if pose.shape != (4, 4):
                raise InputError("T_camera_frame must be one 4x4 matrix", got=f"shape {pose.shape}")
        else:
            pivot = np.asarray(self.pivot_mm, dtype=float)
            if pivot.shape != (3,) or not np.isfinite(pivot).all():
                raise InputError("pivot_mm must be three finite numbers", got=self.pivot_mm)
            pose = np.eye(4)
            pose[:3, 3] = pivot
        object.__setattr__(self, "T_camera_frame", pose)

    @classmethod
    def from_standard_deviations(
        cls,
        translation_mm: ArrayLike,
        rotation_rad: ArrayLike,
        *,
        pivot_mm: tuple[float, float, float] = (0.0, 0.0, 0.0),
        T_camera_frame: NDArray[np.float64] | None = None,
    ) -> PoseError:
        """Independent errors with one or three standard deviations for translation (mm) and rotation (rad)."""
        deviations = np.empty(6)
        for part, name, value in (
            (slice(0, 3), "translation_mm", translation_mm),
            (slice(3, 6), "rotation_rad", rotation_rad),
        ):
            given = np.asarray(value, dtype=float)
            if given.shape not in ((), (3,)) or not np.isfinite(given).all() or (given < 0).any():
                raise InputError(f"{name} must be one or three standard deviations, finite and not negative", got=value)
            deviations[part] = given
        return cls(np.diag(deviations**2), pivot_mm=pivot_mm, T_camera_frame=T_camera_frame)

    @property
    def repeatability_covariance(self) -> NDArray[np.float64] | None:
        """``(6, 6)``, pose error frame: covariance of the error that is drawn anew in each acquisition.

        None where the common part is not stated.
        """
        return None if self.common_covariance is None else self.covariance - self.common_covariance

    @property
    def adjoint(self) -> NDArray[np.float64]:
        """``(6, 6)``: takes an error in the pose error frame to the same error at the centre of projection.

        The result is in the camera frame. It is the adjoint of ``T_camera_frame`` with rotation R and origin o,
        [[R, [o]x R], [0, R]] for translation-first vectors (Lynch and Park, *Modern Robotics*, sec. 3.3.2).
        """
        assert self.T_camera_frame is not None  # set in __post_init__
        R = self.T_camera_frame[:3, :3]
        adjoint = np.zeros((6, 6))
        adjoint[:3, :3] = adjoint[3:, 3:] = R
        adjoint[:3, 3:] = skew(self.T_camera_frame[:3, 3]) @ R
        return adjoint

    @property
    def camera_covariance(self) -> NDArray[np.float64]:
        """``(6, 6)``, camera frame: covariance of the same error at the centre of projection, ``A Sigma A^T``."""
        return np.asarray(self.adjoint @ self.covariance @ self.adjoint.T)

    @property
    def factor(self) -> NDArray[np.float64]:
        """``(6, 6)`` F with ``F F^T`` the covariance: F z is a drawn error, pose error frame, for six unit normals z.

        Rows 0 to 2 are mm and rows 3 to 5 rad per unit normal.
        """
        return covariance_factor(self.covariance)


def covariance_factor(covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(6, 6)`` F with ``F F^T`` a covariance ``(6, 6)``; eigenvalues that rounding makes negative count as zero."""
    # the correlation matrix is factored, not the covariance: mm would drown rad in rounding errors
    deviations = np.sqrt(np.maximum(covariance.diagonal(), 0.0))
    scale = np.where(deviations > _UNDERFLOWS, deviations, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(deviations[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))


def _require_part(common: NDArray[np.float64], covariance: NDArray[np.float64]) -> None:
    """Raise InputError unless ``covariance - common`` is a covariance, up to rounding of the whole."""
    deviations = np.sqrt(covariance.diagonal())
    # where the whole has no error the common part may have none: its own scale makes what there is stand out
    scale = np.where(deviations > _UNDERFLOWS, deviations, np.sqrt(common.diagonal()))
    scale = np.where(scale > _UNDERFLOWS, scale, 1.0)
    smallest = float(np.linalg.eigvalsh((covariance - common) / np.outer(scale, scale))[0])
    if smallest < -_RELATIVE_PSD_TOLERANCE * 6:
        raise InputError(
            "the common covariance is more than the covariance of which it is a part",
            key="common_covariance",
            got=f"smallest eigenvalue of the rest {smallest:.3g}, in units of the whole's variances",
            expected="covariance = common + rest (drawn anew in each acquisition), both without negative eigenvalue",
        )


def _require_covariance(covariance: ArrayLike, name: str = "covariance") -> NDArray[np.float64]:
    try:
        matrix = np.array(covariance, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"the {name} must be a 6x6 matrix of numbers") from error
    if matrix.shape != (6, 6) or not np.isfinite(matrix).all():
        raise InputError(f"the {name} must be a finite 6x6 matrix", got=f"shape {matrix.shape}")
    if (matrix.diagonal() < 0).any():
        raise InputError(f"the {name} has a negative variance", got=matrix.diagonal().tolist())
    # mm and rad differ by orders of magnitude: judge symmetry and eigenvalues on the correlation matrix
    scale = np.sqrt(matrix.diagonal())
    # an error without variance has no covariance either: what is more than rounding there must stand out
    nothing = max(_RELATIVE_PSD_TOLERANCE * scale.max(), _UNDERFLOWS)
    scale = np.where(scale > _UNDERFLOWS, scale, nothing)
    correlation = matrix / np.outer(scale, scale)
    if np.abs(correlation - correlation.T).max() > _RELATIVE_PSD_TOLERANCE:
        raise InputError(f"the {name} is not symmetric", expected="equal entries on both sides of the diagonal")
    smallest = float(np.linalg.eigvalsh(correlation)[0])
    if smallest < -_RELATIVE_PSD_TOLERANCE * 6:
        raise InputError(
            f"the {name} is not positive semidefinite",
            got=f"smallest eigenvalue of the correlation matrix {smallest:.3g}",
            expected="no negative eigenvalue",
            hint="check the units (mm, rad), the order (translation first) and the number of digits",
        )
    symmetric = np.asarray((matrix + matrix.T) / 2)
    symmetric.flags.writeable = False
    return symmetric
