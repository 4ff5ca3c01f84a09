"""Shared cases of the STEP door: forms of the text, tessellated and external geometry, tilted rims, far coordinates."""

from __future__ import annotations

import json
import time

import numpy as np
import pytest
from version_2 import CASES, copy_case

from viewgauge.cli.app import main

pytest.importorskip("OCP", reason="the CAD kernel (OCP) is not installed")
pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason="the shared cases are not beside the checkout")

PLAIN = {"E1": 84.0, "E2": 28.0, "E3": 7.0, "E4": 16.0, "E5/1": 9.0, "E5/2": 9.0}
FEW = {"E1": 84.0, "E5/1": 9.0, "E5/2": 9.0}


@pytest.fixture
def check(tmp_path, capsys):
    """Runs ``check`` with the cases' camera and a part; returns exit code, document and messages."""

    def run(part):
        inspection = copy_case(CASES / "pmi" / "inspection.yaml", tmp_path)
        code = main(["check", str(inspection), "--part", str(CASES / part), "--json"])
        printed = capsys.readouterr()
        return code, json.loads(printed.out), printed.err

    return run


def nominal(document):
    return {entry["id"]: pytest.approx(entry["nominal_mm"]) for entry in document["characteristics"]}


@pytest.mark.parametrize(
    ("part", "expected"),
    [
        ("pmi/byte_order_mark.step", PLAIN),
        ("pmi/compressed.stpz", PLAIN),
        ("pmi/large_record_numbers.step", FEW),
        ("pmi/tilted_rims.step", FEW),
        ("pmi/utf8_names.step", {"E1": 84.0, "Ø9 Bohrung ±/1": 9.0, "Ø9 Bohrung ±/2": 9.0}),
    ],
)
def test_read_whole(check, part, expected):
    code, document, _ = check(part)
    assert code == 0
    assert nominal(document) == expected
    assert all(entry["status"] == "measurable" for entry in document["characteristics"])


def test_tessellated_geometry_is_a_mesh(check):
    code, document, _ = check("pmi/tessellated_only.stp")
    assert code == 0
    np.testing.assert_allclose(document["part"]["size_mm"], [60, 40, 15], atol=1e-9)
    assert document["part"]["triangles"] == 12
    assert any("only tessellated geometry" in note for note in document["part"]["notes"])


def test_external_geometry_is_named(check):
    code, _, messages = check("pmi/external_geometry.step")
    assert code == 2
    assert "external_geometry.step: the geometry is in another file: bolt_m6.stp" in messages


def test_far_coordinates_are_refused_soon(check):
    started = time.monotonic()
    code, _, messages = check("numbers_and_text/huge_coordinates.step")
    assert code == 2
    assert "1e+100" in messages
    assert time.monotonic() - started < 60
