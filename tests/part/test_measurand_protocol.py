"""Every registered measurand: value and gradient against hand values and differences, and how a kind is added."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from strategies import point_pairs, quaternions
from viewgauge.exceptions import InputError
from viewgauge.part import Characteristic, Diameter, LengthBetweenPoints, Measurand, rim_axes
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.part.measurands import kinds, measurand_kinds, register_measurand

UP, EAST = np.array([[0.0, 0, 1]]), np.array([[1.0, 0, 0], [0, 0, 1]])
MEMBERS = sorted(measurand_kinds())


def made(kind, points=((0.0, 0, 0), (3.0, 4, 0))):
    return measurand_kinds()[kind].of(points, (UP, EAST), "edges 3 and 7")


def distance(points):
    """Square root of the sum of squares, in 50 digits."""
    return mp.sqrt(sum((mp.mpf(float(b)) - mp.mpf(float(a))) ** 2 for a, b in zip(*points, strict=True)))


def test_lengths_and_diameters_are_registered():
    assert measurand_kinds() == {"length": LengthBetweenPoints, "diameter": Diameter}


@pytest.mark.parametrize("kind", MEMBERS)
def test_every_member_fulfils_the_protocol(kind):
    measurand = made(kind)
    assert isinstance(measurand, Measurand)
    assert (measurand.kind, measurand.unit, measurand.source) == (kind, "mm", "edges 3 and 7")
    np.testing.assert_array_equal(measurand.points, [[0, 0, 0], [3, 4, 0]])
    np.testing.assert_array_equal(measurand.points, [measurand.start, measurand.end])
    for given_normals, normals in zip(measurand.normals, (UP, EAST), strict=True):
        np.testing.assert_array_equal(given_normals, normals)
    assert measurand.normals[0] is measurand.start_normals
    assert measurand.normals[1] is measurand.end_normals
    assert measurand.length_mm == 5.0
    assert measurand.rim_axis is None


@pytest.mark.parametrize("kind", MEMBERS)
def test_the_gradient_of_three_four_five(kind):
    measurand = made(kind)
    assert measurand.value(measurand.points) == 5.0
    np.testing.assert_allclose(
        measurand.gradient(measurand.points), [[-0.6, -0.8, 0], [0.6, 0.8, 0]], rtol=1e-15, atol=1e-300
    )


@settings(deadline=None)
@given(st.sampled_from(MEMBERS), point_pairs())
def test_value_and_gradient_equal_those_of_fifty_digits(kind, points):
    measurand = made(kind, points)
    with mp.workdps(50):
        value = distance(points)
        assert float(measurand.value(points)) == pytest.approx(float(value), rel=1e-15)
        gradient = measurand.gradient(points)
        for end, axis in np.ndindex(2, 3):
            step = mp.mpf(10) ** -25 * value  # central difference: good to 1e-50 relative, of 50 digits 25 are left
            moved = [[[mp.mpf(float(c)) for c in point] for point in points] for _ in range(2)]
            moved[0][end][axis] += step
            moved[1][end][axis] -= step
            ahead, behind = (mp.sqrt(sum((b - a) ** 2 for a, b in zip(*pair, strict=True))) for pair in moved)
            # the difference itself of two coordinates is rounded to 1e-16 of the larger in double precision
            rounding = 1e-15 * (1 + float(np.abs(points).max() / value))
            assert gradient[end, axis] == pytest.approx(float((ahead - behind) / (2 * step)), abs=rounding)


@given(st.sampled_from(MEMBERS), point_pairs(), quaternions(), st.tuples(*[st.floats(-1e3, 1e3)] * 3))
def test_a_rigid_motion_changes_no_value_and_turns_the_gradient(kind, points, quaternion, shift):
    measurand, R = made(kind, points), Rotation.from_quat(quaternion, scalar_first=True).as_matrix()
    moved = points @ R.T + shift
    size = np.abs(points).max() + np.abs(shift).max()
    apart = float(measurand.value(points))
    assert float(measurand.value(moved)) == pytest.approx(apart, abs=1e-14 * size)
    if apart > 1e-6 * size:
        np.testing.assert_allclose(measurand.gradient(moved), measurand.gradient(points) @ R.T, atol=1e-7)
    assert not measurand.gradient(points).sum(axis=0).any(), "a shift of both points is no change"


@pytest.mark.parametrize("kind", MEMBERS)
def test_many_pairs_at_once(kind):
    points = np.random.default_rng(5).normal(size=(4, 3, 2, 3))
    measurand = made(kind)
    values, gradients = measurand.value(points), measurand.gradient(points)
    assert values.shape == (4, 3)
    assert gradients.shape == points.shape
    for index in np.ndindex(4, 3):
        assert values[index] == measurand.value(points[index])
        np.testing.assert_array_equal(gradients[index], measurand.gradient(points[index]))


@pytest.mark.parametrize("kind", MEMBERS)
def test_points_that_coincide_have_the_value_zero_and_no_gradient(kind):
    same = np.array([[1.0, 2, 3], [1.0, 2, 3]])
    assert made(kind).value(same) == 0
    with pytest.raises(InputError, match="coincide has no gradient"):
        made(kind).gradient(np.stack([made(kind).points, same]))


@pytest.mark.parametrize("kind", MEMBERS)
@pytest.mark.parametrize("points", [np.zeros((3, 3)), np.zeros((2, 2)), np.zeros(3), 1.0])
def test_other_than_two_points_are_refused(kind, points):
    for ask in (made(kind).value, made(kind).gradient, lambda p: made(kind, p)):
        with pytest.raises(InputError, match="pair of points"):
            ask(points)


def test_a_pair_is_one_pair_with_normals_at_both_points():
    with pytest.raises(InputError, match="pair of points"):
        LengthBetweenPoints.of(np.zeros((4, 2, 3)), (UP, UP))
    with pytest.raises(InputError, match="normals"):
        LengthBetweenPoints.of(np.eye(3)[:2], (UP,))


# --- the axis of a rim ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("axis", [[0, 0, 2.0], [0, 0, 0.0], [0, math.nan, 1], [0, 1.0]])
def test_an_axis_that_is_no_unit_vector_is_refused(axis):
    with pytest.raises(InputError, match="unit vector"):
        replace(made("diameter"), rim_axis=np.array(axis))


@given(quaternions(), quaternions())
def test_axes_are_turned_into_each_camera_and_zero_where_there_is_none(first, second):
    T = np.tile(np.eye(4), (3, 1, 1))
    T[0, :3, :3], T[1, :3, :3] = Rotation.from_quat([first, second], scalar_first=True).as_matrix()
    rim = replace(made("diameter"), rim_axis=np.array([0.0, 0.6, 0.8]))
    axes = rim_axes([rim, rim, made("length")], T)
    np.testing.assert_allclose(axes[0], T[0, :3, :3].T @ [0, 0.6, 0.8], atol=1e-15)
    np.testing.assert_allclose(axes[1], T[1, :3, :3].T @ [0, 0.6, 0.8], atol=1e-15)
    assert not axes[2].any()
    assert not rim_axes([None], T[:1]).any()
    assert rim_axes([], T[:0]).shape == (0, 3)


# --- a characteristic and the table --------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", MEMBERS)
def test_a_characteristic_has_the_unit_of_its_measurands(kind):
    assert Characteristic("d", "distance", 5.0, None, (made(kind),)).unit == "mm"


def test_the_table_stacks_members_of_both_kinds():
    rim = replace(made("diameter"), rim_axis=np.array([0.0, 0, 1]))
    length = made("length", [[1.0, 1, 1], [1, 1, 9]])
    table = MeasurandTable.of(
        [
            Characteristic("hole", "diameter", 5.0, None, (rim, made("diameter"))),
            Characteristic("edge", "length", 8.0, None, (length,), "whole"),
        ]
    )
    np.testing.assert_array_equal(table.points, [rim.points, rim.points, length.points])
    np.testing.assert_array_equal(table.normals[:, 0], [[*UP, [0, 0, 0]]] * 3)
    np.testing.assert_array_equal(table.normals[:, 1], [EAST] * 3)
    np.testing.assert_array_equal(table.rim_axis, [[0, 0, 1], [0, 0, 0], [0, 0, 0]])
    np.testing.assert_array_equal(table.characteristic, [0, 0, 1])
    np.testing.assert_array_equal(table.first, [0, 2])
    np.testing.assert_array_equal(table.whole, [False, False, True])
    np.testing.assert_array_equal(table.length_mm, [5, 5, 8])


# --- a kind from outside -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class AngleBetweenEdges:
    """The angle between the edges through points 1, 2 and 3, 4."""

    points: np.ndarray
    normals: tuple
    source: str = ""

    kind: ClassVar[str] = "angle"
    unit: ClassVar[str] = "rad"

    @classmethod
    def of(cls, points, normals, source=""):
        return cls(np.asarray(points, dtype=float), tuple(normals), source)

    def value(self, points):
        p = np.asarray(points, dtype=float)
        a, b = p[..., 1, :] - p[..., 0, :], p[..., 3, :] - p[..., 2, :]
        return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1))

    def gradient(self, points):
        step = 1e-6 * np.eye(12).reshape(12, 4, 3)
        return ((self.value(points + step) - self.value(points - step)) / 2e-6).reshape(4, 3)


@pytest.fixture
def registry(monkeypatch):
    monkeypatch.setattr(kinds, "_KINDS", dict(kinds._KINDS))


@pytest.mark.usefixtures("registry")
def test_an_angle_is_one_class_and_its_registration():
    register_measurand(AngleBetweenEdges)
    register_measurand(AngleBetweenEdges)  # a module that is loaded twice is no other kind
    square = np.array([[0.0, 0, 0], [10, 0, 0], [0, 0, 0], [0, 10, 0]])
    angle = measurand_kinds()["angle"].of(square, (UP,) * 4)
    assert isinstance(angle, Measurand)
    assert angle.value(square) == pytest.approx(math.pi / 2)
    assert angle.gradient(square)[1] == pytest.approx([0, -0.1, 0], abs=1e-8)
    assert Characteristic("a", "angle", math.pi / 2, None, (angle,)).unit == "rad"
    with pytest.raises(InputError, match="pairs of points"):
        MeasurandTable.of([Characteristic("a", "angle", math.pi / 2, None, (angle,))])


@pytest.mark.usefixtures("registry")
def test_a_kind_has_one_class():
    class Other(LengthBetweenPoints):
        pass

    with pytest.raises(InputError, match="registered already"):
        register_measurand(Other)
    assert measurand_kinds()["length"] is LengthBetweenPoints
