"""The edge detector, which finds edge points in an image, with its noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..exceptions import InputError

__all__ = ["EdgeDetector"]


@dataclass(frozen=True)
class EdgeDetector:
    """A sub-pixel edge detector, in place of the paper's whole-pixel one.

    Parameters
    ----------
    noise_px
        Standard deviation of one edge point, across the edge, px
        (:func:`~viewgauge.errors.edge_point_deviation` from signal to noise and blur).
    bias_px
        Standard uncertainty of an offset, px, by which all edges of a bright part lie further out or further in than
        they seem (exposure, blooming, focus). It is the same at both ends and in every image.
    edge_points
        Number of edge points, one px apart, that are fitted by a line at each end of a measurand; the whole rim of a
        hole or boss is fitted by an ellipse. None where single edge points are picked.
    clear_of_corner_px
        Distance between the end of a measurand and the first point that is fitted, px.
    """

    noise_px: float
    bias_px: float = 0.0
    edge_points: int | None = None
    clear_of_corner_px: float = 0.0

    def __post_init__(self) -> None:
        for name in ("noise_px", "bias_px", "clear_of_corner_px"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise InputError("must be finite and not negative", key=name, got=value)
        if self.edge_points is not None and self.edge_points < 2:
            raise InputError("must be at least 2, for a line", key="edge_points", got=self.edge_points)
