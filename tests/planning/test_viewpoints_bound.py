"""A lower bound of the number of viewpoints over the whole region: never above a cover that exists."""

import numpy as np
import pytest
from bounded_regions import Shell, characteristic, measurand, probabilities, random_poses
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import SphericalVoronoi

from viewgauge.evaluation import Requirement, Setup
from viewgauge.geometry import PoseError
from viewgauge.planning import spread_directions
from viewgauge.planning.bounds import viewpoints_lower_bound
from viewgauge.planning.bounds.cells import AXES, AXES_APART_RAD
from viewgauge.planning.cover.minimum_cover import minimum_cover
from viewgauge.sensors import Camera
from viewgauge.visibility import ObservationLimits

CAMERA = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=0.1)
LIMITS = ObservationLimits()
POSE_ERROR = PoseError.from_standard_deviations(0.02, 1e-5)
EASY = Requirement("accuracy", 0.99, 0.95)
REGION = Shell(250.0, 450.0)


def on_face(name, normal, half=10.0):
    """A measurand across the middle of a face of a cube of 60 mm."""
    normal = np.asarray(normal, dtype=float)
    along = np.roll(normal, 1)
    return characteristic(name, measurand(30 * normal - half * along, 30 * normal + half * along, [normal]))


def bound(characteristics, region=REGION, camera=CAMERA, pose_error=POSE_ERROR, requirement=EASY, **options):
    return viewpoints_lower_bound(characteristics, Setup(camera, pose_error, requirement, LIMITS), region, **options)


def test_no_direction_is_farther_than_said_from_those_looked_into():
    directions = spread_directions(AXES)
    vertices = SphericalVoronoi(directions).vertices
    assert np.arccos((vertices @ directions.T).max(axis=1)).max() < AXES_APART_RAD


def test_opposite_faces_need_two_viewpoints_and_say_why():
    proof = bound([on_face("front", (0, 0, 1)), on_face("right", (1, 0, 0)), on_face("back", (0, 0, -1))])
    assert proof.count == 2
    assert proof.apart == ("front", "back")


def test_all_faces_of_a_cube_need_two_viewpoints():
    # three faces are seen from one corner, the other three from the opposite one
    faces = [on_face(str(n), n) for n in np.vstack([np.eye(3), -np.eye(3)])]
    assert bound(faces).count == 2


def test_neighbouring_faces_need_one_viewpoint():
    assert bound([on_face("front", (0, 0, 1)), on_face("right", (1, 0, 0))]).count == 1


def test_a_small_field_of_view_needs_a_viewpoint_for_each_end_of_a_long_part():
    # seen from no more than 500 mm of the middle, and not too flat, ends 1000 mm apart are more than 60 deg apart
    ends = [characteristic(str(x), measurand((x - 10, 0, 0), (x + 10, 0, 0), [[0, 0, 1]])) for x in (-500.0, 500.0)]
    assert bound(ends, Shell(250.0, 500.0, above=100.0)).count == 2


def test_distances_at_which_a_probability_is_excluded_part_viewpoints():
    # of 10 mm 0.3 % are 0.78 px, which whole pixels need, up to 179 mm; 300 mm fit the image's diagonal from 438 mm on
    coarse = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=1.0)
    small = characteristic("small", measurand((-5, 0, 0), (5, 0, 0), [[0, 0, 1]]))
    large = characteristic("large", measurand((-150, 0, 0), (150, 0, 0), [[0, 0, 1]]))

    class Above(Shell):
        def holds(self, points):
            return super().holds(points) & (np.hypot(points[:, 0], points[:, 1]) <= 0.2 * points[:, 2])

        def possible(self, low, high):
            nearest = np.hypot(*np.clip(0.0, low[:, :2], high[:, :2]).T)
            return super().possible(low, high) & (nearest <= 0.2 * high[:, 2])

    region, requirement = Above(150.0, 900.0, above=0.0), Requirement("accuracy", 0.997, 0.95)
    proof = bound([small, large], region, coarse, requirement=requirement)
    assert proof.count == 2
    assert proof.apart == ("small", "large")


def test_what_is_known_to_suffice_ends_the_search():
    faces = [on_face("front", (0, 0, 1)), on_face("back", (0, 0, -1))]
    assert bound(faces, attained=np.eye(2, dtype=bool), enough=2).count == 2
    assert bound(faces, enough=1).cells <= bound(faces).cells
    assert bound([on_face("front", (0, 0, 1))], attained=np.ones((1, 1), dtype=bool)).cells == 1


@pytest.mark.parametrize("characteristics", [[], [on_face("front", (0, 0, 1))]])
def test_nothing_to_measure_or_nowhere_to_stand_needs_no_viewpoint(characteristics):
    assert bound(characteristics, Shell(250.0, 450.0, above=500.0)).count == 0
    assert bound(characteristics, Shell(250.0, -450.0)).count == 0


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=6, deadline=None)
def test_the_bound_is_never_above_a_cover_that_exists(seed):
    rng = np.random.default_rng(seed)
    characteristics = []
    for name in range(rng.integers(2, 6)):
        normal, along = rng.normal(size=(2, 3))
        normal /= np.linalg.norm(normal)
        along -= along @ normal * normal
        along *= rng.uniform(4, 40) / np.linalg.norm(along)
        middle = 40 * normal + rng.normal(size=3) * 30
        characteristics.append(characteristic(str(name), measurand(middle - along, middle + along, [normal])))
    pose_error, requirement = PoseError.from_standard_deviations(0.15, 2e-4), Requirement("accuracy", 0.999, 0.9)
    poses = random_poses(rng, REGION, (0, 0, 0), 30.0, 3000)
    accepted = np.stack(
        [probabilities(poses, d, 1e-3 * d.nominal_mm, CAMERA, pose_error, LIMITS) >= 0.9 for d in characteristics],
        axis=1,
    )
    met = accepted.any(axis=0)
    if not met.any():
        return
    measured = [d for d, m in zip(characteristics, met, strict=True) if m]
    cover = minimum_cover(accepted[:, met])
    proof = bound(measured, REGION, CAMERA, pose_error, requirement, work=3_000_000)
    assert proof.count <= len(cover.chosen)
    together = accepted[:, met].T.astype(int) @ accepted[:, met]
    apart = [[d.id for d in measured].index(name) for name in proof.apart]
    assert all(not together[i, j] for i in apart for j in apart if i != j)
