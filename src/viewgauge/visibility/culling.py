"""All conditions of observability but occlusion, for a block of viewpoints at once."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from ..geometry import VIEWS
from ..geometry.lens import distorted
from ..part.measurand_table import MeasurandTable
from ..sensors import Camera
from ..sensors.usable_region import depth_in_region
from .limits import ObservationLimits

__all__ = ["OCCLUDED", "REASONS", "VISIBLE", "Culling"]

REASONS = ("behind_camera", "out_of_view", "facing_away", "too_short", "out_of_focus", "occluded", "")
"""Names of the observability conditions in the order in which they are tested; the last, empty, is visible."""

_BEHIND, _OUT_OF_VIEW, _FACING_AWAY, _TOO_SHORT, _OUT_OF_FOCUS, OCCLUDED, VISIBLE = range(len(REASONS))


_WIDER = 0.002  # of the image: its border may bulge between the points at which it is computed


class Culling:
    """Tests measurands against all conditions but occlusion, the costly one.

    The conditions, in this order: both ends in front of the camera; both inside the image less a margin; at each end at
    least one adjoining face turned to the camera; image long enough; both ends in focus.
    """

    def __init__(self, measurands: MeasurandTable, camera: Camera, limits: ObservationLimits) -> None:
        self._points = np.ascontiguousarray(measurands.points)
        self._normals = np.ascontiguousarray(measurands.normals)
        there = (measurands.normals != 0).any(axis=-1)  # what follows the last is padding
        self._normal_count = (there * np.arange(1, there.shape[-1] + 1)).max(axis=-1, initial=0)
        focal, low = camera.principal_distance_mm, limits.margin_px - 0.5
        scale = focal / np.asarray(camera.pixel_pitch_mm)
        centre, high = np.asarray(camera.principal_point), np.asarray(camera.resolution) - 0.5 - limits.margin_px
        corner = (low - centre) / scale, (high - centre) / scale
        self._lens = camera.lens
        if camera.lens is not None:  # a rectangle around what the lens shows, and the exact test for what is in it
            self._in_image = np.array([*corner[0], *corner[1], camera.field_tangent])
            border = camera.from_pixels(camera.border_px) / focal
            slack = _WIDER * np.ptp(border, axis=0)
            corner = border.min(axis=0) - slack, border.max(axis=0) + slack
        self._shown: tuple[NDArray[np.float64], ...] | None = None
        if camera.usable_region is not None:
            lens = np.zeros(13) if camera.lens is None else camera.lens.parameters
            place = np.array([*scale, *centre, limits.margin_px])
            self._shown = lens, place, camera.usable_region.parameters
        # as multiples of the tangents of the image directions: (px - principal point) / scale
        self._parameters = np.array(
            [
                *corner[0],
                *corner[1],
                *scale,
                np.sin(limits.grazing_angle_rad),
                limits.minimum_length_px,
                camera.blur_at_infinity_px,  # times distance from the plane in focus over depth
                camera.focus_distance_mm or 0.0,
                camera.blur_limit_px,
            ]
        )

    def reasons(self, views: NDArray[np.float64], count: int) -> NDArray[np.int8]:
        """``(g, 256)`` index into :data:`REASONS` of the first condition that fails, the last where none does.

        Parameters
        ----------
        views
            From :func:`~viewgauge.geometry.view_block`; the first ``count`` of them are tested.
        """
        reason = np.empty((len(self._points), VIEWS), np.int8)
        _reasons(views, count, self._points, self._normals, self._normal_count, self._parameters, reason)
        if self._lens is not None:
            _outside_lens(views, count, self._points, self._lens.parameters, self._in_image, reason)
        if self._shown is not None:
            _outside_region(views, count, self._points, *self._shown, reason)
        return reason


@numba.njit(
    "void(float64[::1], int64, float64[:,:,::1], float64[:,:,:,::1], int64[:,::1], float64[::1], int8[:,::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _reasons(views, count, points, normals, normal_count, parameters, reason):  # type: ignore[no-untyped-def]
    low_u, low_v, high_u, high_v, scale_u, scale_v, sine, shortest, blur, focus, blur_limit = (
        parameters[0],
        parameters[1],
        parameters[2],
        parameters[3],
        parameters[4],
        parameters[5],
        parameters[6],
        parameters[7],
        parameters[8],
        parameters[9],
        parameters[10],
    )
    facing = np.empty(2 * VIEWS)  # of start and end: the largest n . (eye - point) of its faces, less what is needed
    for g in range(len(points)):
        for end in range(2):
            x, y, z = points[g, end, 0], points[g, end, 1], points[g, end, 2]
            row = end * VIEWS
            for s in range(count):
                facing[row + s] = -1.0
            for k in range(normal_count[g, end]):
                nx, ny, nz = normals[g, end, k, 0], normals[g, end, k, 1], normals[g, end, k, 2]
                offset = nx * x + ny * y + nz * z
                for s in range(count):
                    height = (
                        nx * views[12 * VIEWS + s] + ny * views[13 * VIEWS + s] + nz * views[14 * VIEWS + s] - offset
                    )
                    facing[row + s] = max(facing[row + s], height)
        x1, y1, z1 = points[g, 0, 0], points[g, 0, 1], points[g, 0, 2]
        x2, y2, z2 = points[g, 1, 0], points[g, 1, 1], points[g, 1, 2]
        codes = reason[g]
        for s in range(count):
            r0, r1, r2 = views[s], views[VIEWS + s], views[2 * VIEWS + s]
            r3, r4, r5 = views[3 * VIEWS + s], views[4 * VIEWS + s], views[5 * VIEWS + s]
            r6, r7, r8 = views[6 * VIEWS + s], views[7 * VIEWS + s], views[8 * VIEWS + s]
            cx, cy, cz = views[9 * VIEWS + s], views[10 * VIEWS + s], views[11 * VIEWS + s]
            X1, X2 = r0 * x1 + r1 * y1 + r2 * z1 + cx, r0 * x2 + r1 * y2 + r2 * z2 + cx
            Y1, Y2 = r3 * x1 + r4 * y1 + r5 * z1 + cy, r3 * x2 + r4 * y2 + r5 * z2 + cy
            Z1, Z2 = r6 * x1 + r7 * y1 + r8 * z1 + cz, r6 * x2 + r7 * y2 + r8 * z2 + cz
            u1, v1, u2, v2 = X1 / Z1, Y1 / Z1, X2 / Z2, Y2 / Z2
            du, dv = scale_u * (u2 - u1), scale_v * (v2 - v1)
            distance1 = math.sqrt(X1 * X1 + Y1 * Y1 + Z1 * Z1)
            distance2 = math.sqrt(X2 * X2 + Y2 * Y2 + Z2 * Z2)
            inside = (min(u1, u2) >= low_u) & (max(u1, u2) <= high_u)
            inside &= (min(v1, v2) >= low_v) & (max(v1, v2) <= high_v)
            faces = (facing[s] > sine * distance1) & (facing[VIEWS + s] > sine * distance2)
            sharp = (blur * abs(Z1 - focus) <= blur_limit * Z1) & (blur * abs(Z2 - focus) <= blur_limit * Z2)
            code = VISIBLE if sharp else _OUT_OF_FOCUS
            code = code if du * du + dv * dv >= shortest * shortest else _TOO_SHORT
            code = code if faces else _FACING_AWAY
            code = code if inside else _OUT_OF_VIEW
            codes[s] = code if (Z1 > 0.0) & (Z2 > 0.0) else _BEHIND


@numba.njit(inline="always", error_model="numpy")
def _in_camera(views, s, point):  # type: ignore[no-untyped-def]
    """Camera coordinates of a point ``(3,)`` mm, part frame, seen from viewpoint s of a block."""
    x, y, z = point[0], point[1], point[2]
    X = views[s] * x + views[VIEWS + s] * y + views[2 * VIEWS + s] * z + views[9 * VIEWS + s]
    Y = views[3 * VIEWS + s] * x + views[4 * VIEWS + s] * y + views[5 * VIEWS + s] * z + views[10 * VIEWS + s]
    Z = views[6 * VIEWS + s] * x + views[7 * VIEWS + s] * y + views[8 * VIEWS + s] * z + views[11 * VIEWS + s]
    return X, Y, Z


@numba.njit(
    "void(float64[::1], int64, float64[:,:,::1], float64[::1], float64[::1], int8[:,::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _outside_lens(views, count, points, lens, inside, reason):  # type: ignore[no-untyped-def]
    """Mark as out of view what is in front of the camera and in the rectangle, but shown outside the image."""
    for g in range(len(points)):
        for s in range(count):
            if reason[g, s] == _BEHIND or reason[g, s] == _OUT_OF_VIEW:
                continue
            for end in range(2):
                X, Y, Z = _in_camera(views, s, points[g, end])
                u, v, a, b, c, d = distorted(lens, X / Z, Y / Z)
                folded = not (a * d - b * c > 0.0 and a + d > 0.0)
                folded = folded or inside[4] * inside[4] * Z * Z < X * X + Y * Y
                if folded or not (inside[0] <= u <= inside[2] and inside[1] <= v <= inside[3]):
                    reason[g, s] = _OUT_OF_VIEW


@numba.njit(
    "void(float64[::1], int64, float64[:,:,::1], float64[::1], float64[::1], float64[::1], int8[:,::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _outside_region(views, count, points, lens, place, region, reason):  # type: ignore[no-untyped-def]
    """Mark as out of view what is in front of the camera and in the image, but outside the usable region."""
    for g in range(len(points)):
        for s in range(count):
            if reason[g, s] == _BEHIND or reason[g, s] == _OUT_OF_VIEW:
                continue
            for end in range(2):
                X, Y, Z = _in_camera(views, s, points[g, end])
                u, v, _, _, _, _ = distorted(lens, X / Z, Y / Z)
                if depth_in_region(region, place[2] + place[0] * u, place[3] + place[1] * v) < place[4]:
                    reason[g, s] = _OUT_OF_VIEW
