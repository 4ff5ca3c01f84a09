"""Gauges on the NIST test cases: real parts with semantic PMI, in mm and inch."""

from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from viewgauge.formats.step.kernel_process import read_step
from viewgauge.part.characteristics import derive_dimensions
from viewgauge.part.characteristics.point_pairs import gauge_on_mesh

pytest.importorskip("OCP", reason="the CAD kernel is not installed")

FOLDER = Path(__file__).parents[3] / "shared" / "data" / "nist"
FILES = sorted(FOLDER.glob("nist_ctc_*.stp"))
pytestmark = pytest.mark.skipif(not FILES, reason=f"the NIST files are not in {FOLDER}")

# Dimensions by kind, and the callouts with a value that no gauge can measure.
EXPECTED = {
    "nist_ctc_01": ({"diameter": 7}, {"Angular Size.1"}),
    "nist_ctc_02": ({"diameter": 9}, set()),
    "nist_ctc_03": ({"diameter": 11, "distance": 1}, {"Oriented Linear Dimension.1"}),
    "nist_ctc_04": ({"diameter": 71, "distance": 2}, {"Linear Size.5", "Angular Size.1", "Linear Size.18"}),
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
    return brep, *derive_dimensions(brep)


@pytest.fixture(params=FILES, ids=lambda path: path.stem[:11])
def case(request):
    return request.param.stem[:11], *derived(request.param)


def test_every_callout_is_a_dimension_or_has_a_reason(case):
    name, brep, dimensions, unusable = case
    kinds, without = EXPECTED[name]
    assert Counter(dimension.kind for dimension in dimensions) == kinds
    assert {entry.id for entry in unusable if np.isfinite(entry.nominal_mm)} == without
    assert all(entry.reason for entry in unusable)
    accounted = {entry.id.split("/")[0] for entry in (*dimensions, *unusable)}
    assert accounted == {callout.name for callout in brep.callouts}


def test_gauges_have_the_nominal_length_and_outward_normals(case):
    _, brep, dimensions, _ = case
    for dimension in dimensions:
        assert 1 <= len(dimension.gauges) <= 12
        for gauge in dimension.gauges:
            assert gauge.length_mm == pytest.approx(dimension.nominal_mm, abs=1e-3)
            assert gauge.length_mm == pytest.approx(dimension.gauges[0].length_mm, abs=1e-6)
        assert_normals_agree_with_mesh(brep, dimension.gauges[0])


def assert_normals_agree_with_mesh(brep, gauge):
    on_mesh = gauge_on_mesh(brep.mesh, gauge.start, gauge.end)
    for normals, facets in ((gauge.start_normals, on_mesh.start_normals), (gauge.end_normals, on_mesh.end_normals)):
        # A facet of a curved face may be turned by half the angle that it spans.
        assert ((normals @ facets.T).max(axis=1) > np.cos(np.deg2rad(20))).all()


def test_pattern_of_countersinks_has_one_dimension_per_hole():
    path = FOLDER / "nist_ctc_04_asme1_ap242-e1.stp"
    _, dimensions, _ = derived(path)
    ids = [dimension.id for dimension in dimensions if dimension.id.startswith("Linear Size.17/")]
    assert ids == [f"Linear Size.17/{k}" for k in range(1, 31)]
    centres = [(d.gauges[0].start + d.gauges[0].end) / 2 for d in dimensions if d.id in ids]
    assert len(np.unique(np.round(centres, 3), axis=0)) == 30
    assert [round(c[0], 3) for c in centres] == sorted(round(c[0], 3) for c in centres)
