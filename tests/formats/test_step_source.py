"""Every form of a STEP file's text: compressed, marked, renumbered, of edition 3, tessellated, without geometry."""

from __future__ import annotations

import gzip
import zipfile
from pathlib import Path

import numpy as np
import pytest
from step_texts import CENTIMETRES, plate_with_leaning_hole, step_text, write_shape

from viewgauge.exceptions import PartFileError
from viewgauge.formats.step.kernel_process import read_step
from viewgauge.formats.step.source.coordinates import refuse_far_points
from viewgauge.formats.step.source.external_files import external_files, refuse_without_geometry
from viewgauge.formats.step.source.record_numbers import renumbered
from viewgauge.formats.step.source.step_sections import one_data_section, referenced_files
from viewgauge.formats.step.source.step_source import read_source
from viewgauge.formats.step.source.tessellation import has_surfaces, tessellated_bodies, tessellated_brep
from viewgauge.formats.step.step_text import StepText, decode_string

TEXT = step_text("#17=CARTESIAN_POINT('Ø #99 ; DATA;',(0.,0.,1.));\n#20 = VERTEX_POINT('', #17);\n")
CORNERS = "((0.,0.,0.),(4.,0.,0.),(0.,3.,0.),(4.,3.,0.),(0.,0.,2.),(4.,0.,2.),(0.,3.,2.),(4.,3.,2.))"
QUADS = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]


def source_of(path: Path, content: bytes):
    path.write_bytes(content)
    folder = path.parent / "scratch"
    folder.mkdir(exist_ok=True)
    return read_source(path, folder)


def test_a_plain_file_is_read_where_it_lies(tmp_path):
    source = source_of(tmp_path / "a.step", TEXT.encode())
    assert source.text == TEXT
    assert source.kernel_path == tmp_path / "a.step"
    assert source.kernel_numbers == {}


def test_the_encoding_before_utf_8_is_latin_1(tmp_path):
    assert source_of(tmp_path / "a.step", TEXT.encode("latin-1")).text == TEXT


@pytest.mark.parametrize(
    "content",
    [
        b"\xef\xbb\xbf" + TEXT.encode(),
        gzip.compress(TEXT.encode()),
        gzip.compress(b"\xef\xbb\xbf" + TEXT.encode()),
        b"\xff\xfe" + TEXT.encode("utf-16-le"),
        b"\xfe\xff" + TEXT.encode("utf-16-be"),
    ],
    ids=["byte order mark", "gzip", "gzip of marked", "utf-16-le", "utf-16-be"],
)
def test_the_kernel_gets_a_copy_in_its_form(tmp_path, content):
    source = source_of(tmp_path / "a.step", content)
    assert source.text == TEXT
    assert source.kernel_path != tmp_path / "a.step"
    assert source.kernel_path.read_text(encoding="utf-8") == TEXT


def archive(path: Path, *names: str) -> Path:
    with zipfile.ZipFile(path, "w") as written:
        for name in names:
            written.writestr(name, TEXT)
    return path


def test_an_archive_holds_one_file(tmp_path):
    assert read_source(archive(tmp_path / "a.stpz", "readme.md", "b.STP"), tmp_path).text == TEXT
    with pytest.raises(PartFileError, match="does not hold one STEP file") as caught:
        read_source(archive(tmp_path / "b.stpz", "a.stp", "b.stp"), tmp_path)
    assert caught.value.got == "a.stp, b.stp"


@pytest.mark.parametrize("length", [2, 12, 60])
def test_a_damaged_compressed_file_is_refused(tmp_path, length):
    with pytest.raises(PartFileError, match="cannot be unpacked"):
        source_of(tmp_path / "a.stpz", gzip.compress(TEXT.encode())[:length])


@pytest.mark.parametrize(("content", "match"), [(b"hello", "not a STEP file"), (TEXT[:-20].encode(), "truncated")])
def test_what_a_compressed_file_holds_is_checked(tmp_path, content, match):
    with pytest.raises(PartFileError, match=match):
        source_of(tmp_path / "a.stpz", gzip.compress(content))


def test_large_record_numbers_are_replaced_outside_of_strings_and_comments():
    text = "#2147483648=A('#2147483648',#30); /* #2147483648 */ #30=B(#2147483648,#9999999999);"
    plain, numbers = renumbered(text)
    assert plain == "#1=A('#2147483648',#2); /* #2147483648 */ #2=B(#1,#3);"
    assert numbers == {2147483648: 1, 30: 2, 9999999999: 3}
    assert renumbered("#2147483647=A();") == ("#2147483647=A();", {})
    with pytest.raises(PartFileError, match="record number is too long"):
        renumbered(f"#{'7' * 5000}=A();")


EDITION_3 = (
    "ISO-10303-21;HEADER;FILE_DESCRIPTION(('ANCHOR;'),'4;1');ENDSEC;"
    "ANCHOR;<top>=#1{(unit:'DATA;')};ENDSEC;REFERENCE;#8=<sub/nut.stp#face>;#9=<nut.stp#a>;@5=<#own>;ENDSEC;"
    "DATA('one',('X'));#1=A('ENDSEC;');ENDSEC;DATA('two;',('Y'));#2=B(#1);ENDSEC;END-ISO-10303-21;"
    "SIGNATURE;MII==ENDSEC;"
)


def test_sections_of_edition_3_are_taken_out():
    text = one_data_section(EDITION_3)
    header = "ISO-10303-21;\nHEADER;FILE_DESCRIPTION(('ANCHOR;'),'4;1');ENDSEC;\n"
    assert text == header + "DATA;#1=A('ENDSEC;');#2=B(#1);ENDSEC;\nEND-ISO-10303-21;\n"
    assert referenced_files(EDITION_3) == ["sub/nut.stp", "nut.stp"]
    assert one_data_section(TEXT) is TEXT  # "DATA;" stands in a string too
    assert referenced_files(TEXT) == []


@pytest.mark.parametrize(
    ("written", "text"),
    [
        (r"'\X2\00D8\X0\9 \X2\00B10394\X0\'", "Ø9 ±Δ"),
        (r"'\X2\D83DDE00\X0\ \X4\0001F600\X0\'", "😀 😀"),
        (r"'\X2\D83D\X0\'", "�"),  # half of a pair
        (r"'\X\D8\X\b1'", "Ø±"),
        (r"'\S\X \PE\\S\0\PA\\S\X'", "Ø АØ"),  # Latin, Cyrillic, Latin
        (r"'\S\'''", "§"),
        (r"'a\\X2\\00D8 it''s'", r"a\X2\00D8 it's"),
        ("'Ø9 Bohrung ±'", "Ø9 Bohrung ±"),
    ],
)
def test_escapes_of_strings(written, text):
    assert decode_string(written) == text


@pytest.mark.parametrize(("number", "factor"), [("1.E+100", 1.0), ("-1e10", 1.0), ("12345678901.", 1.0), ("2.E6", 1e3)])
def test_far_points_are_refused(number, factor):
    with pytest.raises(PartFileError, match="farther from the origin") as caught:
        refuse_far_points(f"#4 = CARTESIAN_POINT ( '' , (0.1234567890, {number}, 0.));", factor)
    assert "#4" in str(caught.value.got)
    refuse_far_points("#4=CARTESIAN_POINT('1.E100',(0.12345678901,-2.E+05,999999999.));", 1.0)


# --- tessellated geometry ---------------------------------------------------------------------------------------------


def box(faces: list[str], body: str = "TESSELLATED_SOLID('',({}),$)") -> str:
    records = f"#10=COORDINATES_LIST('',8,{CORNERS});\n"
    records += "".join(f"#{20 + k}={face};\n" for k, face in enumerate(faces))
    references = ",".join(f"#{20 + k}" for k in range(len(faces)))
    return records + f"#40={body.format(references)};\n#41=TESSELLATED_SHAPE_REPRESENTATION('',(#40),#2);\n"


INDEXED = [f"TRIANGULATED_FACE('',#10,4,(),$,{quad},((1,2,3),(1,3,4)))" for quad in QUADS]
DIRECT = [f"TRIANGULATED_FACE('',#10,8,(),$,(),(({a},{b},{c}),({a},{c},{d})))" for a, b, c, d in QUADS]
STRIPS = [f"COMPLEX_TRIANGULATED_FACE('',#10,4,(),$,({a},{b},{d},{c}),((1,2,3,4)),())" for a, b, c, d in QUADS]
FANS = [f"COMPLEX_TRIANGULATED_FACE('',#10,4,(),$,{quad},(),((1,2,3,4)))" for quad in QUADS]


@pytest.mark.parametrize("faces", [INDEXED, DIRECT, STRIPS, FANS], ids=["indexed", "direct", "strips", "fans"])
@pytest.mark.parametrize("body", ["TESSELLATED_SOLID('',({}),$)", "TESSELLATED_SHELL('',({}),$)"])
def test_triangles_of_every_kind_are_a_closed_mesh(faces, body):
    text = StepText.scan(step_text(box(faces, body)))
    assert not has_surfaces(text)
    assert tessellated_bodies(text) == [40]
    brep = tessellated_brep(text, "box", 10.0, "cm")
    assert len(brep.mesh.triangles) == 12
    np.testing.assert_allclose(brep.mesh.bounds, [[0, 0, 0], [40, 30, 20]])
    centre = brep.mesh.vertices[brep.mesh.triangles].mean(axis=1) - [20, 15, 10]
    assert (np.einsum("ij,ij->i", centre, brep.mesh.normals) > 0).all()
    assert len(brep.notes) == 1  # closed: nothing on gaps


def test_triangles_of_annotations_are_no_part():
    surface_set = "#10=COORDINATES_LIST('',3,((0.,0.,0.),(1.,0.,0.),(0.,1.,0.)));\n"
    surface_set += "#11=TRIANGULATED_SURFACE_SET('',#10,3,(),(),((1,2,3)));\n#12=TESSELLATED_GEOMETRIC_SET('',(#11));\n"
    text = StepText.scan(step_text(surface_set))
    assert tessellated_bodies(text) == []


@pytest.mark.parametrize(
    ("face", "telling"),
    [
        ("CUBIC_BEZIER_TRIANGULATED_FACE('',#10,8,(),$,(),())", "#20 = CUBIC_BEZIER_TRIANGULATED_FACE"),
        ("TRIANGULATED_FACE('',#10,4,(),$,(1,2,3,4),((1,2,9)))", "outside 1 to 4"),
        ("TRIANGULATED_FACE('',#10,4,(),$,(1,2,30),((1,2,3)))", "#20"),
        ("TRIANGULATED_FACE('',#77,4,(),$,(1,2,3),((1,2,3)))", "no coordinates"),
        ("TRIANGULATED_FACE('',#10,4,(),$,(1,2,3),((1,2)))", "#20"),
    ],
)
def test_triangles_that_cannot_be_used_are_named(face, telling):
    text = StepText.scan(step_text(box([face])))
    with pytest.raises(PartFileError, match="tessellated geometry") as caught:
        tessellated_brep(text, "box", 1.0, "mm")
    assert telling in str(caught.value.got)


def test_tessellated_instances_are_not_dropped():
    more = "".join(f"#{k}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#6,#7,$);\n" for k in (50, 51))
    text = StepText.scan(step_text(box(INDEXED) + more))
    with pytest.raises(PartFileError, match="placed in an assembly"):
        tessellated_brep(text, "box", 1.0, "mm")


# --- geometry elsewhere -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("records", "names"),
    [
        ("#9=DOCUMENT_FILE('pin_3.stp','','',#8,'',$);", ["pin_3.stp"]),
        ("#9=DOCUMENT_FILE('D1','C:\\\\cad\\\\Pin.PRT.4','',#8,'',$);", ["C:\\cad\\Pin.PRT.4"]),
        ("#9=EXTERNALLY_DEFINED_ITEM(IDENTIFIER('lid.step'),#10);", ["lid.step"]),
        ("#9=DOCUMENT_FILE('rules.pdf','','',#8,'',$);", []),
    ],
)
def test_files_that_hold_geometry(records, names):
    text = step_text(records)
    assert external_files(StepText.scan(text), text) == names


def test_a_file_without_geometry_says_so():
    text = step_text("#9=DOCUMENT_FILE('pin_3.stp','','',#8,'',$);\n")
    with pytest.raises(PartFileError, match=r"geometry is in another file: pin_3\.stp"):
        refuse_without_geometry(StepText.scan(text), text)
    text = step_text("#9=PRODUCT('a','a','',());\n")
    with pytest.raises(PartFileError, match="holds no geometry"):
        refuse_without_geometry(StepText.scan(text), text)


# --- through the kernel -----------------------------------------------------------------------------------------------


def test_the_kernel_reads_every_form(tmp_path):
    pytest.importorskip("OCP", reason="the CAD kernel (OCP) is not installed")
    plain = write_shape(plate_with_leaning_hole(0.0), tmp_path / "plain.step").read_text()
    head, rest = plain.split("ENDSEC;", 1)
    data = rest.split("DATA;", 1)[1].rsplit("ENDSEC;", 1)[0]
    third = len(data.split(";\n")) // 3
    parts = [";\n".join(data.split(";\n")[:third]) + ";\n", ";\n".join(data.split(";\n")[third:])]
    edition_3 = f"{head}ENDSEC;\nANCHOR;\n<a>=#10;\nENDSEC;\nREFERENCE;\n#900000=<nut.stp#a>;\nENDSEC;\n"
    edition_3 += "".join(f"DATA('{k}',('X'));\n{part}ENDSEC;\n" for k, part in enumerate(parts))
    edition_3 += "END-ISO-10303-21;\nSIGNATURE;\nMII==\nENDSEC;\n"
    numbered = "".join(
        f"#{int(piece[: len(piece) - len(piece.lstrip('0123456789'))]) + 3_000_000_000}{piece.lstrip('0123456789')}"
        for piece in data.split("#")[1:]
    )
    (tmp_path / "edition_3.step").write_text(edition_3)
    (tmp_path / "numbered.stp.gz").write_bytes(
        gzip.compress(b"\xef\xbb\xbf" + f"{head}ENDSEC;\nDATA;\n{numbered}ENDSEC;\nEND-ISO-10303-21;\n".encode())
    )
    for name, notes in (("edition_3.step", ["nut.stp"]), ("numbered.stp.gz", [])):
        brep = read_step(tmp_path / name)
        assert (brep.solids, len(brep.faces)) == (1, 7), name
        assert all(any(note in said for said in brep.notes) for note in notes)


def test_a_tessellated_file_needs_no_surface(tmp_path):
    pytest.importorskip("OCP", reason="the CAD kernel (OCP) is not installed")
    (tmp_path / "box.stp").write_text(step_text(box(STRIPS), CENTIMETRES))
    brep = read_step(tmp_path / "box.stp")
    assert (brep.length_unit, brep.solids, brep.faces) == ("cm", 1, ())
    np.testing.assert_allclose(brep.mesh.bounds[1], [40, 30, 20])
