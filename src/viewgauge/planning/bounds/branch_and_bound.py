"""An upper bound of a characteristic's probability over all camera poses: branch and bound over the ways a measurand
can lie.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import line_end_variance
from ...errors.joint.closed_form_array import central_probability_into
from ...evaluation import Setup
from ...sensors import Camera
from ...visibility import ObservationLimits
from .box_bounds import AXES, OUT, box_bounds
from .distance_grid import DistanceGrid

__all__ = ["Bound", "Budget", "acceptable_distances", "probability_bound", "widest_tangent"]

_LAW = 1e-10  # added to every upper bound: ten times the error of the closed form
_BATCH = 1 << 14
_NEAREST = 1e-6
"""Eyes nearer to an end than this part of the measurand's length are left out: no lens is there."""


@dataclass(frozen=True)
class Budget:
    """When a search ends.

    Parameters
    ----------
    boxes
        Boxes examined at most: about a million a second.
    tightness
        A bound this near to a probability that was found is near enough.
    """

    boxes: int = 4_000_000
    tightness: float = 0.002


DEFAULT_BUDGET = Budget()


@dataclass(frozen=True)
class Bound:
    """An upper bound of a probability over a region.

    Parameters
    ----------
    upper
        No pose has more. Valid whenever the search ended.
    found
        Highest probability met at a way to lie that no condition considered excludes; 0 where none was met.
    boxes
        Number of boxes examined.
    at
        The way to lie of ``found``: alpha, beta, phi, arc tangent of k, log of w (:mod:`box`); None where none.
    """

    upper: float
    found: float
    boxes: int
    at: tuple[float, ...] | None

    def proves_below(self, required: float) -> bool:
        """No pose reaches the required probability."""
        return self.upper < required


def probability_bound(
    length_mm: tuple[float, float],
    relative_tolerance: float,
    reachable: DistanceGrid,
    setup: Setup,
    *,
    target: float | None = None,
    budget: Budget = DEFAULT_BUDGET,
    rims: bool = False,
) -> Bound:
    """Upper bound of Pr{|error| <= T L} over all poses from which the ends have reachable distances.

    Of the conditions of observability those on the image, its length and the focus count; that a face is turned to the
    camera counts by ``reachable``; occlusion does not count. Leaving conditions out only raises the bound.

    Parameters
    ----------
    length_mm
        Between which two the measurand's length lies.
    relative_tolerance
        T; of measurands of several lengths the largest.
    target
        A search that has met a way to lie that reaches this probability ends, since no bound below it exists then; by
        default the required one.
    rims
        Whole rims may be fitted in place of two ends.
    """
    search = _Search(length_mm, relative_tolerance, reachable, setup, rims)
    target = setup.requirement.probability if target is None else target
    if not search.possible:
        return Bound(0.0, 0.0, 0, None)
    dropped = 0.0  # highest bound of what was put aside as near enough
    while len(search.boxes) and search.examined < budget.boxes:
        if search.found >= target:
            break
        near = search.upper <= search.found + min(budget.tightness, (target - search.found) / 2)
        dropped = max(dropped, float(search.upper[near].max(initial=0.0)))
        search.keep(~near)
        search.split(search.highest(_BATCH))
    upper = max(dropped, float(search.upper.max(initial=0.0)))
    return Bound(min(upper, 1.0), search.found, search.examined, search.at)


def acceptable_distances(
    length_mm: tuple[float, float],
    relative_tolerance: float,
    reachable: DistanceGrid,
    setup: Setup,
    *,
    budget: Budget = DEFAULT_BUDGET,
    rims: bool = False,
) -> DistanceGrid:
    """The pairs of reachable distances at which the required probability is not excluded."""
    search = _Search(length_mm, relative_tolerance, reachable, setup, rims)
    required = setup.requirement.probability
    accepted = DistanceGrid(reachable.shortest_mm, reachable.longest_mm, len(reachable.cells))
    while search.possible and len(search.boxes):
        rectangles = accepted.rectangles(search.distances)
        good = search.middle >= required
        accepted.mark_pairs(search.middle_distances[good])
        open_ = (search.upper >= required) & ~accepted.all_in(rectangles)
        if search.examined >= budget.boxes:
            accepted.mark_rectangles(rectangles[open_])
            break
        search.keep(open_)
        search.split(search.highest(_BATCH))
    accepted.restrict(reachable)
    return accepted


class _Search:
    """The boxes that are open, each with its bound, what its middle reaches, and the axis along which to split it."""

    def __init__(
        self,
        length_mm: tuple[float, float],
        relative_tolerance: float,
        reachable: DistanceGrid,
        setup: Setup,
        rims: bool,
    ) -> None:
        self._length, self._tolerance, self._reachable = length_mm, relative_tolerance, reachable
        camera, error, limits = setup.camera, setup.pose_error, setup.limits
        factor = (error.adjoint @ error.factor)[:AXES]
        self._R = np.ascontiguousarray(np.linalg.qr(factor.T, mode="r"))
        self._view = _view(camera, limits, rims)
        self.examined, self.found = 0, 0.0
        self.at: tuple[float, ...] | None = None
        self._empty()
        low, high = self._view[:2], self._view[2:4]
        self.possible = bool((low <= high).all()) and not reachable.empty and length_mm[0] > 0
        if self.possible:
            boxes = self._first_boxes()
            self.possible = len(boxes) > 0
            self._add(boxes, np.ones(len(boxes)))

    def _empty(self) -> None:
        self.boxes = np.zeros((0, AXES, 2))
        self.upper, self.middle = np.zeros(0), np.zeros(0)
        self.axis = np.zeros(0, np.int64)
        self.distances, self.middle_distances = np.zeros((0, 4)), np.zeros((0, 2))

    def _first_boxes(self) -> NDArray[np.float64]:
        near, far = self._reachable.range_mm()
        widest = self._view[11]
        # an end at distance r has a depth between r/sqrt(1 + widest²) and r
        near = max(near / math.hypot(1.0, widest), self._view[4], _NEAREST * self._length[0])
        far = min(far, self._view[5])
        if near > far:
            return np.zeros((0, AXES, 2))
        # D >= k²: a measurand that lies along the line of sight has too short an image
        shortest = self._view[8] / math.hypot(self._view[6], self._view[7])
        steepest = math.pi / 2 if shortest == 0 else math.atan(self._length[1] / near / shortest)
        tangents, quarters = (-widest, widest), (0.0, math.pi / 2, math.pi)
        return np.array(
            [
                (tangents, tangents, quarters[q : q + 2], slopes, (-math.log(far), -math.log(near)))
                for q in range(2)
                for slopes in ((-steepest, 0.0), (0.0, steepest))
            ]
        )

    def _add(self, boxes: NDArray[np.float64], parents: NDArray[np.float64]) -> None:
        """Examine boxes whose parents had these bounds, and open those that are feasible."""
        values, axis = np.empty((len(boxes), OUT)), np.empty(len(boxes), np.int64)
        box_bounds(boxes, *self._length, self._R, self._view, values, axis)
        self.examined += len(boxes)
        feasible = axis >= 0
        feasible[feasible] = self._reachable.any_in(self._reachable.rectangles(values[feasible, 3:7]))
        boxes, values, axis, parents = boxes[feasible], values[feasible], axis[feasible], parents[feasible]
        upper = np.minimum(self._law(values[:, :3]) + _LAW, parents)
        pairs = np.ascontiguousarray(values[:, 11:13])
        inside = values[:, 7] > 0
        inside[inside] = self._reachable.any_in(self._reachable.rectangles(np.repeat(pairs[inside], 2, axis=1)))
        middle = np.zeros(len(boxes))
        middle[inside] = self._law(values[inside, 8:11])
        if len(boxes) and middle.max() > self.found:
            best = int(middle.argmax())
            self.found, self.at = float(middle[best]), tuple(boxes[best].mean(axis=1).tolist())
        self.boxes = np.concatenate([self.boxes, boxes])
        self.upper, self.middle = np.append(self.upper, upper), np.append(self.middle, middle)
        self.axis = np.append(self.axis, axis)
        self.distances = np.concatenate([self.distances, values[:, 3:7]])
        self.middle_distances = np.concatenate([self.middle_distances, pairs])

    def _law(self, errors: NDArray[np.float64]) -> NDArray[np.float64]:
        sigma, a, b = np.ascontiguousarray(errors.T)
        probability = np.full(len(sigma), self._tolerance)
        central_probability_into(probability, sigma, a, b, probability)
        return probability

    def keep(self, which: NDArray[np.bool_]) -> None:
        """Close the other boxes."""
        if which.all():
            return
        self.boxes, self.upper, self.middle, self.axis = (
            self.boxes[which],
            self.upper[which],
            self.middle[which],
            self.axis[which],
        )
        self.distances, self.middle_distances = self.distances[which], self.middle_distances[which]

    def highest(self, count: int) -> NDArray[np.int64]:
        """At most so many of the open boxes: those of the highest bounds."""
        if len(self.upper) <= count:
            return np.arange(len(self.upper))
        return np.asarray(np.argpartition(-self.upper, count)[:count])

    def split(self, which: NDArray[np.int64]) -> None:
        """Replace boxes by their halves."""
        boxes, axis, upper = self.boxes[which], self.axis[which], self.upper[which]
        others = np.ones(len(self.boxes), dtype=bool)
        others[which] = False
        self.keep(others)
        rows = np.arange(len(boxes))
        middle = boxes[rows, axis].mean(axis=1)
        halves = np.concatenate([boxes, boxes])
        halves[rows, axis, 1] = middle
        halves[len(boxes) + rows, axis, 0] = middle
        self._add(halves, np.append(upper, upper))


def widest_tangent(camera: Camera, limits: ObservationLimits) -> float:
    """Tangent of the largest angle from the optical axis at which an end of a measurand may be seen."""
    return float(_view(camera, limits, False)[11])


def _view(camera: Camera, limits: ObservationLimits, rims: bool) -> NDArray[np.float64]:
    """What :func:`box_bounds` knows of the camera; the same limits as :class:`~viewgauge.visibility.Culling`'s.

    A lens widens the image to a rectangle around all that it shows, and the camera's errors count by the least that
    they are anywhere in it; those of the calibration, which may vanish, not at all.
    """
    focal, low = camera.principal_distance_mm, limits.margin_px - 0.5
    scale = focal / np.asarray(camera.pixel_pitch_mm)
    centre, high = np.asarray(camera.principal_point), np.asarray(camera.resolution) - 0.5 - limits.margin_px
    corner = np.array([(low - centre) / scale, (high - centre) / scale])
    least, steps = 1.0, np.asarray(camera.quantization_step_mm) / focal
    if camera.lens is not None:
        border = camera.from_pixels(camera.border_px) / focal
        slack = _SLACK * np.ptp(border, axis=0)
        corner = np.array([border.min(axis=0) - slack, border.max(axis=0) + slack])
        least, steps = _least_by_lens(camera, steps)
    nearest, farthest = 0.0, math.inf
    if camera.f_number is not None and camera.focus_distance_mm is not None:
        focus = camera.focus_distance_mm
        blur = camera.blur_at_infinity_px
        # blur |Z - focus| <= limit Z
        nearest = blur * focus / (blur + camera.blur_limit_px) * (1 - 1e-9)
        if blur > camera.blur_limit_px:
            farthest = blur * focus / (blur - camera.blur_limit_px) * (1 + 1e-9)
    widest = float(np.hypot(*np.abs(corner).max(axis=0)))
    floor = least * float(camera.pitch_tangents.min()) * _least_location_px(camera, rims)
    return np.array(
        [*corner[0], *corner[1], nearest, farthest, *scale, limits.minimum_length_px, *steps, widest, floor]
    )


_SLACK = 0.01  # of the image: what the lens does between the points that are evaluated
_GRID = 65


def _least_by_lens(camera: Camera, steps: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    """By how much an error in the pixels counts at least in the ideal image, and the quantization steps for it.

    With ``E = D^-1`` the derivative of undistorting and n the image's direction, ``|n E|`` is at least the least
    singular value of E; and of the half-widths ``r_u |n E e_u|``, ``r_v |n E e_v|`` neither the larger nor the sum is
    less than ``1 - sqrt(2) |E - I| r_max/r_min`` times what it is without a lens.
    """
    columns, rows = camera.resolution
    u, v = np.meshgrid(np.linspace(-0.5, columns - 0.5, _GRID), np.linspace(-0.5, rows - 0.5, _GRID))
    assert camera.lens is not None
    image = camera.from_pixels(np.stack([u, v], axis=-1).reshape(-1, 2)) / camera.principal_distance_mm
    D = camera.lens.jacobian(image[np.isfinite(image).all(axis=-1)])  # the lens may not show the whole image
    E = np.linalg.inv(D)
    least = float(np.linalg.svd(E, compute_uv=False)[..., -1].min()) * (1 - _SLACK)
    off = float(np.linalg.svd(E - np.eye(2), compute_uv=False)[..., 0].max()) * (1 + _SLACK)
    if not steps.any():
        return least, steps
    return least, steps * max(1 - math.sqrt(2) * off * float(steps.max() / steps.min()), 0.0)


def _least_location_px(camera: Camera, rims: bool) -> float:
    """The least standard deviation, px, of the difference of two ends by a sub-pixel edge detector."""
    edge_detector = camera.edge_detector
    if edge_detector is None:
        return 0.0
    own = 2 * edge_detector.noise_px**2
    if edge_detector.edge_points is not None:
        own *= line_end_variance(edge_detector.edge_points, edge_detector.clear_of_corner_px)
        if rims:  # a rim is not longer than pi times the diagonal of the image, nor its fit better than 6/n
            own = min(own, 6 * edge_detector.noise_px**2 / (math.pi * math.hypot(*camera.resolution)))
    return math.sqrt(own + (2 * edge_detector.bias_px) ** 2)
