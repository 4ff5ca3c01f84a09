"""A grid of dots: symmetric, asymmetric, or with one larger dot in a corner."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..board import opencv
from .grid_order import grid_points, ordered, turned_ids

__all__ = ["CircleGrid"]

_LARGER = 1.15  # the marked dot's diameter, times that of the other corners

Pattern = Literal["symmetric", "asymmetric", "marked"]


@dataclass(frozen=True)
class CircleGrid:
    """Dark dots on a bright ground.

    Parameters
    ----------
    columns, rows
        Dots; of the asymmetric grid as OpenCV counts them (dots of a row, rows).
    pitch_mm
        Distance of neighbours in a row; of the asymmetric grid half of it.
    pattern
        "symmetric"; "asymmetric": each other row moved by half of the distance; "marked": a larger dot in one corner.
    smallest_px, largest_px
        Areas of dots, px².
    """

    columns: int
    rows: int
    pitch_mm: float
    pattern: Pattern = "symmetric"
    smallest_px: float = 20.0
    largest_px: float = 20_000.0

    @cached_property
    def points_mm(self) -> NDArray[np.float64]:
        """``(k, 3)``: centres row by row."""
        if self.pattern != "asymmetric":
            return grid_points(self.columns, self.rows, self.pitch_mm)
        y, x = np.mgrid[: self.rows, : self.columns]
        across = (2 * x + y % 2) * self.pitch_mm
        return np.stack([across.ravel(), y.ravel() * self.pitch_mm, np.zeros(x.size)], axis=1)

    @cached_property
    def symmetries(self) -> tuple[NDArray[np.int64], ...]:
        """Turns that leave the pattern as it is."""
        turns = {"symmetric": (0, 1, 2, 3), "marked": (0,), "asymmetric": (0,) if self.rows % 2 else (0, 2)}
        return turned_ids(self.columns, self.rows, lambda k: k in turns[self.pattern])

    def find(self, grey: Any) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Ids and places px of the dots; none unless all are seen."""
        cv2 = opencv()
        detector = self._detector()
        kind = cv2.CALIB_CB_ASYMMETRIC_GRID if self.pattern == "asymmetric" else cv2.CALIB_CB_SYMMETRIC_GRID
        size = (self.columns, self.rows)
        for flags in (kind, kind | cv2.CALIB_CB_CLUSTERING):
            found, places = cv2.findCirclesGrid(grey, size, flags=flags, blobDetector=detector)
            if found:
                grid = places.reshape(self.rows, self.columns, 2).astype(float)
                chosen = grid if self.pattern == "asymmetric" else ordered(grid, self._starts_right(grey, detector))
                if chosen is not None:
                    return np.arange(self.rows * self.columns), chosen.reshape(-1, 2)
        return np.zeros(0, np.int64), np.zeros((0, 2))

    def _detector(self) -> Any:
        cv2 = opencv()
        settings = cv2.SimpleBlobDetector_Params()
        settings.minArea, settings.maxArea = self.smallest_px, self.largest_px
        settings.minDistBetweenBlobs = 3.0
        settings.filterByInertia = settings.filterByCircularity = False
        settings.minConvexity = 0.9
        return cv2.SimpleBlobDetector_create(settings)

    def _starts_right(self, grey: Any, detector: Any) -> Any:
        """Whether a grid begins with the larger dot, where the pattern has one."""
        if self.pattern == "symmetric":
            return lambda _: True
        blobs = detector.detect(grey)
        centres, sizes = np.array([blob.pt for blob in blobs]), np.array([blob.size for blob in blobs])

        def begins(grid: NDArray[np.float64]) -> bool:
            corners = grid[[0, 0, -1, -1], [0, -1, 0, -1]]
            nearest = [int(np.argmin(np.linalg.norm(centres - corner, axis=1))) for corner in corners]
            first, *others = sizes[nearest]
            return bool(first > _LARGER * max(others))

        return begins
