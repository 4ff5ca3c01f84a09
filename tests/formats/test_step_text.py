"""Records of a STEP file and the dimensions they state; no CAD kernel is involved."""

import math
import string

import numpy as np
import pytest

from viewgauge.formats.step.pmi import DimensionReader, pmi_notes, to_pmi_records
from viewgauge.formats.step.step_text import Enumeration, Record, Ref, StepText, decode_string, not_a_number
from viewgauge.formats.step.step_units import Units
from viewgauge.part.brep import Edge, Face, Reference

UNITS = """
#1=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));
#2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#1);
#3=(CONVERSION_BASED_UNIT('inch',#2) LENGTH_UNIT() NAMED_UNIT(*));
#4=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));
#5=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.017453292519943295),#4);
#6=(CONVERSION_BASED_UNIT('degree',#5) NAMED_UNIT(*) PLANE_ANGLE_UNIT());
"""
ASPECTS = """
#10=SHAPE_ASPECT('','',#9,.T.);
#11=SHAPE_ASPECT('','',#9,.T.);
#12=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#10,#8,#20);
#13=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#11,#8,#21);
#20=ADVANCED_FACE('',(#90),#91,.T.);
#21=EDGE_CURVE('',#92,#93,#94,.T.);
"""
DIMENSION = string.Template("""
#30=$dimension;
#31=DIMENSIONAL_CHARACTERISTIC_REPRESENTATION(#30,#32);
#32=SHAPE_DIMENSION_REPRESENTATION('',($items),#7);
#33=(LENGTH_MEASURE_WITH_UNIT() MEASURE_REPRESENTATION_ITEM() MEASURE_WITH_UNIT(LENGTH_MEASURE(2.),$unit)
 REPRESENTATION_ITEM('nominal value'));
""")
SIZE = "DIMENSIONAL_SIZE(#10,'diameter')"


def tolerance(lower: str, upper: str, unit: str = "#1", measure: str = "LENGTH") -> str:
    return (
        f"#40=PLUS_MINUS_TOLERANCE(#41,#30);#41=TOLERANCE_VALUE(#42,#43);"
        f"#42={measure}_MEASURE_WITH_UNIT({measure}_MEASURE({lower}),{unit});"
        f"#43={measure}_MEASURE_WITH_UNIT({measure}_MEASURE({upper}),{unit});"
    )


def read(dimension: str = SIZE, more: str = "", *, unit: str = "#1", items: str = "#33"):
    text = UNITS + ASPECTS + DIMENSION.substitute(dimension=dimension, unit=unit, items=items) + more
    reader = DimensionReader(StepText.scan(text))
    dimensions = reader.dimensions()
    assert len(dimensions) == 1
    return dimensions[0], reader


def test_records_of_every_syntax():
    text = StepText.scan(
        "HEADER;FILE_NAME('#7=FAKE();');ENDSEC;DATA;/* #8=FAKE(); */\n"
        "#1 = POINT ( 'a''b;c' , -1.5E-3, (1, 2.), .T., $, *, #2, \"0F\", LENGTH_MEASURE(5.) ) ;\n"
        "#2=(A() /* ) */ B(1.,#1));#3=EMPTY();ENDSEC;END-ISO-10303-21;"
    )
    assert list(text.bodies) == [1, 2, 3]
    (point,) = text.records(1)
    expected = ("a'b;c", -1.5e-3, (1.0, 2.0), Enumeration("T"), None, None, Ref(2), None)
    assert point == Record("POINT", (*expected, Record("LENGTH_MEASURE", (5.0,))))
    assert text.records(2) == (Record("A", ()), Record("B", (1.0, Ref(1))))
    assert text.type_of(2) == "A+B"
    assert text.numbers("B", "EMPTY") == [2, 3]
    assert text.references(1) == (2,)
    assert text.positions == {1: 1, 2: 2, 3: 3}


@pytest.mark.parametrize("body", ["#1=A(;", "#1=A(1,2;", "#1=);", "#1=A(?);", "#1=;"])
def test_malformed_records_are_empty_not_errors(body):
    assert StepText.scan(body + "#2=B();").records(1) == ()
    assert StepText.scan(body + "#2=B();").numbers("B") == [2]


def test_a_missing_semicolon_or_quote_does_not_hang():
    assert len(StepText.scan("#1=A(" + "a" * 200_000 + "'" + "#2=B(/*" * 5000).bodies) == 0


def test_strings_are_decoded():
    assert decode_string(r"'\X2\2300\X0\10 \X\B1\S\1 it''s \\'") == "⌀10 ±± it's \\"


def test_coordinates_that_are_no_numbers():
    assert not_a_number("#1=CARTESIAN_POINT('nan (inf)',(0.,1.E-3,-2.));") is None
    for bad in ("NaN", "-inf", "1.#QNAN"):
        assert bad in (not_a_number(f"#1=CARTESIAN_POINT('',(0.,{bad},2.));") or "")


def test_units():
    text = StepText.scan(UNITS + "#7=(GLOBAL_UNIT_ASSIGNED_CONTEXT((#4,#3)));#8=UNRELATED(#3);")
    units = Units(text)
    assert units.of_geometry() == "inch"
    assert units.value(2) == 25.4
    assert units.value(5) == pytest.approx(math.radians(1), rel=1e-15)
    assert units.value(8) is None
    assert Units(StepText.scan("#9=LENGTH_MEASURE_WITH_UNIT(2.,#3);" + UNITS)).value(9) == 50.8


def test_units_that_refer_to_themselves_end():
    text = "#1=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.),#2);#2=(CONVERSION_BASED_UNIT('x',#1) LENGTH_UNIT());"
    assert Units(StepText.scan(text)).value(1) is None


def test_nominal_and_deviations_are_converted_to_mm():
    dimension, reader = read(more=tolerance("-0.1", "0.2", "#3"), unit="#3")
    assert dimension.pmi_record.nominal_mm == pytest.approx(50.8, rel=1e-15)
    assert dimension.pmi_record.tolerance_mm == pytest.approx((-2.54, 5.08), rel=1e-15)
    assert dimension.first == (20,)
    assert dimension.pmi_record.name == "diameter_1"
    assert reader.plus_minus == {30: [41]}


@pytest.mark.parametrize("bounds", [("0.1", "0.3"), ("-0.3", "-0.1"), ("0.", "0.2")])
def test_deviations_keep_their_sign(bounds):
    dimension, _ = read(more=tolerance(*bounds))
    assert dimension.pmi_record.tolerance_mm == tuple(float(bound) for bound in bounds)


def limit(number: int, name: str, value: float) -> str:
    return (
        f"#{number}=(LENGTH_MEASURE_WITH_UNIT() MEASURE_REPRESENTATION_ITEM() "
        f"MEASURE_WITH_UNIT(LENGTH_MEASURE({value!r}),#1) REPRESENTATION_ITEM('{name}'));"
    )


def test_limits_become_deviations_from_the_nominal_value():
    limits = limit(50, "upper limit", 2.3) + limit(51, "lower limit", 1.9)
    dimension, _ = read(more=limits, items="#33,#50,#51")
    assert dimension.pmi_record.nominal_mm == 2.0
    assert dimension.pmi_record.tolerance_mm == pytest.approx((-0.1, 0.3))
    middle, _ = read(more=limits, items="#50,#51")
    assert middle.pmi_record.nominal_mm == pytest.approx(2.1)
    assert middle.pmi_record.tolerance_mm == pytest.approx((-0.2, 0.2))


def test_a_basic_characteristic_has_no_tolerance():
    note = "#50=DESCRIPTIVE_REPRESENTATION_ITEM('dimensional note','theoretical');"
    dimension, _ = read(more=note, items="#50,#33")
    assert dimension.pmi_record.nominal_mm == 2.0
    assert dimension.pmi_record.tolerance_mm is None
    assert dimension.pmi_record.problem == ""


def test_what_cannot_be_read_is_named():
    assert read(items="")[0].pmi_record.problem == "the file gives no value"
    fit = "#40=PLUS_MINUS_TOLERANCE(#41,#30);#41=LIMITS_AND_FITS('Q','hole','7','');"
    assert "tolerance class Q7" in read(more=fit)[0].pmi_record.problem
    assert "no readable limits" in read(more="#40=PLUS_MINUS_TOLERANCE(#41,#30);")[0].pmi_record.problem
    assert "curved distance" in read("DIMENSIONAL_LOCATION('curved distance','',#10,#11)")[0].pmi_record.problem
    lost = read("DIMENSIONAL_SIZE(#99,'diameter')")[0]
    assert lost.first == ()
    assert lost.problem_first == "refers to no geometry"


def test_a_reference_to_other_geometry_is_named():
    other = "#60=SHAPE_ASPECT('','',#9,.T.);#61=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#60,#8,#62);#62=PLANE('P.1',#63);"
    dimension, _ = read("DIMENSIONAL_LOCATION('linear distance','',#10,#60)", other)
    assert dimension.first == (20,)
    assert dimension.second == ()
    assert dimension.problem_second == 'refers to plane "P.1", which is no face or edge'


@pytest.mark.parametrize(
    ("dimension", "kind"),
    [
        ("DIMENSIONAL_LOCATION('linear distance','',#10,#11)", "distance"),
        ("(DIMENSIONAL_LOCATION() DIRECTED_DIMENSIONAL_LOCATION() "
         "SHAPE_ASPECT_RELATIONSHIP('linear distance','',#10,#11))", "distance"),
        ("ANGULAR_LOCATION('','',#10,#11,.EQUAL.)", "angle"),
        ("DIMENSIONAL_SIZE(#10,'thickness')", "length"),
        ("DIMENSIONAL_SIZE(#10,'spherical radius')", "radius"),
        ("DIMENSIONAL_SIZE(#10,'toroidal minor diameter')", "other"),
        ("ANGULAR_SIZE(#10,'',.EQUAL.)", "angle"),
    ],
)  # fmt: skip
def test_kinds_and_sides(dimension, kind):
    found, _ = read(dimension)
    assert found.pmi_record.kind == kind
    assert found.first == (20,)
    assert found.second == ((21,) if "#11" in dimension else ())


def test_a_pattern_is_one_characteristic_with_all_its_faces():
    more = (
        "#70=(COMPOSITE_SHAPE_ASPECT() DATUM_FEATURE() SHAPE_ASPECT('','',#9,.T.));"
        "#71=SHAPE_ASPECT_RELATIONSHIP('','',#70,#10);#72=SHAPE_ASPECT_RELATIONSHIP('','',#70,#73);"
        "#73=COMPOSITE_GROUP_SHAPE_ASPECT('','',#9,.T.);#74=SHAPE_ASPECT_RELATIONSHIP('','',#73,#75);"
        "#75=SHAPE_ASPECT('','',#9,.T.);#77=CLOSED_SHELL('',(#20,#78));#78=ADVANCED_FACE('',(),#91,.T.);"
        "#76=GEOMETRIC_ITEM_SPECIFIC_USAGE('','',#75,#8,SET_REPRESENTATION_ITEM((#77,#21)));"
        "#79=SHAPE_ASPECT_RELATIONSHIP('','',#73,#70);"  # a loop, which must end
    )
    assert read("DIMENSIONAL_SIZE(#70,'diameter')", more)[0].first == (20, 78, 21)


def test_captions_name_characteristics_apart():
    more = (
        "#80=DRAUGHTING_CALLOUT('Size/1  x',());#81=DRAUGHTING_MODEL_ITEM_ASSOCIATION('','',#30,#8,#80);"
        "#34=DIMENSIONAL_SIZE(#10,'thickness');#82=DRAUGHTING_MODEL_ITEM_ASSOCIATION('','',#34,#8,#80);"
        "#35=DIMENSIONAL_SIZE(#10,'');"
    )
    text = UNITS + ASPECTS + DIMENSION.substitute(dimension=SIZE, unit="#1", items="#33") + more
    names = [dimension.pmi_record.name for dimension in DimensionReader(StepText.scan(text)).dimensions()]
    assert names == ["Size-1 x", "Size-1 x_2", "dimension_3"]


def test_notes_explain_the_counts():
    more = (
        tolerance("-1.", "1.")
        + "#44=PLUS_MINUS_TOLERANCE(#41,#30);#45=PLUS_MINUS_TOLERANCE(#41,#99);"
    )  # fmt: skip
    dimension, reader = read(more=more)
    notes = " ".join(pmi_notes(reader.text, [dimension.pmi_record]))
    assert "1 PLUS_MINUS_TOLERANCE entities belong to no dimension" in notes
    assert "1 PLUS_MINUS_TOLERANCE entities repeat" in notes
    assert pmi_notes(StepText.scan(""), []) == ["The file has no semantic PMI: geometry only."]
    drawn = StepText.scan("#1=DRAUGHTING_CALLOUT('E1',());#2=TESSELLATED_ANNOTATION_OCCURRENCE('',(),#3);")
    assert pmi_notes(drawn, [])[0].startswith("The file has graphical PMI (2 annotations")


FACES = tuple(Face(kind, np.zeros(3), np.zeros(3), math.nan, False, ()) for kind in ("plane", "cylinder"))
EDGES = tuple(
    Edge(kind, np.eye(3)[:2], (0, 1), np.zeros((2, 2, 3)), np.zeros(3), np.zeros(3), math.nan, False)
    for kind in ("line", "other")
)


def pmi_record(dimension, shapes):
    return to_pmi_records([dimension], shapes, FACES, EDGES)[0]


def test_references_become_indices_and_lost_ones_a_problem():
    dimension, _ = read("DIMENSIONAL_LOCATION('linear distance','',#10,#11)")
    face, edge = Reference("face", 0), Reference("edge", 1)
    found = pmi_record(dimension, {20: [face], 21: [edge, edge]})
    assert (found.first, found.second, found.problem) == ((face,), (edge,), "")
    assert pmi_record(dimension, {20: [face]}).problem == "1 of 1 faces and edges it refers to are not on the part"


def test_a_centre_is_known_by_round_faces_only():
    derived = (
        "#70=CENTRE_OF_SYMMETRY('','',#9,.F.);#71=SHAPE_ASPECT_DERIVING_RELATIONSHIP('','',#70,#10);"
    )  # fmt: skip
    dimension, _ = read("DIMENSIONAL_LOCATION('linear distance','',#70,#11)", derived)
    assert dimension.first == (20,)
    edge = {21: [Reference("edge", 0)]}
    assert "derived" in pmi_record(dimension, {20: [Reference("face", 0)], **edge}).problem
    assert pmi_record(dimension, {20: [Reference("face", 1)], **edge}).problem == ""


def test_a_curve_length_is_a_length_where_the_curve_is_straight():
    dimension, _ = read("DIMENSIONAL_SIZE(#11,'curve length')")
    assert pmi_record(dimension, {21: [Reference("edge", 0)]}).kind == "length"
    bent = pmi_record(dimension, {21: [Reference("edge", 1)]})
    assert bent.kind == "length"
    assert "curve length" in bent.problem
