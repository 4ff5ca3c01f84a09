"""Geometric tolerances, datums, qualifiers and counts from the text of STEP files; no CAD kernel is involved."""

import math

import pytest

from viewgauge.formats.step.pmi import (
    GeometricToleranceReader,
    count_toleranced,
    pmi_findings,
    pmi_notes,
    pmi_sources,
)
from viewgauge.formats.step.step_text import StepText
from viewgauge.part.geometric_tolerances import GEOMETRIC_TOLERANCES
from viewgauge.part.indication import Measurability

BASE = """
#1=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));
#2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.2),#1);
#3=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(12.5),#1);
#10=SHAPE_ASPECT('','',#9,.T.);
#12=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#10,#8,#20);
#20=ADVANCED_FACE('',(#90),#91,.T.);
#51=DATUM('','',#9,.F.,'A');
#52=DATUM('','',#9,.F.,'B');
#53=DATUM('','',#9,.F.,'C');
"""
SYSTEM = """
#61=DATUM_REFERENCE_COMPARTMENT('','',#9,.F.,#51,$);
#62=DATUM_REFERENCE_COMPARTMENT('','',#9,.F.,COMMON_DATUM_LIST((#64,#65)),$);
#63=DATUM_SYSTEM('','',#9,.F.,(#61,#62,#66));
#64=DATUM_REFERENCE_ELEMENT('','',#9,.F.,#52,$);
#65=DATUM_REFERENCE_ELEMENT('','',#9,.F.,#53,$);
#66=DATUM_REFERENCE_COMPARTMENT('','',#9,.F.,#53,(SIMPLE_DATUM_REFERENCE_MODIFIER(.MAXIMUM_MATERIAL_REQUIREMENT.)));
"""


def read(text: str):
    """The one tolerance of a text, and the kinds that are counted in it."""
    (source,) = GeometricToleranceReader(StepText.scan(BASE + text)).tolerances()
    return source.pmi_record, count_toleranced(BASE + text)


@pytest.mark.parametrize("kind", GEOMETRIC_TOLERANCES)
def test_every_kind_is_read_counted_and_has_its_reason(kind):
    for text in (
        f"#40={kind.upper()}_TOLERANCE('T1','',#2,#10);",
        f"#40=(GEOMETRIC_TOLERANCE('T1','',#2,#10) {kind.upper()}_TOLERANCE());",
        f"#40=( {kind.upper()}_TOLERANCE ( ) GEOMETRIC_TOLERANCE('T1','',#2,#10) );",
    ):
        record, counts = read(text)
        assert (record.name, record.kind, record.indication.record) == ("T1", kind, 40)
        assert record.indication.zone_mm == 0.2
        assert record.indication.text == f"{kind.replace('_', ' ')} 0.2"
        assert record.status in (Measurability.NOT_MEASURABLE, Measurability.OUT_OF_SCOPE)
        assert record.problem
        assert counts == {kind: 1}


def test_a_kind_that_is_not_known_is_listed_all_the_same():
    record, counts = read("#40=GEOMETRIC_TOLERANCE_WITH_MODIFIERS('','',#2,#10,(.FREE_STATE.));")
    assert (record.kind, counts) == ("geometric_tolerance", {"geometric_tolerance": 1})
    assert record.indication.modifiers == ("free state",)


def test_datums_keep_their_order_common_ones_and_modifiers():
    record, _ = read(
        SYSTEM + "#40=(GEOMETRIC_TOLERANCE('','',#2,#10) GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE((#63)) "
        "POSITION_TOLERANCE());"
    )
    assert record.indication.datums == ("A", "B-C", "C (M)")
    simple, _ = read(SYSTEM + "#40=PARALLELISM_TOLERANCE('','',#2,#10,(#63));")
    assert simple.indication.text == "parallelism 0.2 | A | B-C | C (M)"
    older = "#61=DATUM_REFERENCE(2,#52);#62=DATUM_REFERENCE(1,#51);"
    assert read(older + "#40=ANGULARITY_TOLERANCE('','',#2,#10,(#61,#62));")[0].indication.datums == ("A", "B")


def test_zones_and_modifiers_stand_as_on_a_drawing():
    tolerance = (
        "#40=(GEOMETRIC_TOLERANCE('','',#2,#10) "
        "GEOMETRIC_TOLERANCE_WITH_MODIFIERS((.MAXIMUM_MATERIAL_REQUIREMENT.,.TANGENT_PLANE.)) POSITION_TOLERANCE());"
        "#41=TOLERANCE_ZONE('','',#9,.F.,(#40),#42);#42=TOLERANCE_ZONE_FORM('cylindrical or circular');"
        "#43=PROJECTED_ZONE_DEFINITION(#41,(),#10,#3);"
    )
    indication = read(tolerance)[0].indication
    assert indication.text == "position diameter 0.2 (P) 12.5 (M) (T)"
    assert indication.modifiers == (
        "maximum material requirement", "tangent plane", "projected tolerance zone 12.5",
    )  # fmt: skip
    unequal = (
        "#40=(GEOMETRIC_TOLERANCE('','',#2,#10) SURFACE_PROFILE_TOLERANCE() "
        "UNEQUALLY_DISPOSED_GEOMETRIC_TOLERANCE(#2));"
    )
    assert read(unequal)[0].indication.text == "surface profile 0.2 (U) 0.2"
    area = (
        "#40=(FLATNESS_TOLERANCE() GEOMETRIC_TOLERANCE('','',#2,#10) GEOMETRIC_TOLERANCE_WITH_DEFINED_UNIT(#3) "
        "GEOMETRIC_TOLERANCE_WITH_DEFINED_AREA_UNIT(.RECTANGULAR.,#3));"
    )
    assert read(area)[0].indication.text == "flatness 0.2 / 12.5 x 12.5"
    sphere = (
        "#40=POSITION_TOLERANCE('','',#2,#10);#41=TOLERANCE_ZONE('','',#9,.F.,(#40),#42);"
        "#42=TOLERANCE_ZONE_FORM('spherical');"
    )
    assert read(sphere)[0].indication.text == "position spherical diameter 0.2"


def test_what_a_tolerance_refers_to_is_followed():
    assert GeometricToleranceReader(StepText.scan(BASE + "#40=FLATNESS_TOLERANCE('','',#2,#10);")).tolerances()[
        0
    ].first == (20,)
    of_size = "#30=DIMENSIONAL_SIZE(#10,'diameter');#40=STRAIGHTNESS_TOLERANCE('','',#2,#30);"
    assert GeometricToleranceReader(StepText.scan(BASE + of_size)).tolerances()[0].first == (20,)
    lost, _ = read("#40=FLATNESS_TOLERANCE('','',#2,#99);")
    assert "refers to no face or edge" in lost.problem
    broken, counts = read("#40=FLATNESS_TOLERANCE('','',$,$);")
    assert math.isnan(broken.indication.zone_mm)
    assert counts == {"flatness": 1}


VALUE = (
    "#33=(LENGTH_MEASURE_WITH_UNIT() MEASURE_REPRESENTATION_ITEM() MEASURE_WITH_UNIT(LENGTH_MEASURE(9.),#1) {} "
    "REPRESENTATION_ITEM('nominal value'));"
    "#30=DIMENSIONAL_SIZE(#10,'diameter');#31=DIMENSIONAL_CHARACTERISTIC_REPRESENTATION(#30,#32);"
    "#32=SHAPE_DIMENSION_REPRESENTATION('',(#33,#34),#7);"
)
DEVIATIONS = "#35=PLUS_MINUS_TOLERANCE(#36,#30);#36=TOLERANCE_VALUE(#2,#2);"


def size(more: str = "", qualifiers: str = ""):
    text = BASE + VALUE.format(qualifiers) + more
    (source,) = pmi_sources(StepText.scan(text))
    return source.pmi_record, count_toleranced(text)


def test_a_maximum_or_minimum_is_a_limit_on_one_side():
    for word, limits in (("maximum", (None, 9.0)), ("minimum", (9.0, None))):
        record, counts = size(f"#70=TYPE_QUALIFIER('{word}');", "QUALIFIED_REPRESENTATION_ITEM((#70))")
        assert (record.tolerance_mm, record.indication.limits) == (None, limits)
        assert record.indication.toleranced
        assert counts == {"diameter": 1}
    record, _ = size(DEVIATIONS + "#70=TYPE_QUALIFIER('maximum');", "QUALIFIED_REPRESENTATION_ITEM((#70))")
    assert record.tolerance_mm == (0.2, 0.2)


def test_basic_and_reference_dimensions_demand_nothing():
    for word, meaning in (("theoretical", "basic"), ("auxiliary", "reference")):
        record, counts = size(f"#34=DESCRIPTIVE_REPRESENTATION_ITEM('dimensional note','{word}');")
        assert not record.indication.toleranced
        assert record.indication.modifiers == (meaning,)
        assert counts == {}


def test_an_average_and_the_like_are_no_two_point_sizes():
    record, counts = size(DEVIATIONS + "#70=TYPE_QUALIFIER('average');", "QUALIFIED_REPRESENTATION_ITEM((#70))")
    assert "average size" in record.problem
    assert counts == {"diameter": 1}
    note = "#34=DESCRIPTIVE_REPRESENTATION_ITEM('dimensional note','maximum inscribed association criterion');"
    assert "inscribed" in size(DEVIATIONS + note)[0].problem
    assert size(DEVIATIONS + note.replace("maximum inscribed association criterion", "statistical"))[0].problem == ""


@pytest.mark.parametrize(
    ("fit", "deviations"),
    [
        ("'H','hole','7','ISO 286'", (0.0, 0.015)),
        ("'h','hole','7',''", (0.0, 0.015)),
        ("'G','shaft','6',''", (-0.014, -0.005)),
        ("'g','','IT6',''", (-0.014, -0.005)),
        ("'H','hole','H7',''", (0.0, 0.015)),
    ],
)
def test_tolerance_classes_become_deviations(fit, deviations):
    record, counts = size(f"#35=PLUS_MINUS_TOLERANCE(#36,#30);#36=LIMITS_AND_FITS({fit});")
    assert record.tolerance_mm == pytest.approx(deviations)
    assert counts == {"diameter": 1}


def test_a_size_that_is_a_datum_feature_is_one_record_of_its_own():
    for entity in (
        "DIMENSIONAL_SIZE_WITH_DATUM_FEATURE('feature','',#9,.T.,#30,'diameter')",
        "(DATUM_FEATURE() DIMENSIONAL_SIZE(#30,'diameter') DIMENSIONAL_SIZE_WITH_DATUM_FEATURE() "
        "SHAPE_ASPECT('feature','',#9,.T.))",
    ):
        text = BASE + f"#30={entity};#39=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#30,#8,#20);" + DEVIATIONS
        (source,) = pmi_sources(StepText.scan(text))
        assert (source.pmi_record.kind, source.first) == ("diameter", (20,))
        assert count_toleranced(text) == {"diameter": 1}


def test_a_zone_without_width_and_a_count_that_differs_are_findings():
    record, counts = size(DEVIATIONS)
    (finding,) = pmi_findings([record], counts, (), 0)
    assert (finding.name, finding.refused) == ("tolerance_without_width", False)
    assert "one value was written" in finding.cause
    assert [f.name for f in pmi_findings([], {"position": 1}, (), 0)] == ["pmi_count"]


def test_datum_targets_and_general_tolerances_are_noted():
    text = StepText.scan(
        BASE
        + "#71=PLACED_DATUM_TARGET_FEATURE('','point',#9,.T.,'1');#72=DATUM_TARGET_RELATIONSHIP('',$,#71,#51);"
        + "#73=DESCRIPTIVE_REPRESENTATION_ITEM('general tolerances','ISO 2768-mK');"
    )
    notes = " ".join(pmi_notes(text, []))
    assert "Datum targets: A1" in notes
    assert 'General tolerance note, not applied to any dimension: "ISO 2768-mK".' in notes


def test_drawn_pmi_without_meaning_is_a_finding():
    assert [f.name for f in pmi_findings([], {}, (), 7)] == ["graphical_pmi"]
    assert "7 annotations" in str(pmi_findings([], {}, (), 7)[0])
