"""Pictures and words in notebooks."""

from __future__ import annotations

import numpy as np
import plotly.graph_objects as go
import pytest

import viewgauge as vg
from viewgauge.evaluation import MeasurandLaws, as_dataset
from viewgauge.part import Characteristic, LengthBetweenPoints
from viewgauge.planning.compose import Plan, PlannedCharacteristic, PlannedViewpoint

MEASURAND = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]])


def characteristic(name, status, probability, viewpoint):
    return PlannedCharacteristic(
        name, "measurand", 10.0, (-0.1, 0.1), 0.05, status, probability, 0.99, viewpoint, MEASURAND
    )


@pytest.fixture
def plan():
    T = np.eye(4)
    T[:3, 3] = [0, 0, -200]
    return Plan(
        seed=0,
        viewpoints=(PlannedViewpoint("S1", T, ("good",)),),
        characteristics=(characteristic("good", "met", 0.97, "S1"), characteristic("<poor>", "not_met", 0.61, None)),
        lower_bound=1,
        candidate_count=12,
    )


def test_a_plan_shows_its_measurands_and_cameras(plan):
    figure = plan.plot()
    assert isinstance(figure, go.Figure)
    named = {trace.name for trace in figure.data}
    assert named == {"S1", "✗ not met"}
    cameras = [trace for trace in figure.data if trace.mode == "markers+text"]
    assert [(float(c.x[0]), float(c.y[0]), float(c.z[0])) for c in cameras] == [(0.0, 0.0, -200.0)]


def test_a_plan_in_words(plan):
    html = plan._repr_html_()
    assert "Not met: 1 of 2 characteristics, from 1 viewpoint" in html
    assert html.index("&lt;poor&gt;") < html.index(">good<")  # what is missing first, and escaped
    assert "0.9700" in html
    assert "<poor>" not in html


@pytest.mark.parametrize(
    "law",
    [
        vg.errors.SpatialQuantization(0.00345, 0.3),
        vg.errors.TotalError(0.002, 0.00345, 0.3),
        vg.errors.NormalRatio(0.01, 0.5, 0.2, 400.0),
        vg.errors.AveragedError(0.001, [0.002, 0.001, 0.003]),
    ],
    ids=lambda law: type(law).__name__,
)
def test_a_law_draws_its_density(law):
    (curve,) = law.plot().data
    np.testing.assert_allclose(curve.y, law.pdf(np.array(curve.x)))
    assert np.trapezoid(curve.y, curve.x) == pytest.approx(0.998, abs=2e-3)
    assert f"{float(law.std()):.4g}" in law._repr_html_()


def test_laws_of_arrays_are_drawn_each():
    law = vg.errors.TotalError([0.001, 0.002, 0.004], 0.00345, 0.3)
    curves = law.plot(name="three heads").data
    assert len(curves) == 3
    peaks = [max(curve.y) for curve in curves]
    assert peaks == sorted(peaks, reverse=True)


def test_laws_of_a_characteristic():
    camera = vg.Camera(16.0, (0.00345, 0.00345), (2448, 2048))
    pose_error = vg.PoseError.from_standard_deviations(translation_mm=0.1, rotation_rad=3e-4)
    laws = MeasurandLaws.of_acquisition([[-20.0, 0, 400.0], [20.0, 0, 400.0]], camera, pose_error)
    assert len(laws.plot(0.05).data) == 4
    assert laws.plot(0.05, 0.95).data[-1].y[0] == pytest.approx(float(laws.probability(0.05)))
    assert "40 mm" in laws._repr_html_()


def test_a_table_is_a_map():
    measurand = LengthBetweenPoints(MEASURAND[0], MEASURAND[1], np.eye(3)[:1], np.eye(3)[:1])
    characteristics = [Characteristic(name, "measurand", 10.0, None, (measurand,)) for name in ("a", "b")]
    columns = {"probability": np.array([[0.97, 0.0], [0.4, 0.99]]), "reason": np.array([[6, 5], [6, 6]])}
    table = as_dataset(columns, ["S1", "S2"], characteristics, np.array([0.1, 0.1]), {"required_probability": 0.95})
    (heat,) = table.viewgauge.plot().data
    assert list(heat.x) == ["a", "b"]
    assert list(heat.y) == ["S1", "S2"]
    assert [list(row) for row in heat.z] == [[0.97, None], [0.4, 0.99]]


def test_what_has_no_picture_says_so():
    from viewgauge.report.notebook import plot

    with pytest.raises(TypeError, match="a list has no picture"):
        plot([])
