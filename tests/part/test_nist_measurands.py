"""Measurands on the NIST test cases: real parts with semantic PMI, in mm and inch."""

from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from viewgauge.formats.step.kernel_process import read_step
from viewgauge.part.characteristics import derive_characteristics
from viewgauge.part.characteristics.point_pairs import measurand_on_mesh

pytest.importorskip("OCP", reason="the CAD kernel is not installed")

FOLDER = Path(__file__).parents[3] / "shared" / "data" / "nist"
FILES = sorted(FOLDER.glob("nist_ctc_*.stp"))
pytestmark = pytest.mark.skipif(not FILES, reason=f"the NIST files are not in {FOLDER}")

# Characteristics by kind, and the PMI records with a value that no measurand can measure.
EXPECTED = {
    "nist_ctc_01": ({"diameter": 7}, {"Angular Size.1"}),
    "nist_ctc_02": ({"diameter": 9}, set()),
    "nist_ctc_03": ({"diameter": 11, "distance": 1}, {"Oriented Linear Dimension.1"}),
    "nist_ctc_04": ({"diameter": 71, "distance": 5}, {"Linear Size.5", "Angular Size.1", "Linear Size.18"}),
    "nist_ctc_05": (
        {"diameter": 1, "distance": 1},
        {
            f"{way} Dimension ({n})"
            for way, n in (("Horizontal", 35), ("Horizontal", 39), ("Vertical", 37), ("Vertical", 41))
        },
    ),
}


@cache
def derived(path):
    brep = read_step(path)
    return brep, *derive_characteristics(brep)


@pytest.fixture(params=FILES, ids=lambda path: path.stem[:11])
def case(request):
    return request.param.stem[:11], *derived(request.param)


def test_every_pmi_record_is_a_characteristic_or_has_a_reason(case):
    name, brep, characteristics, not_measurable = case
    kinds, without = EXPECTED[name]
    assert Counter(characteristic.kind for characteristic in characteristics) == kinds
    assert {entry.id.split("/")[0] for entry in not_measurable if np.isfinite(entry.nominal_mm)} == without
    assert all(entry.reason for entry in not_measurable)
    accounted = {entry.id.split("/")[0] for entry in (*characteristics, *not_measurable)}
    assert accounted == {pmi_record.name for pmi_record in brep.pmi_records}


def test_measurands_have_the_nominal_length_and_outward_normals(case):
    _, brep, characteristics, _ = case
    for characteristic in characteristics:
        assert 1 <= len(characteristic.measurands) <= 12
        for measurand in characteristic.measurands:
            assert measurand.length_mm == pytest.approx(characteristic.nominal_mm, abs=1e-3)
            assert measurand.length_mm == pytest.approx(characteristic.measurands[0].length_mm, abs=1e-6)
        assert_normals_agree_with_mesh(brep, characteristic.measurands[0])


def assert_normals_agree_with_mesh(brep, measurand):
    on_mesh = measurand_on_mesh(brep.mesh, measurand.start, measurand.end)
    for normals, facets in (
        (measurand.start_normals, on_mesh.start_normals),
        (measurand.end_normals, on_mesh.end_normals),
    ):
        # A facet of a curved face may be turned by half the angle that it spans.
        assert ((normals @ facets.T).max(axis=1) > np.cos(np.deg2rad(20))).all()


def test_pattern_of_countersinks_has_one_characteristic_per_hole():
    path = FOLDER / "nist_ctc_04_asme1_ap242-e1.stp"
    _, characteristics, _ = derived(path)
    ids = [characteristic.id for characteristic in characteristics if characteristic.id.startswith("Linear Size.17/")]
    assert ids == [f"Linear Size.17/{k}" for k in range(1, 31)]
    centres = [(d.measurands[0].start + d.measurands[0].end) / 2 for d in characteristics if d.id in ids]
    assert len(np.unique(np.round(centres, 3), axis=0)) == 30
    assert [round(c[0], 3) for c in centres] == sorted(round(c[0], 3) for c in centres)
