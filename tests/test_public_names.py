"""The names that users rely on, and that importing them is light and silent."""

import subprocess
import sys

import pytest

import viewgauge as vg

PUBLIC = [
    "Camera",
    "CandidateOptions",
    "EdgeDetector",
    "Evaluation",
    "ImageSensor",
    "InputError",
    "Inspection",
    "InspectionFileError",
    "Lens",
    "NoCandidateError",
    "PartFileError",
    "Plan",
    "PoseError",
    "Requirement",
    "ViewgaugeError",
    "ViewpointsFileError",
    "check",
    "error_budgets",
    "errors",
    "evaluate",
    "evaluate_into",
    "improve",
    "load",
    "measurand_laws",
    "measure",
    "open_executor",
    "plan",
    "plan_chart",
    "read_plan",
    "simulate",
    "specify",
    "success_probability",
    "validate",
    "write_chart",
    "write_evaluation",
    "write_plan",
]

# the laws of the paper and their companions
LAWS = [
    "Accuracy",
    "AveragedError",
    "IndependentTotalError",
    "MarsagliaForm",
    "NormalRatio",
    "PointDisplacement",
    "SegmentDisplacement",
    "SpatialQuantization",
    "TotalError",
    "covariance_numerator_denominator",
    "edge_point_deviation",
    "ellipse_chord_variance",
    "lambdas",
    "line_end_variance",
    "marsaglia_form",
    "projected_length",
    "projected_length_on_axis",
]


def run_python(code):
    return subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=False)


def test_the_public_names_are_these():
    assert sorted(vg.__all__) == PUBLIC
    assert sorted(vg.errors.__all__) == LAWS


@pytest.mark.parametrize("name", PUBLIC)
def test_each_name_is_there_and_listed(name):
    value = getattr(vg, name)
    assert name in dir(vg)
    assert getattr(vg, name) is value
    if name != "errors":
        assert value.__name__ == name
        assert value.__doc__


def test_the_error_laws_are_there():
    for name in vg.errors.__all__:
        assert getattr(vg.errors, name).__doc__


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match=r"attribute '?plann"):
        _ = vg.plann


def test_importing_all_names_in_a_fresh_interpreter_is_silent():
    result = run_python("import viewgauge as vg\nfor name in vg.__all__: getattr(vg, name)")
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


def test_a_bare_import_loads_nothing_heavy():
    heavy = ("numpy", "scipy", "numba", "xarray", "trimesh", "pydantic", "pint", "OCP", "plotly")
    result = run_python(f"import sys, viewgauge; print(sorted(sys.modules.keys() & set({heavy!r})))")
    assert (result.returncode, result.stdout.strip(), result.stderr) == (0, "[]", "")
