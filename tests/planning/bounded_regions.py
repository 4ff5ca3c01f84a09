"""Regions of eye positions and poses in them, for tests of bounds: written without the code that they test."""

import numpy as np

from viewgauge.evaluation import success_probability
from viewgauge.geometry import invert, look_at, transform, view_block
from viewgauge.part import Characteristic, LengthBetweenPoints
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.visibility import VISIBLE, Culling

EVERY_WAY = np.vstack([np.eye(3), -np.eye(3)])


class Shell:
    """Eyes between two distances from a centre, in a half space if one is given."""

    def __init__(self, near, far, centre=(0.0, 0.0, 0.0), above=-np.inf):
        self.near, self.far, self.centre, self.above = near, far, np.asarray(centre, dtype=float), above
        self.bounds = np.stack([self.centre - far, self.centre + far])

    def allows(self, T_part_camera):
        return self.holds(T_part_camera[:, :3, 3])

    def holds(self, points):
        r = np.linalg.norm(points - self.centre, axis=-1)
        return (r >= self.near) & (r <= self.far) & (points[:, 2] >= self.above)

    def possible(self, low, high):
        nearest = np.linalg.norm(np.clip(self.centre, low, high) - self.centre, axis=-1)
        farthest = np.linalg.norm(np.maximum(abs(low - self.centre), abs(high - self.centre)), axis=-1)
        return (farthest >= self.near) & (nearest <= self.far) & (high[:, 2] >= self.above)

    def sample(self, rng, count):
        direction = rng.normal(size=(count, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        eyes = self.centre + direction * rng.uniform(self.near, self.far, (count, 1))
        return eyes[self.holds(eyes)]


def measurand(start, end, normals=EVERY_WAY, end_normals=None):
    """Between two points; without normals seen from everywhere."""
    end_normals = normals if end_normals is None else end_normals
    return LengthBetweenPoints(*(np.array(v, dtype=float) for v in (start, end, normals, end_normals)))


def characteristic(name, *measurands):
    """Of the measurands' length."""
    return Characteristic(name, "length", measurands[0].length_mm, (-0.1, 0.1), measurands)


def probabilities(poses, measured, allowed_mm, camera, error, limits):
    """``(n,)``: the highest of the measurands of a characteristic that can be observed, occlusion apart; 0 where none
    can.
    """
    table = MeasurandTable.of([measured])
    culling = Culling(table, camera, limits)
    best = np.zeros(len(poses))
    for first in range(0, len(poses), 256):
        some = poses[first : first + 256]
        seen = culling.reasons(view_block(some), len(some))[:, : len(some)] == VISIBLE
        for g, ends in enumerate(table.points):
            points = transform(invert(some)[:, None], ends)
            tolerance = allowed_mm / table.length_mm[g]
            p = success_probability(points[:, 0], points[:, 1], camera, error, tolerance)
            best[first : first + 256] = np.maximum(best[first : first + 256], np.where(seen[g], p, 0.0))
    return best


def random_poses(rng, region, around_mm, spread_mm, count):
    """Poses with eyes in the region that are aimed near a point."""
    eyes = region.sample(rng, count)
    aims = np.asarray(around_mm) + rng.normal(size=eyes.shape) * spread_mm
    return look_at(eyes, aims, rng.uniform(-np.pi, np.pi, len(eyes)))
