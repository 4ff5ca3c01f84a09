"""The check of a covariance of a camera's intrinsics."""

from __future__ import annotations

import numpy as np

from ..exceptions import InputError

__all__ = ["require_covariance"]


def require_covariance(matrix: object, size: int) -> tuple[tuple[float, ...], ...]:
    """Nested tuples of a covariance, or InputError."""
    expected = f"{size} rows of {size} numbers: the covariance of fx, fy, cx, cy and the lens's coefficients"
    try:
        values = np.asarray(matrix, dtype=float)
    except (TypeError, ValueError):
        raise InputError("not a matrix", key="intrinsics_covariance", got=matrix, expected=expected) from None
    if values.shape != (size, size) or not np.isfinite(values).all():
        got = f"shape {values.shape}" if np.isfinite(values).all() else "numbers that are not finite"
        raise InputError("not a covariance", key="intrinsics_covariance", got=got, expected=expected)
    deviation = np.sqrt(np.maximum(values.diagonal(), 0.0))
    scale = np.where(deviation > 0, deviation, 1.0)
    correlation = values / np.outer(scale, scale)
    if (values.diagonal() < 0).any():
        got = values.diagonal().tolist()
        raise InputError("not a covariance: a negative variance", key="intrinsics_covariance", got=got)
    if np.abs(correlation - correlation.T).max() > 1e-6:
        expected = "equal entries on both sides of the diagonal"
        raise InputError("not a covariance: not symmetric", key="intrinsics_covariance", expected=expected)
    if float(np.linalg.eigvalsh((correlation + correlation.T) / 2)[0]) < -1e-6:
        raise InputError("not a covariance: some combination has a negative variance", key="intrinsics_covariance")
    return tuple(tuple(float(value) for value in row) for row in (values + values.T) / 2)
