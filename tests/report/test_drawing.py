"""Results draw themselves with what is registered, and say so where nothing is."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import plotly.graph_objects as go
import pytest
from test_report import make_plan

import viewgauge as vg
from viewgauge import drawing
from viewgauge.evaluation import MeasurandLaws, as_dataset
from viewgauge.part import Characteristic


def law():
    return vg.errors.TotalError(0.002, 0.00345, 0.3)


def laws():
    camera = vg.Camera(16.0, (0.00345, 0.00345), (2448, 2048))
    pose_error = vg.PoseError.from_standard_deviations(translation_mm=0.1, rotation_rad=3e-4)
    return MeasurandLaws.of_acquisition([[-20.0, 0, 400.0], [20.0, 0, 400.0]], camera, pose_error)


def table():
    columns = {"probability": np.array([[0.97]]), "reason": np.array([[6]])}
    characteristics = [Characteristic("a", "distance", 10.0, None, ())]
    return as_dataset(columns, ["S1"], characteristics, np.array([0.1]), {"required_probability": 0.95}).viewgauge


RESULTS = [make_plan, law, laws, table]


@pytest.mark.parametrize("make", RESULTS)
def test_a_result_draws(make):
    figure = make().plot()
    assert isinstance(figure, go.Figure)
    assert figure.data


@pytest.mark.parametrize("make", RESULTS)
def test_without_registration_it_says_so(make, monkeypatch):
    monkeypatch.setattr(drawing, "_loaders", [])
    with pytest.raises(RuntimeError, match="nothing that draws results is registered: draw_with"):
        make().plot()


@pytest.mark.parametrize("make", [make_plan, law, laws])
def test_words_need_a_registration_too(make, monkeypatch):
    assert "<" in make()._repr_html_()
    monkeypatch.setattr(drawing, "_loaders", [])
    with pytest.raises(RuntimeError, match="nothing that draws results is registered"):
        make()._repr_html_()


def test_what_is_registered_last_draws_and_is_loaded_only_then(monkeypatch):
    class Words:
        def plot(self, result, *_, **__):
            return f"a picture of a {type(result).__name__}"

    loaded = []
    monkeypatch.setattr(drawing, "_loaders", list(drawing._loaders))
    drawing.draw_with(lambda: loaded.append("now") or Words())
    assert not loaded
    assert law().plot() == "a picture of a TotalError"
    assert loaded == ["now"]


def test_a_law_is_computed_without_loading_what_draws():
    code = "import sys, viewgauge as vg; vg.errors.TotalError(0.002, 0.00345, 0.3).std(); print(*sys.modules)"
    modules = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "viewgauge.drawing" in modules
    assert not {"viewgauge.report", "plotly"} & set(modules)
