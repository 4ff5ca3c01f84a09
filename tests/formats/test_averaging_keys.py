"""The keys of several viewpoints: ``averaging`` and ``pose_uncertainty.common``."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import viewgauge as vg
from viewgauge.execution.chunks import EvaluationJob, candidate_grid
from viewgauge.execution.fingerprint import job_fingerprint
from viewgauge.formats.inspection.inspection_file import read_inspection_file
from viewgauge.part import Mesh, Part

PART = Part("part", Mesh(np.eye(3), np.array([[0, 1, 2]])), ())
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "slotted_block"

# the lines are asserted below
FILE = """\
part:
  file: part.step
camera:
  focal_length: 16 mm
  pixel_pitch: 3.45 um
  resolution: [2448, 2048]
pose_uncertainty:
  translation: 0.1 mm
  rotation: 1 mrad
  common:
    translation: "[0.2, 0.3, 0.4] mm"
    rotation: 2 mrad
  frame: {position: "[0, 0, -16] mm"}
averaging:
  viewpoints: 3
requirement:
  error: 0.05 mm
  probability: 0.95
"""
COMMON = '  common:\n    translation: "[0.2, 0.3, 0.4] mm"\n    rotation: 2 mrad\n'
BY_FILE = "  common:\n    covariance: common.yaml\n"
MATRIX = np.diag([0.04, 0.09, 0.16, 4e-6, 4e-6, 4e-6])
OWN = np.diag([0.01] * 3 + [1e-6] * 3)


def read(tmp_path, text):
    path = tmp_path / "inspection.yaml"
    path.write_text(text)
    return read_inspection_file(path)


def averaged_viewpoints(file):
    return file.inspection(PART).averaged_viewpoints


def changed(old, new, base=FILE):
    assert old in base
    return base.replace(old, new)


def written(matrix):
    return "".join(f"- {row}\n" for row in np.asarray(matrix).tolist())


def test_the_two_parts_make_up_the_error_of_an_acquisition(tmp_path):
    file = read(tmp_path, FILE)
    assert averaged_viewpoints(file) == 3
    np.testing.assert_allclose(file.setup.pose_error.common_covariance, MATRIX, rtol=1e-14)
    np.testing.assert_allclose(file.setup.pose_error.repeatability_covariance, OWN, rtol=1e-12)
    np.testing.assert_allclose(file.setup.pose_error.covariance, MATRIX + OWN, rtol=1e-14)
    assert file.setup.pose_error.T_camera_frame[:3, 3].tolist() == [0.0, 0.0, -16.0]
    assert file.other_files == ()


def test_either_part_may_come_from_a_file(tmp_path):
    (tmp_path / "common.yaml").write_text(written(MATRIX))
    file = read(tmp_path, changed(COMMON, BY_FILE))
    np.testing.assert_allclose(file.setup.pose_error.common_covariance, MATRIX, rtol=1e-14)
    assert file.other_files == (tmp_path / "common.yaml",)
    (tmp_path / "own.yaml").write_text(written(OWN))
    both = read(tmp_path, changed("  translation: 0.1 mm\n  rotation: 1 mrad\n", "  covariance: own.yaml\n"))
    np.testing.assert_allclose(both.setup.pose_error.covariance, MATRIX + OWN, rtol=1e-14)
    assert both.other_files == (tmp_path / "own.yaml",)


def test_a_common_part_without_averaging_is_planned_with_the_whole(tmp_path):
    file = read(tmp_path, changed("averaging:\n  viewpoints: 3\n", ""))
    assert averaged_viewpoints(file) == 1
    np.testing.assert_allclose(file.setup.pose_error.covariance, MATRIX + OWN, rtol=1e-14)


def test_without_either_key_nothing_is_said_of_a_common_part(tmp_path):
    file = read(tmp_path, changed("averaging:\n  viewpoints: 3\n", "", changed(COMMON, "")))
    assert (averaged_viewpoints(file), file.setup.pose_error.common_covariance) == (1, None)
    np.testing.assert_allclose(file.setup.pose_error.covariance, OWN, rtol=1e-14)


@pytest.mark.parametrize("which", ["common", "own"])
def test_no_error_may_be_stated_for_either_part(tmp_path, which):
    text = changed(COMMON, "  common: {translation: 0 mm, rotation: 0 deg}\n")
    if which == "own":
        text = changed("  translation: 0.1 mm\n  rotation: 1 mrad\n", "  translation: 0 mm\n  rotation: 0 rad\n")
    error = read(tmp_path, text).setup.pose_error
    part = error.common_covariance if which == "common" else error.repeatability_covariance
    np.testing.assert_array_equal(part, np.zeros((6, 6)))


BAD = [
    # averaging
    (changed("viewpoints: 3", "viewpoints: 1"), 15, "averaging.viewpoints", "greater than or equal to 2"),
    (changed("viewpoints: 3", "viewpoints: 17"), 15, "averaging.viewpoints", "less than or equal to 16"),
    (changed("viewpoints: 3", "viewpoints: 2.5"), 15, "averaging.viewpoints", "a whole number"),
    (changed("viewpoints: 3", "viewpoints: many"), 15, "averaging.viewpoints", "a whole number"),
    (changed("viewpoints: 3", "viewpoints: true"), 15, "averaging.viewpoints", "a whole number"),
    (changed("viewpoints: 3", "viewpoints:"), 15, "averaging.viewpoints", "no value"),
    (changed("viewpoints: 3", "veiwpoints: 3"), 15, "averaging.veiwpoints", "did you mean 'viewpoints'?"),
    (changed("  viewpoints: 3\n", ""), 14, "averaging.viewpoints", "required key missing"),
    (changed("averaging:\n  viewpoints: 3\n", "averaging: 3\n"), 14, "averaging", "not a section"),
    (changed("averaging:", "averageing:"), 14, "averageing", "did you mean 'averaging'?"),
    (changed(COMMON, ""), 7, "pose_uncertainty.common", "helps only against what is drawn anew"),
    (changed(COMMON, ""), 7, "pose_uncertainty.common", "translation: 0 mm and rotation: 0 deg there if there is none"),
    # pose_uncertainty.common
    (changed(COMMON, "  common:\n"), 10, "pose_uncertainty.common", "the section is empty"),
    (changed(COMMON, "  common: 0 mm\n"), 10, "pose_uncertainty.common", "not a section"),
    (changed("    rotation: 2 mrad\n", ""), 10, "pose_uncertainty.common", "required key rotation missing"),
    (
        changed("    rotation: 2 mrad\n", "    covariance: c.yaml\n"),
        11,
        "pose_uncertainty.common.translation",
        "takes the place of",
    ),
    (changed("2 mrad", "2 mm"), 12, "pose_uncertainty.common.rotation", "'mm' is not a unit of angle"),
    (changed("2 mrad", "-2 mrad"), 12, "pose_uncertainty.common.rotation", "must not be negative"),
    (changed("2 mrad", "2"), 12, "pose_uncertainty.common.rotation", "an angle with its unit"),
    (changed("[0.2, 0.3, 0.4] mm", "[0.2, 0.3] mm"), 11, "pose_uncertainty.common.translation", "1 or 3 values"),
    (changed("  frame:", "    frame:"), 13, "pose_uncertainty.common.frame", "unknown key"),
    (changed(COMMON, BY_FILE), 11, "pose_uncertainty.common.covariance", "common.yaml"),
    (changed(COMMON, "  common:\n    covariance: 3\n"), 11, "pose_uncertainty.common.covariance", "text"),
]


@pytest.mark.parametrize(("text", "line", "key", "telling"), BAD)
def test_what_cannot_be_used_is_reported_with_its_place(tmp_path, text, line, key, telling):
    with pytest.raises(vg.InspectionFileError) as caught:
        read(tmp_path, text)
    assert (caught.value.file, caught.value.line, caught.value.key) == (str(tmp_path / "inspection.yaml"), line, key)
    assert telling in str(caught.value)


def test_a_common_file_that_is_no_covariance_is_reported_where_it_is_named(tmp_path):
    (tmp_path / "common.yaml").write_text(written(MATRIX - 0.05 * np.eye(6)))
    with pytest.raises(vg.InspectionFileError, match="negative variance") as caught:
        read(tmp_path, changed(COMMON, BY_FILE))
    assert (caught.value.line, caught.value.key) == (11, "pose_uncertainty.common.covariance")


def test_a_common_file_that_is_no_matrix_is_reported_itself(tmp_path):
    (tmp_path / "common.yaml").write_text("- [1, 2]\n")
    with pytest.raises(vg.InspectionFileError, match="not a 6x6 matrix") as caught:
        read(tmp_path, changed(COMMON, BY_FILE))
    assert caught.value.file == str(tmp_path / "common.yaml")


def test_problems_of_pose_error_and_common_are_reported_together(tmp_path):
    text = changed("rotation: 2 mrad", "rotation: 2 mm", changed("rotation: 1 mrad", "rotation: 1 mm"))
    with pytest.raises(vg.InspectionFileError, match="2 problems") as caught:
        read(tmp_path, text)
    assert "pose_uncertainty.rotation" in str(caught.value)
    assert "pose_uncertainty.common.rotation" in str(caught.value)


def test_the_example_of_the_page_is_read():
    inspection = vg.load(EXAMPLE / "averaging.yaml")
    assert inspection.averaged_viewpoints == 3
    np.testing.assert_allclose(
        np.sqrt(inspection.pose_error.common_covariance.diagonal()), [0.05] * 3 + [np.deg2rad(0.01)] * 3, rtol=1e-9
    )


def fingerprint(inspection):
    characteristics = inspection.part.characteristics
    source = candidate_grid(inspection, characteristics)
    return job_fingerprint(inspection, EvaluationJob.of(inspection, characteristics, source))


def test_a_job_is_known_by_averaged_viewpoints_and_common_part_too(tmp_path):
    shutil.copytree(EXAMPLE, tmp_path / "block")
    path = tmp_path / "block" / "inspection.yaml"
    text = path.read_text()
    assert "  rotation: 0.02 deg\n" in text
    common = "  rotation: 0.02 deg\n  common: {covariance: common.yaml}\n"
    path.write_text(text.replace("  rotation: 0.02 deg\n", common) + "averaging: {viewpoints: 4}\n")
    (path.parent / "common.yaml").write_text(written(MATRIX))
    inspection = vg.load(path)
    assert inspection.averaged_viewpoints == 4
    assert "common.yaml" in inspection.inputs
    pose_error = inspection.pose_error
    others = [
        replace(inspection, averaged_viewpoints=3),
        replace(inspection, pose_error=vg.PoseError(pose_error.covariance, T_camera_frame=pose_error.T_camera_frame)),
        replace(
            inspection,
            pose_error=vg.PoseError(
                pose_error.covariance,
                T_camera_frame=pose_error.T_camera_frame,
                common_covariance=pose_error.common_covariance / 2,
            ),
        ),
    ]
    assert len({fingerprint(other) for other in [inspection, *others]}) == 4
    assert fingerprint(inspection) == fingerprint(replace(inspection))
