"""One characteristic for each feature of a pattern and each instance of a part."""

from dataclasses import replace

import pytest
from breps import face, pmi_record, prism

from viewgauge.part.characteristics import derive_characteristics
from viewgauge.part.features.feature_groups import feature_groups
from viewgauge.part.features.outline import Outline
from viewgauge.part.indication import Indication

# A comb: three teeth of height 10 on a base of height 5; its faces follow the profile.
COMB = [(0, 0), (50, 0), (50, 15), (40, 15), (40, 5), (30, 5), (30, 15), (20, 15), (20, 5), (10, 5), (10, 15), (0, 15)]


def flat_faces(brep, height):
    """Indices of the faces that look up at a height, mm."""
    return [k for k, f in enumerate(brep.faces) if f.axis[2] > 0.9 and abs(f.origin[2] - height) < 1e-9]


def comb(*records):
    return prism(COMB, 30.0).brep(*records)


def test_faces_that_share_an_edge_are_one_feature():
    outline = Outline(comb())
    tops = [face(k) for k in flat_faces(outline.brep, 15)]
    assert [len(group) for group in feature_groups(outline, tops)] == [1, 1, 1]
    everything = [face(k) for k in range(len(outline.brep.faces))]
    assert len(feature_groups(outline, everything)) == 1


def test_a_height_of_three_teeth_is_measured_on_each():
    tops, bottom = flat_faces(comb(), 15), [k for k, f in enumerate(comb().faces) if f.axis[2] < -0.9]
    record = pmi_record("distance", 15.0, [face(k) for k in tops], [face(k) for k in bottom], name="H")
    for turned in (record, replace(record, first=record.second, second=record.first)):
        characteristics, not_measurable = derive_characteristics(comb(turned))
        assert not not_measurable
        assert [c.id for c in characteristics] == ["H/1", "H/2", "H/3"]
        assert [c.indication.features for c in characteristics] == [3, 3, 3]
        middles = [c.measurands[0].points[:, 0].mean() for c in characteristics]
        assert middles == sorted(middles)
        assert middles[0] < 11 < 19 < middles[1] < 31 < 39 < middles[2]


def test_a_tooth_of_another_height_is_listed_with_its_reason():
    profile = [(x, 14 if (x, z) in ((50, 15), (40, 15)) else z) for x, z in COMB]
    brep = prism(profile, 30.0).brep()
    tops = [*flat_faces(brep, 15), *flat_faces(brep, 14)]
    bottom = [face(k) for k, f in enumerate(brep.faces) if f.axis[2] < -0.9]
    record = pmi_record("distance", 15.0, [face(k) for k in tops], bottom, name="H")
    characteristics, (other,) = derive_characteristics(replace(brep, pmi_records=(record,)))
    assert len(characteristics) == 2
    assert "disagrees with the geometry, 14 mm" in other.reason


def test_what_is_not_measured_is_listed_for_each_feature_too():
    tops = [face(k) for k in flat_faces(comb(), 15)]
    tolerance = replace(
        pmi_record("position", float("nan"), tops, tolerance_mm=None, name="P"),
        problem="not yet",
        indication=Indication(record=7, zone_mm=0.1),
    )
    _, not_measurable = derive_characteristics(comb(tolerance))
    assert [(entry.id, entry.reason, entry.indication.features) for entry in not_measurable] == [
        ("P/1", "not yet", 3),
        ("P/2", "not yet", 3),
        ("P/3", "not yet", 3),
    ]


def test_every_instance_of_a_part_has_its_own():
    one = comb()
    count, lines = len(one.faces), len(one.edges)
    shift = [0.0, 0.0, 100.0]
    moved_faces = tuple(
        replace(f, origin=f.origin + shift, edges=tuple(e + lines for e in f.edges), instance=1) for f in one.faces
    )
    moved_edges = tuple(
        replace(e, points=e.points + shift, faces=tuple(f + count for f in e.faces), instance=1) for e in one.edges
    )
    (top, *_), bottom = flat_faces(one, 15), next(k for k, f in enumerate(one.faces) if f.axis[2] < -0.9)
    record = pmi_record(
        "distance", 15.0, [face(top), face(top + count)], [face(bottom), face(bottom + count)], name="H"
    )
    both = replace(one, faces=(*one.faces, *moved_faces), edges=(*one.edges, *moved_edges), pmi_records=(record,))
    characteristics, not_measurable = derive_characteristics(both)
    assert not not_measurable
    assert [c.id for c in characteristics] == ["H/1", "H/2"]
    heights = [c.measurands[0].points[:, 2] for c in characteristics]
    assert heights[1] == pytest.approx(heights[0] + 100.0)
