"""What every gauge of a part must fulfil."""

import numpy as np
import pytest

from viewgauge.part.characteristics import derive_dimensions


def only_dimension(brep):
    dimensions, unusable = derive_dimensions(brep)
    assert not unusable
    (dimension,) = dimensions
    return dimension


def only_reason(brep):
    dimensions, unusable = derive_dimensions(brep)
    assert not dimensions
    (entry,) = unusable
    return entry.reason


def distance_to_edge(point, given_edge):
    start, along = given_edge.points[:-1], np.diff(given_edge.points, axis=0)
    t = np.clip(np.sum((point - start) * along, axis=1) / np.sum(along**2, axis=1), 0, 1)
    return np.linalg.norm(start + t[:, None] * along - point, axis=1).min()


def assert_sound(brep, dimension, value_mm, faces, chord_mm=1e-9):
    """Every gauge has the geometry's length, ends on visible edges of the faces, with unit normals of theirs."""
    edges = [brep.edges[i] for f in faces for i in brep.faces[f].edges]
    visible = [e for e in edges if not e.seam and not e.smooth]
    assert 1 <= len(dimension.gauges) <= 12
    for gauge in dimension.gauges:
        assert gauge.length_mm == pytest.approx(value_mm, abs=1e-6)
        for point, normals in ((gauge.start, gauge.start_normals), (gauge.end, gauge.end_normals)):
            assert min(distance_to_edge(point, e) for e in visible) <= chord_mm
            np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-12)
            assert len(normals) >= 2


def assert_normals_outward(brep, dimension):
    """A little along all the normals at once is outside the part, for convex corners: beyond its hull."""
    corners = np.concatenate([e.points for e in brep.edges])
    for gauge in dimension.gauges:
        for point, normals in ((gauge.start, gauge.start_normals), (gauge.end, gauge.end_normals)):
            for normal in normals:
                assert (corners @ normal).max() <= point @ normal + 1e-6
