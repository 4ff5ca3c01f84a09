"""Charts draw what the laws say, and colours mean what the legend says."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import viewgauge as vg
from viewgauge.evaluation import MeasurandLaws
from viewgauge.evaluation.error_budget import error_budget
from viewgauge.planning.candidates.direction_map import DirectionMap
from viewgauge.report.charts import accuracy_chart, budget_chart, directions_chart, laws_chart, table_chart
from viewgauge.report.palette import DARK, LIGHT, SOURCE_COLOURS, probability_colour, probability_scale

CAMERA = vg.Camera(16.0, (0.00345, 0.00345), (2448, 2048), 1.0)
POSE_ERROR = vg.PoseError.from_standard_deviations(translation_mm=0.1, rotation_rad=3e-4, pivot_mm=(0, 0, -16))
POINTS = np.array([[-20.0, 3.0, 400.0], [25.0, -8.0, 415.0]])


@pytest.fixture(scope="module")
def laws():
    return MeasurandLaws.of_acquisition(POINTS, CAMERA, POSE_ERROR)


def test_the_laws_are_those_of_the_segment(laws):
    """By the public function, which takes a relative tolerance and shares no scaling with the laws."""
    length = np.linalg.norm(POINTS[1] - POINTS[0])
    for error in (0.01, 0.03, 0.08):
        joint, independent = (
            float(vg.success_probability(*POINTS, CAMERA, POSE_ERROR, error / length, method))
            for method in ("joint", "independent")
        )
        assert float(laws.probability(error)) == pytest.approx(joint, abs=1e-12)
        assert float(laws.independent_probability(error)) == pytest.approx(independent, abs=1e-9)
    variance = laws.displacement.var() + laws.camera.var()
    assert laws.standard_uncertainty_mm**2 == pytest.approx(float(variance), rel=1e-12)


def test_the_mean_of_one_acquisition_is_that_acquisition():
    pose_error = vg.PoseError.from_standard_deviations(translation_mm=0.1, rotation_rad=3e-4, pivot_mm=(0, 0, -16))
    pose_error = vg.PoseError(pose_error.covariance, pivot_mm=(0, 0, -16), common_covariance=np.zeros((6, 6)))
    one, mean = (
        MeasurandLaws.of_acquisition(POINTS, CAMERA, pose_error),
        MeasurandLaws.of_mean(POINTS[None], CAMERA, pose_error),
    )
    four = MeasurandLaws.of_mean(np.repeat(POINTS[None], 4, axis=0), CAMERA, pose_error)
    for error in (0.01, 0.05):
        assert float(mean.probability(error)) == pytest.approx(float(one.probability(error)), abs=1e-9)
    for part in ("total", "displacement", "camera"):
        assert float(getattr(mean, part).std()) == pytest.approx(float(getattr(one, part).std()))
        assert float(getattr(four, part).std()) == pytest.approx(float(getattr(one, part).std()) / 2)


def test_densities_have_an_area_of_one(laws):
    chart = laws_chart("E1", laws, 0.05)
    for curve in chart["data"]:
        if curve["name"].startswith("together, ends"):
            continue  # most of it lies outside the picture
        peak_is_cut = max(curve["y"]) > chart["layout"]["yaxis"]["range"][1]
        if not peak_is_cut:
            assert np.trapezoid(curve["y"], dx=curve["dx"]) == pytest.approx(1, abs=2e-3)


def test_a_law_without_an_error_is_left_out():
    still = vg.PoseError(np.zeros((6, 6)))
    chart = laws_chart("E1", MeasurandLaws.of_acquisition(POINTS, CAMERA, still), 0.05)
    assert "camera pose" not in {curve["name"] for curve in chart["data"]}


def test_the_accuracy_chart_marks_what_is_reached(laws):
    for required, sign in ((0.5, "✓"), (0.999999, "✗")):
        here = accuracy_chart("E1", laws, 0.05, required)["data"][-1]
        assert here["y"] == [pytest.approx(float(laws.probability(0.05)))]
        assert here["x"] == [pytest.approx(100 * (1 - 0.05 / laws.length_mm))]
        assert here["name"].startswith(sign)


def test_shares_of_the_budget_add_to_all():
    budget = error_budget(*POINTS, CAMERA, POSE_ERROR, 0.001)
    chart = budget_chart({"a": budget, "b": budget}, ["b", "a"])
    assert chart["data"][0]["y"] == ["b", "a"]
    assert sum(bar["x"][0] for bar in chart["data"]) == pytest.approx(100, abs=0.01)


def direction_map(directions, probability, reason):
    n = len(directions)
    return DirectionMap(
        "E1",
        np.zeros(3),
        100.0,
        np.asarray(directions, dtype=float),
        np.asarray(probability, dtype=float),
        np.asarray(reason),
        np.tile(np.eye(4), (n, 1, 1)),
    )


def test_the_disc_of_directions_keeps_areas():
    """Of directions that are even on the sphere as many lie within each radius as the area of that disc says."""
    k = np.arange(4000)
    z = 1 - 2 * (k + 0.5) / 4000
    turn = k * np.pi * (3 - np.sqrt(5))
    sphere = np.stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z], axis=1)
    chart = directions_chart(direction_map(sphere, np.full(4000, 0.5), np.full(4000, "")), 0.9)
    drawn = chart["data"][1]
    radius = np.hypot(drawn["x"], drawn["y"])
    assert radius.max() <= 2 + 1e-9
    for r in (0.5, 1.0, 1.5):
        assert (radius < r).mean() == pytest.approx(r**2 / 4, abs=2e-3)


def test_directions_that_are_not_seen_are_reported_apart():
    chart = directions_chart(
        direction_map([[0, 0, 1], [1, 0, 0]], [0.97, 0.0], ["", "facing_away"]), 0.9, {"S1": [0.0, 3.0, 0.0]}
    )
    unseen, seen, cameras = chart["data"]
    assert seen["marker"]["color"] == [0.97]
    assert (unseen["x"], unseen["y"]) == ([pytest.approx(np.sqrt(2), abs=1e-4)], [0.0])
    assert "facing away" in unseen["text"][0]
    assert (cameras["x"][0], cameras["y"][0]) == (0.0, pytest.approx(np.sqrt(2), abs=1e-4))


def test_the_table_shows_what_is_not_seen_as_nothing():
    chart = table_chart(["S1"], ["a", "<b>"], np.array([[0.9, 0.0]]), np.array([["", "occluded"]]), 0.95)
    (heat,) = chart["data"]
    assert heat["z"] == [[0.9, None]]
    assert heat["text"][0][1] == "not seen: occluded"
    assert heat["x"] == ["a", "‹b›"]  # no markup from a file


@pytest.mark.parametrize("dark", [False, True])
def test_charts_are_json_and_have_the_inks_of_their_surroundings(laws, dark):
    theme = DARK if dark else LIGHT
    charts = [
        laws_chart("E1", laws, 0.05, dark=dark),
        accuracy_chart("E1", laws, 0.05, 0.95, dark=dark),
        budget_chart({"E1": error_budget(*POINTS, CAMERA, POSE_ERROR, 0.001)}, dark=dark),
    ]
    for chart in charts:
        assert json.dumps(chart, allow_nan=False)
        assert chart["layout"]["paper_bgcolor"] == theme.paper
        assert chart["layout"]["font"]["color"] == theme.ink


def channels(colour):
    return [int(colour[k : k + 2], 16) for k in (1, 3, 5)]


@given(st.floats(0, 1), st.floats(0.5, 0.9999))
def test_blue_is_met_and_red_is_not(probability, required):
    red, _, blue = channels(probability_colour(probability, required))
    assert (blue > red) == (probability >= required)


@given(st.floats(0, 1), st.floats(0, 1), st.floats(0.5, 0.99))
def test_the_surer_of_those_met_is_darker(one, other, required):
    low, high = sorted((one, other))
    if low >= required:
        assert sum(channels(probability_colour(high, required))) <= sum(channels(probability_colour(low, required)))


@given(st.floats(0.5, 0.9999))
def test_the_scale_of_the_maps_has_the_colours_of_the_measurands(required):
    stops = probability_scale(required)
    assert [stops[0][0], stops[-1][0]] == [0.0, 1.0]
    assert all(a[0] <= b[0] for a, b in pairwise(stops))
    for place, colour in stops:
        if place >= required and place not in (required, 1.0):
            assert channels(colour) == channels(probability_colour(place, required))


def luminance(colour):
    """Relative luminance (WCAG 2.2)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (v / 255 for v in channels(colour))]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


@pytest.mark.parametrize("theme", [LIGHT, DARK], ids=["light", "dark"])
@pytest.mark.parametrize("ink", ["ink", "soft", "good", "bad"])
def test_words_can_be_read(theme, ink):
    """A contrast of 4.5 at least, WCAG 2.2 criterion 1.4.3 (AA), on paper and panel."""
    for ground in (theme.paper, theme.panel):
        high, low = sorted((luminance(getattr(theme, ink)), luminance(ground)), reverse=True)
        assert (high + 0.05) / (low + 0.05) >= 4.5


def test_the_report_has_the_same_inks():
    from viewgauge.report.templating import verbatim

    css = verbatim("page.css")
    light, dark = css.split("@media (prefers-color-scheme: dark)", 1)
    for part, colour in SOURCE_COLOURS.items():
        assert f".part-{part} {{ background: {colour}; }}" in css
    for theme, text in ((LIGHT, light), (DARK, dark)):
        for ink in ("paper", "panel", "ink", "soft", "line", "good", "bad"):
            assert f"--{ink}: {getattr(theme, ink)};" in text
