"""The keys of several looks: ``looks`` and ``head.common``."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import viewgauge as vg
from viewgauge.execution.chunks import EvaluationJob, candidate_grid
from viewgauge.execution.fingerprint import job_fingerprint
from viewgauge.formats.inspection.inspection_file import read_inspection_file

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "slotted_block"

# the lines are asserted below
FILE = """\
part:
  file: part.step
camera:
  focal_length: 16 mm
  pixel_pitch: 3.45 um
  resolution: [2448, 2048]
head:
  translation: 0.1 mm
  rotation: 1 mrad
  common:
    translation: [0.2, 0.3, 0.4] mm
    rotation: 2 mrad
  pivot: [0, 0, -16] mm
looks:
  most: 3
requirement:
  error: 0.05 mm
  probability: 0.95
"""
COMMON = "  common:\n    translation: [0.2, 0.3, 0.4] mm\n    rotation: 2 mrad\n"
BY_FILE = "  common:\n    covariance: common.yaml\n"
MATRIX = np.diag([0.04, 0.09, 0.16, 4e-6, 4e-6, 4e-6])
OWN = np.diag([0.01] * 3 + [1e-6] * 3)


def read(tmp_path, text):
    path = tmp_path / "inspection.yaml"
    path.write_text(text)
    return read_inspection_file(path)


def changed(old, new, base=FILE):
    assert old in base
    return base.replace(old, new)


def written(matrix):
    return "".join(f"- {row}\n" for row in np.asarray(matrix).tolist())


def test_the_two_parts_make_up_the_error_of_a_look(tmp_path):
    file = read(tmp_path, FILE)
    assert file.looks == 3
    np.testing.assert_allclose(file.head.common_covariance, MATRIX, rtol=1e-14)
    np.testing.assert_allclose(file.head.repeatability_covariance, OWN, rtol=1e-12)
    np.testing.assert_allclose(file.head.covariance, MATRIX + OWN, rtol=1e-14)
    assert file.head.pivot_mm == (0.0, 0.0, -16.0)
    assert file.common_covariance_file is None


def test_either_part_may_come_from_a_file(tmp_path):
    (tmp_path / "common.yaml").write_text(written(MATRIX))
    file = read(tmp_path, changed(COMMON, BY_FILE))
    np.testing.assert_allclose(file.head.common_covariance, MATRIX, rtol=1e-14)
    assert file.common_covariance_file == tmp_path / "common.yaml"
    assert file.covariance_file is None
    (tmp_path / "own.yaml").write_text(written(OWN))
    both = read(tmp_path, changed("  translation: 0.1 mm\n  rotation: 1 mrad\n", "  covariance: own.yaml\n"))
    np.testing.assert_allclose(both.head.covariance, MATRIX + OWN, rtol=1e-14)
    assert both.covariance_file == tmp_path / "own.yaml"


def test_a_common_part_without_looks_is_planned_with_the_whole(tmp_path):
    file = read(tmp_path, changed("looks:\n  most: 3\n", ""))
    assert file.looks == 1
    np.testing.assert_allclose(file.head.covariance, MATRIX + OWN, rtol=1e-14)


def test_without_either_key_nothing_is_said_of_a_common_part(tmp_path):
    file = read(tmp_path, changed("looks:\n  most: 3\n", "", changed(COMMON, "")))
    assert (file.looks, file.head.common_covariance) == (1, None)
    np.testing.assert_allclose(file.head.covariance, OWN, rtol=1e-14)


@pytest.mark.parametrize("head", ["common", "own"])
def test_no_error_may_be_stated_for_either_part(tmp_path, head):
    text = changed(COMMON, "  common: {translation: 0 mm, rotation: 0 deg}\n")
    if head == "own":
        text = changed("  translation: 0.1 mm\n  rotation: 1 mrad\n", "  translation: 0 mm\n  rotation: 0 rad\n")
    error = read(tmp_path, text).head
    part = error.common_covariance if head == "common" else error.repeatability_covariance
    np.testing.assert_array_equal(part, np.zeros((6, 6)))


BAD = [
    # looks
    (changed("most: 3", "most: 1"), 15, "looks.most", "greater than or equal to 2"),
    (changed("most: 3", "most: 17"), 15, "looks.most", "less than or equal to 16"),
    (changed("most: 3", "most: 2.5"), 15, "looks.most", "a whole number"),
    (changed("most: 3", "most: many"), 15, "looks.most", "a whole number"),
    (changed("most: 3", "most: true"), 15, "looks.most", "a whole number"),
    (changed("most: 3", "most:"), 15, "looks.most", "no value"),
    (changed("most: 3", "mots: 3"), 15, "looks.mots", "did you mean 'most'?"),
    (changed("  most: 3\n", ""), 14, "looks.most", "required key missing"),
    (changed("looks:\n  most: 3\n", "looks: 3\n"), 14, "looks", "not a section"),
    (changed("looks:", "lookss:"), 14, "lookss", "did you mean 'looks'?"),
    (changed(COMMON, ""), 7, "head.common", "helps only against what is drawn anew"),
    (changed(COMMON, ""), 7, "head.common", "translation: 0 mm and rotation: 0 deg there if there is none"),
    # head.common
    (changed(COMMON, "  common:\n"), 10, "head.common", "the section is empty"),
    (changed(COMMON, "  common: 0 mm\n"), 10, "head.common", "not a section"),
    (changed("    rotation: 2 mrad\n", ""), 10, "head.common", "required key rotation missing"),
    (
        changed("    rotation: 2 mrad\n", "    covariance: c.yaml\n"),
        11,
        "head.common.translation",
        "takes the place of",
    ),
    (changed("2 mrad", "2 mm"), 12, "head.common.rotation", "'mm' is not a unit of angle"),
    (changed("2 mrad", "-2 mrad"), 12, "head.common.rotation", "must not be negative"),
    (changed("2 mrad", "2"), 12, "head.common.rotation", "an angle with its unit"),
    (changed("[0.2, 0.3, 0.4] mm", "[0.2, 0.3] mm"), 11, "head.common.translation", "1 or 3 values"),
    (changed("  pivot:", "    pivot:"), 13, "head.common.pivot", "unknown key"),
    (changed(COMMON, BY_FILE), 11, "head.common.covariance", "common.yaml"),
    (changed(COMMON, "  common:\n    covariance: 3\n"), 11, "head.common.covariance", "text"),
]


@pytest.mark.parametrize(("text", "line", "key", "telling"), BAD)
def test_what_cannot_be_used_is_told_with_its_place(tmp_path, text, line, key, telling):
    with pytest.raises(vg.InspectionFileError) as caught:
        read(tmp_path, text)
    assert (caught.value.file, caught.value.line, caught.value.key) == (str(tmp_path / "inspection.yaml"), line, key)
    assert telling in str(caught.value)


def test_a_common_file_that_is_no_covariance_is_told_where_it_is_named(tmp_path):
    (tmp_path / "common.yaml").write_text(written(MATRIX - 0.05 * np.eye(6)))
    with pytest.raises(vg.InspectionFileError, match="negative variance") as caught:
        read(tmp_path, changed(COMMON, BY_FILE))
    assert (caught.value.line, caught.value.key) == (11, "head.common.covariance")


def test_a_common_file_that_is_no_matrix_is_told_itself(tmp_path):
    (tmp_path / "common.yaml").write_text("- [1, 2]\n")
    with pytest.raises(vg.InspectionFileError, match="not a 6x6 matrix") as caught:
        read(tmp_path, changed(COMMON, BY_FILE))
    assert caught.value.file == str(tmp_path / "common.yaml")


def test_problems_of_head_and_common_are_told_together(tmp_path):
    text = changed("rotation: 2 mrad", "rotation: 2 mm", changed("rotation: 1 mrad", "rotation: 1 mm"))
    with pytest.raises(vg.InspectionFileError, match="2 problems") as caught:
        read(tmp_path, text)
    assert "head.rotation" in str(caught.value)
    assert "head.common.rotation" in str(caught.value)


def test_the_example_of_the_page_is_read():
    inspection = vg.load(EXAMPLE / "looks.yaml")
    assert inspection.looks == 3
    np.testing.assert_allclose(
        np.sqrt(inspection.head.common_covariance.diagonal()), [0.05] * 3 + [np.deg2rad(0.01)] * 3, rtol=1e-9
    )


def fingerprint(inspection):
    dimensions = inspection.part.dimensions
    source = candidate_grid(inspection, dimensions)
    return job_fingerprint(inspection, EvaluationJob.of(inspection, dimensions, source))


def test_a_job_is_known_by_looks_and_common_part_too(tmp_path):
    shutil.copytree(EXAMPLE, tmp_path / "block")
    path = tmp_path / "block" / "inspection.yaml"
    text = path.read_text()
    assert "  rotation: 0.02 deg\n" in text
    common = "  rotation: 0.02 deg\n  common: {covariance: common.yaml}\n"
    path.write_text(text.replace("  rotation: 0.02 deg\n", common) + "looks: {most: 4}\n")
    (path.parent / "common.yaml").write_text(written(MATRIX))
    inspection = vg.load(path)
    assert inspection.looks == 4
    assert "common.yaml" in inspection.inputs
    head = inspection.head
    others = [
        replace(inspection, looks=3),
        replace(inspection, head=vg.PoseError(head.covariance, T_camera_head=head.T_camera_head)),
        replace(
            inspection,
            head=vg.PoseError(
                head.covariance, T_camera_head=head.T_camera_head, common_covariance=head.common_covariance / 2
            ),
        ),
    ]
    assert len({fingerprint(other) for other in [inspection, *others]}) == 4
    assert fingerprint(inspection) == fingerprint(replace(inspection))
