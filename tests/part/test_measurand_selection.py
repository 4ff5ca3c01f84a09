"""How many measurands of a characteristic are kept, however many there could be."""

from __future__ import annotations

import numpy as np
import pytest
from breps import face, pmi_record, prism
from soundness import assert_sound, only_characteristic

from viewgauge.part import LengthBetweenPoints
from viewgauge.part.measurands.selection import LIMIT, Candidate, select

SIDES = np.concatenate([np.eye(3), -np.eye(3)])


def candidates(count, sides):
    """Measurands of 10 mm, one beside the other, on so many sides in turn."""
    for k in range(count):
        normal = SIDES[[k % sides]]
        start = np.array([0.0, 3.0 * k, 0.0])
        measurand = LengthBetweenPoints(start, start + np.array([10.0, 0.0, 0.0]), normal, normal)
        yield Candidate(
            measurand, common_face=True, concave=False, straight=True, at_corner=False, place=k, edge_length_mm=5.0
        )


@pytest.mark.parametrize("sides", [1, 2, 5])
@pytest.mark.parametrize("limit", [0, 1, 3, 12])
@pytest.mark.parametrize("count", [0, 1, 2, 12, 13, 40])
def test_as_many_as_there_are_and_no_more_than_the_limit(count, limit, sides):
    possible = list(candidates(count, sides))
    chosen = select(possible, limit)
    assert len(chosen) == min(count, limit)
    assert len({id(measurand) for measurand in chosen}) == len(chosen), "each once"
    assert {id(measurand) for measurand in chosen} <= {id(candidate.measurand) for candidate in possible}


def test_without_a_limit_given_there_are_twelve():
    assert LIMIT == 12
    assert len(select(list(candidates(40, 2)))) == 12


def test_a_face_with_more_pairs_of_edges_than_that_has_twelve_measurands():
    """The end of a comb with nine teeth: 17 pairs of neighbouring edges are 10 mm apart."""
    teeth = [(x + dx, y) for x in range(160, -1, -20) for dx, y in ((10, 20), (0, 20), (0, 10), (-10, 10))]
    solid = prism([(0, 0), (170, 0), *teeth[:-2]], 30.0)
    brep = solid.brep(pmi_record("length", 10.0, [face(0)]))
    characteristic = only_characteristic(brep)
    assert len(characteristic.measurands) == 12
    assert_sound(brep, characteristic, 10.0, (0,))
