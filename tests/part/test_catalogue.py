"""Features with ids, characteristics stated on them, and proposals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from breps import drilled_plate, prism, slotted_block

from viewgauge.exceptions import InputError
from viewgauge.part import Face
from viewgauge.part.catalogue import catalogue_of, outcome_on_features, propose
from viewgauge.part.characteristics.outcome import Derived, NotDerived


def ids(catalogue, kind):
    return [feature.id for feature in catalogue.of_kind(kind)]


@pytest.fixture(scope="module")
def block():
    """60 x 40 x 30 mm with a slot 20 wide from x = 15 to 35 and a step at x = 50, z = 20."""
    return catalogue_of(slotted_block().brep())


@pytest.fixture(scope="module")
def plate():
    solid, _ = drilled_plate([(20.0, 20.0), (60.0, 20.0)])
    return catalogue_of(solid.brep())


def plane_at(catalogue, axis, value):
    return next(
        plane.id
        for plane in catalogue.of_kind("plane")
        if abs(plane.direction[axis]) > 0.99 and abs(plane.position[axis] - value) < 1e-6
    )


def test_features_of_a_block(block):
    assert len(block.of_kind("plane")) == 12
    assert ids(block, "plane")[:2] == ["F1", "F2"]
    left = block.feature("F1")
    np.testing.assert_allclose(left.position, [0, 20, 15], atol=1e-9)
    np.testing.assert_allclose(left.direction, [-1, 0, 0], atol=1e-9)
    assert left.sizes_mm == pytest.approx({"length": 40, "width": 30})
    edges = block.of_kind("edge")
    assert len(edges) == 30
    assert all(edge.sizes_mm["length"] > 0 for edge in edges)
    (slot,) = block.of_kind("slot")
    assert slot.sizes_mm == pytest.approx({"width": 20})
    assert not block.of_kind("hole")
    assert not block.of_kind("boss")


def test_ids_do_not_depend_on_the_order_of_the_file():
    brep = slotted_block().brep()
    order = np.random.default_rng(7).permutation(len(brep.faces))
    place = {int(old): new for new, old in enumerate(order)}
    turned = replace(
        brep,
        faces=tuple(brep.faces[k] for k in order),
        edges=tuple(replace(edge, faces=tuple(place[k] for k in edge.faces)) for edge in brep.edges),
    )
    first, second = catalogue_of(brep), catalogue_of(turned)
    for a, b in zip(first.features, second.features, strict=True):
        assert (a.id, a.kind) == (b.id, b.kind)
        np.testing.assert_allclose(a.position, b.position, atol=1e-9)
        np.testing.assert_allclose(a.direction, b.direction, atol=1e-9)


def test_a_hole_of_two_faces_is_one_feature(plate):
    first, second = plate.of_kind("hole")
    assert first.sizes_mm["diameter"] == pytest.approx(8)
    assert len(first.references) == 2
    np.testing.assert_allclose((first.position - second.position)[:2], [-40, 0], atol=1e-9)


def test_a_convex_cylinder_is_a_boss(plate):
    brep = plate.outline.brep
    convex = replace(brep, faces=tuple(replace(face, concave=False) for face in brep.faces))
    assert ids(catalogue_of(convex), "boss") == ["B1", "B2"]


def test_a_rounded_corner_is_no_hole():
    solid, (hole,) = drilled_plate([(20.0, 20.0)])
    brep = solid.brep()
    flat = Face("other", np.zeros(3), np.zeros(3), np.nan, False, brep.faces[hole[1]].edges)
    half = replace(brep, faces=tuple(flat if k == hole[1] else face for k, face in enumerate(brep.faces)))
    assert not catalogue_of(half).of_kind("hole")


def test_distances_and_diameters_on_features(block, plate):
    outcome = outcome_on_features(block, "distance", ["F1", plane_at(block, 0, 60.0)])
    assert isinstance(outcome, Derived)
    assert outcome.value_mm == pytest.approx(60)
    outcome = outcome_on_features(plate, "diameter", ["H1"])
    assert isinstance(outcome, Derived)
    assert outcome.value_mm == pytest.approx(8)
    outcome = outcome_on_features(plate, "distance", ["H1", "H2"])
    assert isinstance(outcome, Derived)
    assert outcome.value_mm == pytest.approx(40)
    across = outcome_on_features(block, "distance", ["F1", plane_at(block, 2, 0.0)])
    assert across == NotDerived("the faces are not parallel, or lie in one plane")


@pytest.mark.parametrize(
    ("kind", "names", "telling"),
    [
        ("distance", ["F1", "F99"], "F1 to F12, E1 to E30, S1 to S1"),
        ("diameter", ["H1"], "no feature of this id"),
        ("diameter", ["F1"], "only a hole or a boss"),
        ("distance", ["F1", "F1"], "the same"),
        ("distance", ["S1", "F1"], "two planes already"),
    ],
)
def test_ids_that_cannot_be_used(block, kind, names, telling):
    with pytest.raises(InputError, match=telling):
        outcome_on_features(block, kind, names)


def test_proposals_are_measurable_and_not_repeated(block, plate):
    found = propose(block)
    values = {(proposal.what.split()[0], round(proposal.nominal_mm, 6)) for proposal in found}
    assert {("width", 20.0), ("overall", 60.0), ("overall", 40.0), ("overall", 30.0), ("step", 20.0)} <= values
    assert len({frozenset(proposal.features) for proposal in found}) == len(found)
    kinds = [proposal.kind for proposal in propose(plate)]
    assert kinds.count("diameter") == 2
    positions = [proposal for proposal in propose(plate) if proposal.kind == "position"]
    assert [proposal.features for proposal in positions] == [("H1",), ("H2",)]
    assert len(positions[0].datums) == 3
    assert positions[0].basic_mm != positions[1].basic_mm


def test_a_part_without_parallel_planes_has_no_proposal_of_a_distance():
    wedge = prism([(0, 0), (40, 0), (0, 30)], 1.0)
    distances = [proposal.nominal_mm for proposal in propose(catalogue_of(wedge.brep()))]
    assert distances == [pytest.approx(1.0)]
