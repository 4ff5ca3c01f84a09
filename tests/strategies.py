"""What property tests draw from: ordinary values, and the degenerate ones that break formulas."""

import math

import numpy as np
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation


def scales(smallest=1e-6, largest=1e6):
    """Not negative: standard deviations, pixel pitches; zero, tiny and huge ones included."""
    return st.one_of(
        st.sampled_from([0.0, 1e-300, 1e-12, 0.5, 1.0, 2.0, 1e12]),
        st.floats(math.log10(smallest), math.log10(largest)).map(lambda exponent: 10.0**exponent),
    )


def angles():
    """Directions in the image, rad: along the pixel axes, a hair off them, anywhere."""
    return st.one_of(
        st.sampled_from(
            [0.0, 1e-300, 1e-12, 1e-9, math.pi / 4, math.pi / 2 - 1e-9, math.pi / 2, math.pi, -math.pi / 2]
        ),
        st.floats(-10.0, 10.0),
    )


def positions():
    """Where an error is looked up, in standard deviations: the centre, kinks' neighbourhood, tails."""
    return st.one_of(st.sampled_from([0.0, -0.0, 1e-300, -1e-12, 8.99, -9.01, 40.0]), st.floats(-12.0, 12.0))


def probabilities():
    """Strictly between 0 and 1, far tails included."""
    return st.one_of(st.sampled_from([1e-12, 0.5, 0.95, 1 - 1e-12]), st.floats(1e-12, 1 - 1e-12))


def points_in_front():
    """Points in mm, camera frame: on the optical axis, at the border of the view, near, far."""
    offset = st.one_of(st.sampled_from([0.0, 1e-9]), st.floats(-0.5, 0.5))
    depth = st.one_of(st.sampled_from([1.0, 1e5]), st.floats(50.0, 2000.0))
    return st.tuples(offset, offset, depth).map(lambda p: np.array([p[0] * p[2], p[1] * p[2], p[2]]))


def quaternions():
    """Unit quaternions, scalar first: identity, half turns, scalar zero or negative, any."""
    special = [
        [1.0, 0, 0, 0],
        [-1.0, 0, 0, 0],
        [0, 1.0, 0, 0],
        [0, 0, 1.0, 0],
        [0, 0, 0, -1.0],
        [math.sqrt(0.5), math.sqrt(0.5), 0, 0],
        [0, math.sqrt(0.5), 0, -math.sqrt(0.5)],
    ]
    any_other = (
        st.tuples(*[st.floats(-1, 1)] * 4)
        .map(np.array)
        .filter(lambda q: np.linalg.norm(q) > 0.1)
        .map(lambda q: q / np.linalg.norm(q))
    )
    return st.one_of(st.sampled_from(special).map(np.array), any_other)


def rigid_poses():
    """4x4 poses, mm: the identity, pure shifts and any."""

    def pose(quaternion, position):
        T = np.eye(4)
        T[:3, :3] = Rotation.from_quat(np.roll(quaternion, -1)).as_matrix()
        T[:3, 3] = position
        return T

    return st.builds(pose, quaternions(), st.tuples(*[st.floats(-200, 200)] * 3))


def pose_covariances():
    """6x6 covariances in mm² and rad², translation first: none, one direction only, of low rank, full."""

    def covariance(factor, deviations):
        return (factor * np.array(deviations)[:, None]) @ (factor * np.array(deviations)[:, None]).T

    def factors(columns):
        return st.lists(st.floats(-1, 1), min_size=6 * columns, max_size=6 * columns).map(
            lambda entries: np.reshape(entries, (6, columns))
        )

    deviations = st.tuples(*[st.sampled_from([0.0, 0.01, 0.5])] * 3, *[st.sampled_from([0.0, 1e-5, 1e-3])] * 3)
    return st.one_of(
        st.just(np.zeros((6, 6))),
        st.integers(0, 5).map(lambda axis: np.diag(np.eye(6)[axis] * 1e-4)),
        st.builds(covariance, st.integers(1, 6).flatmap(factors), deviations),
    )


def point_pairs():
    """Two different points ``(2, 3)`` in mm: along an axis, askew, far from the origin, a hair apart, far apart."""
    coordinate = st.one_of(st.sampled_from([0.0, -0.0, 1.0, -1.0, 1e6]), st.floats(-1e3, 1e3))
    points = st.tuples(*[coordinate] * 3).map(np.array)
    directions = st.one_of(
        st.sampled_from([[1.0, 0, 0], [0, -1.0, 0], [0, 0, 1.0]]).map(np.array),
        st.tuples(*[st.floats(-1, 1)] * 3).map(np.array),
    )
    apart = st.one_of(st.sampled_from([1e-9, 1e-3, 1.0, 1e6]), st.floats(1e-3, 1e3))
    pairs = st.builds(lambda start, along, length: np.array([start, start + length * along]), points, directions, apart)
    return pairs.filter(lambda pair: (pair[0] != pair[1]).any())
