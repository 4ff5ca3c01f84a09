"""The figures of a measurand that is planned."""

import math

import pytest

import viewgauge as vg
from viewgauge.evaluation import CapabilityRequirement, ConformanceRequirement, Process, capability_figures, spread_mm
from viewgauge.evaluation.segment import image_segment

ZONE = (-0.05, 0.15)


def test_figures_of_a_normal_law_by_hand():
    figures = capability_figures(0.004, ZONE)  # zone 0.2 mm
    assert figures.expanded_uncertainty_mm == pytest.approx(0.008)
    assert figures.percent_p_to_t == pytest.approx(12.0)  # 6 x 0.004 / 0.2
    assert figures.cg == figures.cgk == pytest.approx(0.04 / 0.024)
    assert figures.test_uncertainty_ratio == pytest.approx(12.5)  # 0.2 / (2 x 0.008)
    assert figures.consumer_risk is figures.producer_risk is None


def test_what_the_requirement_states_counts():
    figures = capability_figures(0.004, ZONE, CapabilityRequirement("cgk", 1.33, sigmas=4, share=0.15, bias_mm=0.005))
    assert figures.percent_p_to_t == pytest.approx(8.0)
    assert figures.cg == pytest.approx(0.03 / 0.016)
    assert figures.cgk == pytest.approx(0.01 / 0.008)


def test_risks_are_at_their_limit_where_the_uncertainty_is():
    requirement = ConformanceRequirement("guarded", Process(0.03), producer_risk=0.05)
    figures = capability_figures(requirement.allowed_error_mm(60.0, ZONE) / 2, ZONE, requirement)
    assert figures.producer_risk == pytest.approx(0.05)
    assert 0 < figures.consumer_risk < 1e-3


@pytest.mark.parametrize("tolerance", [None, (0.1, 0.1)])
def test_without_a_tolerance_only_the_uncertainty_is_reported(tolerance):
    figures = capability_figures(0.004, tolerance, ConformanceRequirement("simple", Process(0.03), producer_risk=0.05))
    assert (figures.u_mm, figures.expanded_uncertainty_mm) == (0.004, 0.008)
    assert figures.percent_p_to_t is figures.cg is figures.test_uncertainty_ratio is figures.producer_risk is None


@pytest.mark.parametrize("edge_resolution", [0.0, 0.3, 1.0, 4.0])
@pytest.mark.parametrize("pitch", [(0.00345, 0.00345), (0.003, 0.005)])
def test_a_measurand_meets_the_capability_when_its_figure_says_so(edge_resolution, pitch):
    # the planner's own probability is the oracle: at a tolerance at which the figure is just the required one, the
    # allowed error is kept just as surely as required
    camera = vg.Camera(16, pitch, (2448, 2048), edge_resolution_px=edge_resolution)
    pose_error = vg.PoseError.from_standard_deviations(0.05, 0.2e-3, pivot_mm=(0, 0, -16))
    start, end = (-20.0, -10.0, 350.0), (25.0, 15.0, 360.0)
    length = math.dist(start, end)
    image = image_segment(start, end, camera, pose_error)
    du, dv = (camera.project(end) - camera.project(start)) / pitch
    scale = math.hypot(du, dv) / float(image.length_mm)  # px per mm, along the image
    sigma, angle = float(image.sigma_displacement_mm) * scale, float(image.angle_rad)
    half = spread_mm(sigma, math.hypot(du, dv), angle, length, camera)
    requirement = CapabilityRequirement("cg", 1.33)
    tolerance = (0.0, 2 * 1.33 * half / requirement.share)
    assert capability_figures(0.01, tolerance, requirement, half).cg == pytest.approx(1.33)
    allowed = requirement.allowed_error_mm(length, tolerance)
    reached = vg.success_probability(start, end, camera, pose_error, allowed / length)
    assert reached == pytest.approx(requirement.probability, abs=1e-9)
    if edge_resolution == 0:
        assert half == pytest.approx(3 * sigma / math.hypot(du, dv) * length)
