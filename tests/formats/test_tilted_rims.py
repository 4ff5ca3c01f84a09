"""Holes whose axis leans against the face: the true diameter on the exact rim, whatever the tilt."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from step_texts import plate_with_leaning_hole, write_shape

from viewgauge.formats.step.kernel_process import read_step
from viewgauge.part.brep import PmiRecord, Reference
from viewgauge.part.characteristics import derive_characteristics

pytest.importorskip("OCP", reason="the CAD kernel (OCP) is not installed")


@pytest.mark.parametrize("tilt_deg", [0.02, 1.5, 30.0])  # the kernel's samples of the first are a circle within 0.1 um
def test_the_minor_axis_is_the_diameter(tmp_path, tilt_deg):
    brep = read_step(write_shape(plate_with_leaning_hole(tilt_deg), tmp_path / "plate.step"))
    wall = next(k for k, face in enumerate(brep.faces) if face.kind == "cylinder")
    record = PmiRecord("D", "diameter", "diameter", 8.0, (-0.1, 0.1), (Reference("face", wall),))
    (characteristic,), not_measurable = derive_characteristics(replace(brep, pmi_records=(record,)))
    assert not not_measurable
    tilt = math.radians(tilt_deg)
    axis, above = np.array([math.sin(tilt), 0.0, math.cos(tilt)]), set()
    for measurand in characteristic.measurands:
        assert measurand.length_mm == pytest.approx(8.0, abs=1e-9)
        assert measurand.rim_axis is None  # no circle may be fitted to it
        for point, normals in ((measurand.start, measurand.start_normals), (measurand.end, measurand.end_normals)):
            # on the plane and on the cylinder: on the exact curve
            above.add(round(float(point[2]), 6))
            radial = point - [30.0, 20.0, 5.0]
            assert np.linalg.norm(np.cross(radial, axis)) == pytest.approx(4.0, abs=1e-9)
            # the rim's tangent is perpendicular to the measured direction
            tangent = np.cross([0.0, 0.0, 1.0], np.cross(np.cross(radial, axis), axis))
            across = (measurand.end - measurand.start) / 8.0
            assert abs(tangent @ across) < 1e-6
            assert len(normals) == 2
    assert above == {0.0, 10.0}
