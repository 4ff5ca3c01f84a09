"""What limits a dimension that no candidate measures as required."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ..visibility import REASONS

__all__ = ["limiting_cause"]

_WORDS = {
    "behind_camera": "behind the camera",
    "out_of_view": "outside the image",
    "facing_away": "on faces turned away",
    "too_short": "too short in the image",
    "out_of_focus": "out of focus",
    "occluded": "hidden by the part",
}


def limiting_cause(column: xr.Dataset) -> str:
    """One sentence on a dimension's column of the table: why it is not seen, or which error limits it.

    Parameters
    ----------
    column
        The table of :func:`~viewgauge.evaluation.evaluate_settings` at one dimension.
    """
    if not column["visible"].any():
        reasons = column["reason"].values
        counts = {name: int((reasons == name).sum()) for name in REASONS[:-1]}
        ordered = sorted((name for name in counts if counts[name]), key=lambda name: -counts[name])
        shares = ", ".join(f"{_WORDS[name]} ({counts[name] / len(reasons):.0%})" for name in ordered[:3])
        return f"not visible from any of {len(reasons)} candidates: {shares}"
    seen = np.where(column["visible"].values, column["probability"].values, -1.0)
    best = column.isel(setting=int(np.argmax(seen)))
    pose, pixels = float(best["sigma_displacement_px"]) ** 2, float(best["sigma_quantization_px"]) ** 2
    share = pose / (pose + pixels) if pose + pixels > 0 else 0.0
    source = f"pose error ({share:.0%} of the variance)" if share > 0.5 else f"pixels ({1 - share:.0%} of the variance)"
    length = float(best["image_length_px"])
    return f"visible, but limited by {source}: standard deviation {np.sqrt(pose + pixels):.3g} px of {length:.4g} px"
