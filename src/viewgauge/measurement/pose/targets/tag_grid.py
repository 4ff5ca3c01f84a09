"""A grid of square markers: AprilTags or ArUco markers, each by its number."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....exceptions import InputError
from ..board import marker_dictionary, opencv

__all__ = ["TagGrid"]


@dataclass(frozen=True)
class TagGrid:
    """Markers in rows, numbered from the top left as OpenCV's grid board has them.

    Parameters
    ----------
    columns, rows
        Markers.
    tag_mm, gap_mm
        Side of a marker, and the distance between two.
    dictionary
        By OpenCV's name, such as ``DICT_APRILTAG_36h11``, or number.
    """

    columns: int
    rows: int
    tag_mm: float
    gap_mm: float
    dictionary: str | int = "DICT_APRILTAG_36h11"

    symmetries = ()

    @property
    def pitch_mm(self) -> float:
        """Of the markers."""
        return self.tag_mm + self.gap_mm

    @cached_property
    def points_mm(self) -> NDArray[np.float64]:
        """``(4 k, 3)``: the four corners of each marker."""
        return np.concatenate([np.asarray(corners, dtype=float) for corners in self._made.getObjPoints()])

    @cached_property
    def _made(self) -> Any:
        cv2 = opencv()
        try:
            markers = marker_dictionary(self.dictionary)
            return cv2.aruco.GridBoard((self.columns, self.rows), self.tag_mm, self.gap_mm, markers)
        except (cv2.error, TypeError, SystemError) as error:
            got = f"{self.columns} x {self.rows}, {self.tag_mm} and {self.gap_mm} mm, {self.dictionary}"
            expected = "a dictionary such as DICT_APRILTAG_36h11 with enough markers"
            raise InputError("not a grid of markers", key="target_finder", got=got, expected=expected) from error

    def find(self, grey: Any) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Ids and places px of the corners of the markers that are seen."""
        cv2 = opencv()
        settings = cv2.aruco.DetectorParameters()
        settings.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        corners, numbers, _ = cv2.aruco.ArucoDetector(self._made.getDictionary(), settings).detectMarkers(grey)
        known = {int(number): k for k, number in enumerate(np.ravel(self._made.getIds()))}
        ids, places = [], []
        for number, four in zip([] if numbers is None else numbers.ravel(), corners, strict=True):
            if int(number) in known:
                ids.append(4 * known[int(number)] + np.arange(4))
                places.append(four.reshape(4, 2))
        if not ids:
            return np.zeros(0, np.int64), np.zeros((0, 2))
        return np.concatenate(ids), np.concatenate(places).astype(float)
