"""What is proven of an not met characteristic, in words and numbers, for cases whose answer is known."""

import re

import numpy as np
import pytest
from bounded_regions import Shell, characteristic, measurand, probabilities, random_poses
from hypothesis import example, given
from hypothesis import strategies as st

from viewgauge.evaluation import Requirement, Setup
from viewgauge.geometry import PoseError
from viewgauge.planning.bounds import Budget, Certificate, certify
from viewgauge.planning.bounds.branch_and_bound import Bound
from viewgauge.planning.bounds.certificate import _cause, _remains
from viewgauge.planning.cause import proof_sentence
from viewgauge.sensors import Camera
from viewgauge.visibility import ObservationLimits

CAMERA = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=0.1)
LIMITS = ObservationLimits()
REQUIREMENT = Requirement("accuracy", 0.999, 0.95)
REGION = Shell(250.0, 450.0)
ON_TOP = characteristic("D", measurand((-10, 0, 0), (10, 0, 0), [[0, 0, 1]]))
NO_ERROR = PoseError(np.zeros((6, 6)))

ALONG, SMALL = PoseError.from_standard_deviations(2.0, 0.0), PoseError.from_standard_deviations(0.02, 1e-5)


def test_pose_error_alone_is_named():
    # along the axis 2 mm of 450 mm are 0.44 %, of which the depth alone takes the length: 2 Phi(0.225) - 1 = 0.178
    certificate = certify(ON_TOP, Setup(CAMERA, ALONG, REQUIREMENT, LIMITS), REGION)
    assert certificate.proven
    assert certificate.characteristic_id == "D"
    assert certificate.cause.startswith("the pose error alone prevents it: even with an ideal edge detector at most 0.")
    assert 0.178 < certificate.upper_bound < 0.25


def test_pixels_alone_are_named():
    # in the middle of the image 20 mm are 371 px at 250 mm: of a whole pixel 0.371 are allowed, P = 1 - (1 - 0.371)^2 =
    # 0.604; in its corner, 18 deg off the axis, an image is up to a tenth longer, which gives 0.65
    coarse = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=1.0)
    certificate = certify(ON_TOP, Setup(coarse, NO_ERROR, REQUIREMENT, LIMITS), REGION)
    assert certificate.proven
    assert certificate.cause.startswith("the pixels alone prevent it: even without pose error at most 0.")
    assert 0.604 < certificate.upper_bound < 0.72


def test_the_bound_in_words_is_not_below_the_one_in_numbers():
    certificate = certify(ON_TOP, Setup(CAMERA, ALONG, REQUIREMENT, LIMITS), REGION)
    said = float(re.search(r"at most (\d\.\d+)", certificate.cause).group(1))
    poses = random_poses(np.random.default_rng(1), REGION, (0, 0, 0), 20.0, 3000)
    ideal = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=0.0)
    pose_error = ALONG
    assert probabilities(poses, ON_TOP, 0.02, ideal, pose_error, LIMITS).max() <= said


def test_what_a_pose_meets_is_not_called_not_met():
    certificate = certify(ON_TOP, Setup(CAMERA, SMALL, REQUIREMENT, LIMITS), REGION)
    assert not certificate.proven
    assert certificate.upper_bound >= 0.95
    assert certificate.cause.startswith("not excluded")


def test_a_search_cut_short_says_so():
    pose_error = PoseError.from_standard_deviations(0.5, 1e-4)
    certificate = certify(ON_TOP, Setup(CAMERA, pose_error, REQUIREMENT, LIMITS), REGION, budget=Budget(boxes=2))
    assert not certificate.proven
    assert certificate.cause.startswith("not decided")
    assert certificate.cause.endswith("where 0.95 is required")


@pytest.mark.parametrize(
    ("measured", "region"),
    [
        (characteristic("D", measurand((-10, 0, 0), (10, 0, 0), [[0, 0, -1]])), Shell(250.0, 450.0, above=50.0)),
        # the ends are on faces turned away from each other: within the region no eye sees both
        (characteristic("D", measurand((-10, 0, 0), (10, 0, 0), [[-1, 0, 0]], [[1, 0, 0]])), REGION),
        (ON_TOP, Shell(250.0, 450.0, above=500.0)),
        (ON_TOP, Shell(250.0, -450.0)),
    ],
    ids=["below", "back to back", "no region", "bounds that exclude each other"],
)
def test_faces_turned_to_no_allowed_eye(measured, region):
    certificate = certify(measured, Setup(CAMERA, NO_ERROR, REQUIREMENT, LIMITS), region)
    assert certificate.proven
    assert certificate.upper_bound == 0.0
    assert "turned to the camera" in certificate.cause


def test_measurands_of_several_lengths_are_bounded_together():
    pose_error = PoseError.from_standard_deviations(0.4, 1e-4)
    both = characteristic(
        "D", measurand((-10, 0, 0), (10, 0, 0), [[0, 0, 1]]), measurand((-30, 5, 0), (30, 5, 0), [[0, 0, 1]])
    )
    certificate = certify(both, Setup(CAMERA, pose_error, Requirement("error", 0.02, 0.95), LIMITS), REGION)
    poses = random_poses(np.random.default_rng(2), REGION, (0, 0, 0), 20.0, 4000)
    assert probabilities(poses, both, 0.02, CAMERA, pose_error, LIMITS).max() <= certificate.upper_bound


def test_a_characteristic_without_allowed_error_is_refused():
    basic = characteristic("D", measurand((-10, 0, 0), (10, 0, 0)))
    basic = type(basic)(basic.id, basic.kind, basic.nominal_mm, None, basic.measurands)
    with pytest.raises(ValueError, match="no tolerance"):
        certify(basic, Setup(CAMERA, NO_ERROR, Requirement("fraction_of_tolerance", 0.1, 0.95), LIMITS), REGION)


FIGURE = r"(\d\.\d{4})"


@given(st.floats(0, 1))
@example(0.94836)
@example(0.948301)
@example(0.9483)
@example(0.0)
@example(1e-9)
@example(1.0)
def test_what_is_printed_of_an_upper_bound_is_one_too_and_near_it(upper):
    """Rounded up to four digits wherever a sentence tells it: 0.94836 is at most 0.9484, never 0.9483."""
    bound = Bound(upper, 0.0, 1, None)
    sentences = [
        proof_sentence(Certificate("D", upper, True, "no cause"), 7),
        _cause(bound, bound, 1.1),  # of the pose error and of the pixels
        _remains(bound, 0.95),
    ]
    reported = [float(words) for sentence in sentences for words in re.findall(f"at most {FIGURE}", sentence)]
    assert len(reported) == 4
    assert all(upper - 1e-15 <= said < upper + 1.0001e-4 for said in reported)


@given(st.floats(0, 1))
@example(0.94836)
@example(0.948399)
@example(0.9483)
@example(1.0)
def test_what_is_printed_of_a_probability_that_a_pose_has_is_reached(found):
    """Rounded down to four digits: a lower bound of what is possible stays one."""
    said = float(re.search(f"occlusion apart, {FIGURE}", _remains(Bound(1.0, found, 1, None), 0.0)).group(1))
    assert found - 1.0001e-4 < said <= found + 1e-15
