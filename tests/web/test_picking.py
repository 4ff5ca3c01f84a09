"""Clicks on measurands and cameras find them; clicks beside them find nothing."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("viser")

from viewgauge.jobs.workbench.what_if import WhatIf
from viewgauge.web.picking import picked


@pytest.fixture(scope="module")
def answers(inspection, plan):
    what_if = WhatIf(inspection, plan)
    return what_if.answers(what_if.today)


def ray(eye, at):
    direction = (at - eye) / np.linalg.norm(at - eye)
    return np.asarray(eye, dtype=float), direction


def size_of(inspection):
    return float(np.linalg.norm(np.diff(inspection.part.mesh.bounds, axis=0)))


def test_a_click_on_a_measurand_finds_its_characteristic(answers, inspection):
    eye = np.array([300.0, -400.0, 350.0])
    found = 0
    for answer in answers.characteristics:
        at = 0.3 * answer.measurand.start + 0.7 * answer.measurand.end
        kind, name = picked(answers, size_of(inspection), *ray(eye, at))
        assert kind == "characteristic"
        found += name == answer.characteristic.id  # another measurand may pass by there as closely
    assert found >= 0.7 * len(answers.characteristics)


def test_a_click_on_a_camera_finds_its_viewpoint(answers, inspection):
    for name, T in answers.viewpoints.items():
        eye = T[:3, 3] + [500.0, 200.0, -100.0]
        assert picked(answers, size_of(inspection), *ray(eye, T[:3, 3] + 5 * T[:3, 2])) == ("viewpoint", name)


def test_a_click_beside_everything_finds_nothing(answers, inspection):
    eye = np.array([300.0, -400.0, 350.0])
    assert picked(answers, size_of(inspection), *ray(eye, eye + np.array([0.0, 0.0, 100.0]))) is None
    middle = answers.characteristics[0].measurand.start
    assert picked(answers, size_of(inspection), *ray(eye, 2 * eye - middle)) is None  # behind the eye
