"""Triangles with and without gaps."""

import numpy as np
import pytest

from viewgauge.formats.mesh.watertight import is_watertight

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


@pytest.mark.parametrize("oriented", [False, True])
def test_closed_open_and_empty(oriented):
    assert is_watertight(TETRAHEDRON, oriented=oriented)
    assert not is_watertight(TETRAHEDRON[1:], oriented=oriented)
    assert not is_watertight(TETRAHEDRON[:0], oriented=oriented)
    assert not is_watertight(np.concatenate([TETRAHEDRON, TETRAHEDRON]), oriented=oriented)


def test_one_triangle_turned_matters_to_the_orientation_only():
    turned = TETRAHEDRON.copy()
    turned[0] = turned[0, ::-1]
    assert is_watertight(turned)
    assert not is_watertight(turned, oriented=True)
