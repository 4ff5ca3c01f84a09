"""Calibration targets in images that are drawn here: each point lies where a pinhole camera sees it.

A target that looks the same when it is turned may be found turned; then its symmetries say so.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from viewgauge.measurement.pose.targets.chessboard import Chessboard
from viewgauge.measurement.pose.targets.circle_grid import CircleGrid
from viewgauge.measurement.pose.targets.tag_grid import TagGrid

cv2 = pytest.importorskip("cv2", reason="OpenCV is not installed")

K = np.array([[900.0, 0, 399.5], [0, 900.0, 299.5], [0, 0, 1]])
MARGIN_MM, PX_PER_MM = 30.0, 8.0
VIEWS = [(0.0, 0.0, 0.0), (0.35, -0.2, 0.4), (-0.3, 0.4, -2.4)]


def canvas(points):
    """A white plane around the points, and the pixel of a point of it (0 is the centre of the first pixel)."""
    low, high = points[:, :2].min(axis=0) - MARGIN_MM, points[:, :2].max(axis=0) + MARGIN_MM
    columns, rows = np.ceil((high - low) * PX_PER_MM).astype(int)
    return np.full((rows, columns), 255, np.uint8), lambda xy: (np.asarray(xy) - low) * PX_PER_MM - 0.5, low


def drawn_chessboard(board):
    image, pixel, low = canvas(board.points_mm)
    (x0, y0), side = board.points_mm[:, :2].min(axis=0) - board.square_mm, board.square_mm
    for row in range(board.rows):
        for column in range(board.columns):
            if (row + column) % 2 == 0:
                corner = np.rint(pixel((x0 + column * side, y0 + row * side)) + 0.5).astype(int)
                end = np.rint(pixel((x0 + (column + 1) * side, y0 + (row + 1) * side)) + 0.5).astype(int)
                image[max(corner[1], 0) : end[1], max(corner[0], 0) : end[0]] = 0
    return image, low


def drawn_dots(grid):
    image, pixel, low = canvas(grid.points_mm)
    for k, point in enumerate(grid.points_mm[:, :2]):
        radius = 0.25 * grid.pitch_mm * (1.5 if grid.pattern == "marked" and k == 0 else 1.0)
        u, v = pixel(point)
        y, x = np.ogrid[: image.shape[0], : image.shape[1]]
        image[(x - u) ** 2 + (y - v) ** 2 <= (radius * PX_PER_MM) ** 2] = 0
    return image, low


def drawn_tags(grid):
    image, pixel, low = canvas(grid.points_mm)
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    side = round(grid.tag_mm * PX_PER_MM)
    for number in range(grid.columns * grid.rows):
        u, v = np.rint(pixel(grid.points_mm[4 * number, :2]) + 0.5).astype(int)
        image[v : v + side, u : u + side] = cv2.aruco.generateImageMarker(dictionary, number, side)
    return image, low


TARGETS = {
    "chessboard": (Chessboard(8, 6, 25.0), drawn_chessboard),
    "chessboard of odd sides": (Chessboard(9, 7, 20.0), drawn_chessboard),
    "symmetric dots": (CircleGrid(7, 5, 20.0), drawn_dots),
    "square of dots": (CircleGrid(5, 5, 20.0), drawn_dots),
    "asymmetric dots": (CircleGrid(4, 9, 14.0, "asymmetric"), drawn_dots),
    "marked dots": (CircleGrid(7, 5, 20.0, "marked"), drawn_dots),
    "tags": (TagGrid(4, 3, 30.0, 10.0), drawn_tags),
}


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("name", TARGETS)
def test_every_point_is_found_where_it_is(name, view):
    target, draw = TARGETS[name]
    image, low = draw(target)
    T = np.eye(4)
    T[:3, :3] = Rotation.from_rotvec(view).as_matrix()
    middle = target.points_mm.mean(axis=0)
    T[:3, 3] = np.array([0, 0, 420.0]) - T[:3, :3] @ middle
    to_mm = np.array(
        [[1 / PX_PER_MM, 0, low[0] + 0.5 / PX_PER_MM], [0, 1 / PX_PER_MM, low[1] + 0.5 / PX_PER_MM], [0, 0, 1]]
    )
    H = K @ np.stack([T[:3, 0], T[:3, 1], T[:3, 3]], axis=1) @ to_mm
    finer = np.diag([3.0, 3, 1]) @ np.array([[1, 0, 1 / 3], [0, 1, 1 / 3], [0, 0, 1]]) @ H
    wide = cv2.warpPerspective(image, finer, (2400, 1800), flags=cv2.INTER_AREA, borderValue=255)
    ids, places = target.find(cv2.resize(wide, (800, 600), interpolation=cv2.INTER_AREA))
    assert sorted(ids.tolist()) == list(range(len(target.points_mm)))
    seen = target.points_mm @ T[:3, :3].T + T[:3, 3]
    expected = (seen @ K.T)[:, :2] / seen[:, 2:]
    turns = target.symmetries or (np.arange(len(expected)),)
    errors = [np.linalg.norm(places - expected[turn[ids]], axis=1).max() for turn in turns]
    assert min(errors) < 0.5  # a dot's centroid is not the image of its centre: up to 0.3 px here


def test_nothing_is_found_where_nothing_is():
    blank = np.full((600, 800), 200, np.uint8)
    for target, _ in TARGETS.values():
        ids, places = target.find(blank)
        assert ids.shape == (0,)
        assert places.shape == (0, 2)
