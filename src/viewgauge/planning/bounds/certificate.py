"""What is proven of a characteristic that no candidate measures with the required probability."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...evaluation import Setup
from ...geometry import PoseError
from ...part import Characteristic
from ...part.measurand_table import MeasurandTable
from ..region import Region
from .branch_and_bound import DEFAULT_BUDGET, Bound, Budget, probability_bound
from .distance_grid import DistanceGrid
from .eye_region import reachable_distances
from .measurand_groups import MeasurandGroup, measurand_groups

__all__ = ["Certificate", "certify"]

_PLACES = 4  # of a probability in words


@dataclass(frozen=True)
class Certificate:
    """An upper bound of a characteristic's probability over all camera poses of a region.

    Parameters
    ----------
    characteristic_id
        The characteristic.
    upper_bound
        No pose whose centre of projection is in the region measures the characteristic with a higher probability.
    proven
        The bound is below the required probability: no pose meets the characteristic.
    cause
        One sentence: which error alone prevents it, or what of it remains possible.
    """

    characteristic_id: str
    upper_bound: float
    proven: bool
    cause: str

    @property
    def upper_words(self) -> str:
        """The bound to four digits, rounded up: it stays one."""
        return _up(self.upper_bound)


def certify(
    characteristic: Characteristic,
    setup: Setup,
    region: Region,
    *,
    budget: Budget = DEFAULT_BUDGET,
) -> Certificate:
    """Bound the probability of a characteristic over a region, all ways to turn the camera at each position included.

    The probability is that of the joint model; occlusion is left out, which only raises the bound.

    Parameters
    ----------
    characteristic
        With at least one measurand and an allowed error under the requirement.
    budget
        Of each of the searches: three for each length of a measurand.
    """
    measurands = MeasurandTable.of([characteristic])
    allowed, required = setup.allowed_error_mm(characteristic), setup.requirement.probability
    reach = []
    for group in measurand_groups(measurands.length_mm, np.full(len(measurands), allowed)):
        distances = reachable_distances(measurands.points[group[0]], measurands.normals[group[0]], region, setup.limits)
        if not distances.empty:
            reach.append((group, distances, bool(measurands.rim_axis[group[0]].any())))
    if not reach:
        cause = "from no allowed camera position are faces at both ends of a measurand turned to the camera"
        return Certificate(characteristic.id, 0.0, True, cause)
    bound = _over_all(reach, setup, budget)
    if bound.upper == 0:
        cause = "in no allowed pose are both ends of a measurand in the image, in focus and far enough apart"
        return Certificate(characteristic.id, 0.0, True, cause)
    if bound.proves_below(required):
        pose = _over_all(reach, replace(setup, camera=setup.camera.without_errors), budget)
        pixels = _over_all(reach, replace(setup, pose_error=PoseError(np.zeros((6, 6)))), budget)
        return Certificate(characteristic.id, bound.upper, True, _cause(pose, pixels, required))
    return Certificate(characteristic.id, bound.upper, False, _remains(bound, required))


def _over_all(
    reach: Sequence[tuple[MeasurandGroup, DistanceGrid, bool]],
    setup: Setup,
    budget: Budget,
) -> Bound:
    """The highest bound of several groups of measurands."""
    bounds = [
        probability_bound(length, tolerance, distances, setup, budget=budget, rims=rims)
        for (_, length, tolerance), distances, rims in reach
    ]
    best = max(bounds, key=lambda bound: bound.found)
    return Bound(max(b.upper for b in bounds), best.found, sum(b.boxes for b in bounds), best.at)


def _cause(pose: Bound, pixels: Bound, required: float) -> str:
    """Which error alone keeps the characteristic below the required probability, wherever the camera is."""
    by_pose, by_pixels = pose.proves_below(required), pixels.proves_below(required)
    at_most_pose = f"even with an ideal edge detector at most {_up(pose.upper)}"
    at_most_pixels = f"even without pose error at most {_up(pixels.upper)}"
    if by_pose and by_pixels:
        return f"pose error and pixels each prevent it alone: {at_most_pose}, {at_most_pixels}"
    if by_pose:
        return f"the pose error alone prevents it: {at_most_pose}"
    if by_pixels:
        return f"the pixels alone prevent it: {at_most_pixels}"
    return "pose error and pixels prevent it together; neither alone is known to"


def _remains(bound: Bound, required: float) -> str:
    if bound.found >= required:
        return (
            f"not excluded: occlusion apart, {_down(bound.found)} may be possible at a pose between the candidates; "
            "more candidates may find it"
        )
    return f"not decided: at most {_up(bound.upper)} anywhere, where {required:g} is required"


def _up(probability: float) -> str:
    """Rounded up: a bound stays one."""
    scale = 10**_PLACES
    return f"{min(math.ceil(probability * scale) / scale, 1.0):.{_PLACES}f}"


def _down(probability: float) -> str:
    scale = 10**_PLACES
    return f"{math.floor(probability * scale) / scale:.{_PLACES}f}"
