"""What every measurand of a part must fulfil."""

import numpy as np
import pytest

from viewgauge.part.characteristics import derive_characteristics


def only_characteristic(brep):
    characteristics, not_measurable = derive_characteristics(brep)
    assert not not_measurable
    (characteristic,) = characteristics
    return characteristic


def only_reason(brep):
    characteristics, not_measurable = derive_characteristics(brep)
    assert not characteristics
    (entry,) = not_measurable
    return entry.reason


def distance_to_edge(point, given_edge):
    start, along = given_edge.points[:-1], np.diff(given_edge.points, axis=0)
    t = np.clip(np.sum((point - start) * along, axis=1) / np.sum(along**2, axis=1), 0, 1)
    return np.linalg.norm(start + t[:, None] * along - point, axis=1).min()


def assert_sound(brep, characteristic, value_mm, faces, chord_mm=1e-9):
    """Every measurand has the geometry's length, ends on visible edges of the faces, with unit normals of theirs."""
    edges = [brep.edges[i] for f in faces for i in brep.faces[f].edges]
    visible = [e for e in edges if not e.seam and not e.smooth]
    assert 1 <= len(characteristic.measurands) <= 12
    for measurand in characteristic.measurands:
        assert measurand.length_mm == pytest.approx(value_mm, abs=1e-6)
        for point, normals in ((measurand.start, measurand.start_normals), (measurand.end, measurand.end_normals)):
            assert min(distance_to_edge(point, e) for e in visible) <= chord_mm
            np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-12)
            assert len(normals) >= 2


def assert_normals_outward(brep, characteristic):
    """A little along all the normals at once is outside the part, for convex corners: beyond its hull."""
    corners = np.concatenate([e.points for e in brep.edges])
    for measurand in characteristic.measurands:
        for point, normals in ((measurand.start, measurand.start_normals), (measurand.end, measurand.end_normals)):
            for normal in normals:
                assert (corners @ normal).max() <= point @ normal + 1e-6
