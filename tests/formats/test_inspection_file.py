"""The inspection file: what is read, and what is said about one that cannot be used."""

from pathlib import Path

import numpy as np
import pytest

from viewgauge.evaluation.requirement.allowed_error import Requirement
from viewgauge.exceptions import InspectionFileError
from viewgauge.formats.inspection.inspection_file import CharacteristicEntry, read_inspection_file
from viewgauge.geometry import PoseError
from viewgauge.part import Mesh, Part
from viewgauge.planning.candidates.candidate_options import CandidateOptions
from viewgauge.sensors import Camera
from viewgauge.visibility.limits import ObservationLimits

PART = Part("part", Mesh(np.eye(3), np.array([[0, 1, 2]])), ())

# interface.md, word for word; long lines as there
CONTRACT = """\
part:
  file: slotted_block.step          # STEP AP242 (semantic PMI read), or a mesh (STL/PLY/OBJ; then characteristics are needed)
  characteristics:                       # optional; added to those read from PMI
    - id: E2
      points: [[0, 0, 40], [60, 0, 40]]          # a measurand: two points of the part, part frame
      unit: mm
      tolerance: 0.1 mm             # plus/minus; or [-0.05, 0.1] mm
      observed: ends                # "ends" (both end points seen) or "whole" (the whole segment seen)
camera:
  focal_length: 16 mm
  pixel_pitch: 3.45 um              # or [3.45, 3.45] um
  resolution: [2448, 2048]
  edge_detector: {quantization: 1 px}             # quantization step of the edge detector; 1 px is the paper's; 0.1 px a sub-pixel edge detector
pose_uncertainty:                               # the pose error
  translation: 0.1 mm               # one or three standard deviations
  rotation: 0.02 deg                # one or three
  # or: covariance: pose_error_covariance.yaml (6x6, conventions.md)
  frame: {position: "[0, 0, -16] mm"}             # origin of the frame in which the error acts, in the camera frame; or a full pose T_camera_frame
requirement:
  accuracy: 0.99                    # relative: T = 1 - accuracy;   or  error: 0.05 mm;   or  fraction_of_tolerance: 10 %
  probability: 0.95                 # Th
candidates:                         # optional, sensible defaults from part and camera
  distance: "[300, 600] mm"
  directions: 200
  rolls: 4
  viewpoints: poses.csv               # or explicit viewpoints instead of sampled ones
"""  # noqa: E501

# the lines of each section are asserted below
MINIMAL = """\
part:
  file: part.step
camera:
  focal_length: 16 mm
  pixel_pitch: 3.45 um
  resolution: [2448, 2048]
pose_uncertainty:
  translation: 0.1 mm
  rotation: 0.02 deg
requirement:
  error: 0.05 mm
  probability: 0.95
"""

TWO_ENTRIES = """\
  characteristics:
    - id: A
      points: [[0, 0, 0], [1, 0, 0]]
      unit: mm
    - id: B
      tolerance: 0.1 mm
"""


def read(tmp_path, text):
    path = tmp_path / "inspection.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_inspection_file(path)


def position(file):
    """Of the frame in which the pose error acts, mm, camera frame."""
    return file.setup.pose_error.T_camera_frame[:3, 3].tolist()


def changed(old, new, base=MINIMAL):
    assert old in base
    return base.replace(old, new)


def with_frame(value):
    return changed("pose_uncertainty:\n", f"pose_uncertainty:\n  frame: {value}\n")


def with_characteristics(old="", new=""):
    return changed("camera:\n", TWO_ENTRIES.replace(old, new) + "camera:\n")


def error_of(tmp_path, text):
    with pytest.raises(InspectionFileError) as caught:
        read(tmp_path, text)
    assert caught.value.file == str(tmp_path / "inspection.yaml")
    return caught.value


def test_the_contract_example_is_read_as_written(tmp_path):
    file = read(tmp_path, CONTRACT)
    assert file.path == tmp_path / "inspection.yaml"
    assert file.part_file == tmp_path / "slotted_block.step"
    assert file.characteristics == (
        CharacteristicEntry("E2", ((0.0, 0.0, 40.0), (60.0, 0.0, 40.0)), (-0.1, 0.1), "ends", line=4),
    )
    assert not file.characteristics[0].is_override
    assert file.general_tolerance_mm is None
    assert file.setup.camera == Camera(16, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=1.0)
    expected = PoseError.from_standard_deviations(0.1, np.deg2rad(0.02), pivot_mm=(0, 0, -16))
    np.testing.assert_allclose(file.setup.pose_error.covariance, expected.covariance, rtol=1e-15)  # pi is rounded
    assert position(file) == [0.0, 0.0, -16.0]
    assert file.setup.requirement == Requirement("accuracy", 0.99, 0.95)
    assert file.inspection(PART).candidates == CandidateOptions(distance_mm=(300.0, 600.0), directions=200, rolls=4)
    assert file.viewpoints_file == tmp_path / "poses.csv"
    assert file.other_files == ()
    assert file.setup.limits == ObservationLimits()
    assert file.inspection(PART).seed == 0


def test_the_least_file_takes_the_defaults(tmp_path):
    file = read(tmp_path, MINIMAL)
    assert file.setup.camera == Camera(16, (0.00345, 0.00345), (2448, 2048))
    assert file.inspection(PART).candidates == CandidateOptions()
    assert file.viewpoints_file is None
    assert file.characteristics == ()
    assert position(file) == [0.0, 0.0, 0.0]


def test_every_optional_key(tmp_path):
    text = """\
seed: 7
part:
  characteristics:
    - {id: A, points: ["[0, 0, 40] mm", ["6 cm", 0 mm, '40 mm']], observed: whole}
    - id: PMI/1
      tolerance: "[-0.05, 0.1] mm"
    - id: PMI/2
      observed: whole
  general_tolerance: 100 um
camera:
  focal_length: 1 inch
  pixel_pitch: "[3.45, 3.5] um"
  resolution: "[2448, 2048] px"
  edge_detector: {quantization: 0.1 px}
  principal_point: "[1200, 1000.5] px"
  f_number: 8
  focus_distance: 45 cm
  blur_limit: 2 px
pose_uncertainty:
  translation: "[0.1, 0.2,
                0.3] mm"
  rotation: ["1 mrad", "2 mrad", "3 mrad"]
  frame: {position: "[1, 2, 3] mm", quaternion: [0, 1, 0, 0]}
requirement:
  fraction_of_tolerance: 10 %
  probability: 95 %
candidates:
  distance: 400 mm
  directions: 50
  rolls: 3
  targets: 0
  cone: {axis: [0, 1, 1], half_angle: 180 deg}
  viewpoints: /data/poses.csv
observation:
  margin: 0 px
  minimum_length: 20 px
  grazing_angle: 0.1 rad
"""
    file = read(tmp_path, text)
    assert file.part_file is None
    assert file.characteristics == (
        CharacteristicEntry("A", ((0.0, 0.0, 40.0), (60.0, 0.0, 40.0)), None, "whole", line=4),
        CharacteristicEntry("PMI/1", None, (-0.05, 0.1), None, line=5),
        CharacteristicEntry("PMI/2", None, None, "whole", line=7),
    )
    assert [entry.is_override for entry in file.characteristics] == [False, True, True]
    assert file.general_tolerance_mm == (-0.1, 0.1)
    assert file.setup.camera == Camera(25.4, (0.00345, 0.0035), (2448, 2048), 0.1, (1200.0, 1000.5), 8.0, 450.0, 2.0)
    np.testing.assert_allclose(file.setup.pose_error.covariance, np.diag([0.1, 0.2, 0.3, 0.001, 0.002, 0.003]) ** 2)
    np.testing.assert_array_equal(
        file.setup.pose_error.T_camera_frame, [[1, 0, 0, 1], [0, -1, 0, 2], [0, 0, -1, 3], [0, 0, 0, 1]]
    )
    assert file.setup.requirement == Requirement("fraction_of_tolerance", 0.1, 0.95)
    assert file.inspection(PART).candidates == CandidateOptions(
        (400.0, 400.0), 1, 50, 3, 0, cone_axis=(0.0, 1.0, 1.0), cone_half_angle_rad=np.pi
    )
    assert file.viewpoints_file == Path("/data/poses.csv")
    assert file.setup.limits == ObservationLimits(0.0, 20.0, 0.1)
    assert file.inspection(PART).seed == 7


@pytest.mark.parametrize(
    "value",
    [
        "'[0, 0, -16]mm'  # a comment with [1, 2] mm",
        '["0 mm", "0 mm", "-16 mm"]',
        "[0 mm, 0 mm, -16 mm]",
        '"[0, 0, -16] mm"',
        "'[0, 0, -16] mm'",
        "'[0, 0, -1.6] cm'",
        "'[0 mm, 0 mm, -16 mm]'",
        "\n      '[0, 0,\n       -16] mm'",
        "\n      - 0 mm\n      - 0 mm\n      - -16 mm",
        '"[0, 0, -16000] µm"',
    ],
)
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_forms_of_a_point(tmp_path, value, line_end):
    text = changed("pose_uncertainty:\n", f"pose_uncertainty:\n  frame:\n    position: {value}\n").replace(
        "\n", line_end
    )
    assert position(read(tmp_path, text)) == [0.0, 0.0, -16.0]


@pytest.mark.parametrize("name", ["a [1] b.step", "'x: [1, 2] mm'", '"[1] mm.step"', "it's [1] mm.step", "a#[1] mm"])
def test_text_that_looks_like_a_list_with_unit_stays_as_it_is(tmp_path, name):
    assert read(tmp_path, changed("part.step", name)).part_file == tmp_path / name.strip("'\"")


def test_an_empty_optional_section_is_as_good_as_none(tmp_path):
    text = changed("part:\n  file: part.step\n", "part:\n") + "candidates:\n  # rolls: 2\nobservation:\n"
    file = read(tmp_path, text)
    assert file.part_file is None
    assert file.inspection(PART).candidates == CandidateOptions()


def test_a_repeated_scalar_may_be_an_alias(tmp_path):
    text = changed("translation: 0.1 mm", "translation: &t 0.1 mm").replace("error: 0.05 mm", "error: *t")
    assert read(tmp_path, text).setup.requirement.value == 0.1


def test_byte_order_mark(tmp_path):
    assert read(tmp_path, "\ufeff" + MINIMAL).inspection(PART).seed == 0


BAD_TEXTS = [
    ("", 1, None, "the file is empty"),
    ("# only a comment\n", 1, None, "the file is empty"),
    ("just words\n", 1, None, "not an inspection file"),
    ("- a\n- b\n", 1, None, "not an inspection file"),
    ("ISO-10303-21;\nHEADER;\n", None, None, "STEP file"),
    (b"\x89PNG\r\n\x1a\n\0\0", 1, None, "not UTF-8"),
    (b"a: 1\nb: \xff\n", 2, None, "0xff"),
    ("part:\n  file: a\0b\n", 2, None, "binary"),
    ("part:\n  file: a\x01b\n", 2, None, "control character"),
    (MINIMAL.encode("utf-16"), 1, None, "not UTF-8"),
    (changed("  file: part.step", "  file: part: step"), 2, None, "not valid YAML"),
    (changed("  rotation:", "\trotation:"), 9, None, "not with tabs"),
    (changed("[2448, 2048]", "[2448, 2048"), 7, None, "not valid YAML"),
    (changed("part.step", '"part.step'), 13, None, "not valid YAML"),
    (MINIMAL + "---\na: 1\n", 13, None, "not valid YAML"),
    (changed("part.step", "*nothing"), 2, None, "undefined alias"),
    ("[" * 5000, 1, None, "nested too deeply"),
    (changed("part.step", "!!python/object/apply:os.system [ls]"), 2, "part.file", "tags are not used"),
    (changed("part.step", "!mine x"), 2, "part.file", "tags are not used"),
    (
        changed("part:", "part: &p").replace("camera:\n", "  characteristics: *p\ncamera:\n"),
        3,
        "part.characteristics",
        "alias",
    ),
    (changed("camera:\n", "? [1, 2]\n: 3\ncamera:\n"), 3, None, "a key must be a word"),
    (changed("  file: part.step", "  file: a\n  file: b"), 3, "part.file", "first in line 2"),
    (MINIMAL + "pose_uncertainty:\n  rotation: 1 deg\n", 13, "pose_uncertainty", "first in line 7"),
]

UNQUOTED = 'write a list with its unit in quotes: "[0, 0, -16] mm"'
BAD_LISTS = [
    (with_frame("{position: [0, 0, -16] mm}"), 8, None, UNQUOTED),
    (with_frame("\n    position: [0, 0, -16]mm"), 9, None, UNQUOTED),
    (with_frame("\n    position: [0, 0, -16] mm  # of the flange"), 9, None, UNQUOTED),
    (changed("[2448, 2048]", "[2448, 2048] px"), 6, None, 'write a list with its unit in quotes: "[2448, 2048] px"'),
]

BAD_SECTIONS = [
    (MINIMAL + "color: red\n", 13, "color", "unknown key"),
    (MINIMAL + "observations:\n  margin: 1 px\n", 13, "observations", "did you mean 'observation'?"),
    (changed("camera:", "camra:"), 3, "camra", "did you mean 'camera'?"),
    (changed("focal_length", "focal-length"), 4, "camera.focal-length", "did you mean 'focal_length'?"),
    (changed("  file:", "  fiel:"), 2, "part.fiel", "did you mean 'file'?"),
    (changed("  error: 0.05 mm\n", "  error: 0.05 mm\n  zzz: 1\n"), 12, "requirement.zzz", "one of accuracy, error"),
    (
        "pose_uncertainty:\n  translation: 0 mm\n  rotation: 0 deg\nrequirement: {error: 1 mm, probability: 0.9}\n",
        1,
        "camera",
        "required key missing",
    ),
    (changed("  focal_length: 16 mm\n", ""), 3, "camera.focal_length", "a length, such as 16 mm"),
    (changed("  probability: 0.95\n", ""), 10, "requirement.probability", "required key missing"),
    (
        changed("pose_uncertainty:\n  translation: 0.1 mm\n  rotation: 0.02 deg\n", "pose_uncertainty:\n"),
        7,
        "pose_uncertainty",
        "the section is empty",
    ),
    (
        changed("pose_uncertainty:\n  translation: 0.1 mm\n  rotation: 0.02 deg\n", "pose_uncertainty: 0.1 mm\n"),
        7,
        "pose_uncertainty",
        "not a section",
    ),
    (changed("part:\n  file: part.step\n", "part: part.step\n"), 1, "part", "not a section"),
    (MINIMAL + "candidates: [1]\n", 13, "candidates", "not a section"),
    (MINIMAL + "seed: -1\n", 13, "seed", "greater than or equal to 0"),
    (MINIMAL + "seed: 1.5\n", 13, "seed", "a whole number"),
    (MINIMAL + "seed:\n", 13, "seed", "no value"),
    (changed("part.step", "12"), 2, "part.file", "text"),
    (changed("part.step", "''"), 2, "part.file", "the text is empty"),
]

BAD_CAMERAS = [
    (changed("16 mm", "16"), 4, "camera.focal_length", "the unit is missing"),
    (changed("16 mm", "16 s"), 4, "camera.focal_length", "'s' is not a unit of length"),
    (changed("16 mm", "3 deg"), 4, "camera.focal_length", "a length with its unit, such as 16 mm"),
    (changed("16 mm", ".nan"), 4, "camera.focal_length", "not finite"),
    (changed("16 mm", "nan mm"), 4, "camera.focal_length", "not finite"),
    (changed("16 mm", ".inf mm"), 4, "camera.focal_length", "not finite"),
    (changed("16 mm", "-16 mm"), 4, "camera.focal_length", "must be positive"),
    (changed("16 mm", "0 mm"), 4, "camera.focal_length", "must be positive"),
    (changed("16 mm", "true"), 4, "camera.focal_length", "not a quantity"),
    (changed("16 mm", ""), 4, "camera.focal_length", "no value"),
    (changed("16 mm", "{a: 1}"), 4, "camera.focal_length", "not a quantity"),
    (changed("3.45 um", "3.45 px"), 5, "camera.pixel_pitch", "'px' is not a unit of length"),
    (changed("3.45 um", "'[3, 3, 3] um'"), 5, "camera.pixel_pitch", "1 or 2 values are expected here, not 3"),
    (changed("3.45 um", "'[3, -3] um'"), 5, "camera.pixel_pitch", "must be positive"),
    (changed("2448, 2048", "2448"), 6, "camera.resolution", "[2448, 2048]"),
    (changed("2448, 2048", "2448.5, 2048"), 6, "camera.resolution", "whole numbers"),
    (changed("2448, 2048", "0, 2048"), 6, "camera.resolution", "whole numbers"),
    (changed("2448, 2048", "2448, -1"), 6, "camera.resolution", "whole numbers"),
    (changed("2448, 2048", ".inf, 2048"), 6, "camera.resolution", "whole numbers"),
    (changed("2448, 2048", "2448, .nan"), 6, "camera.resolution", "whole numbers"),
    (changed("[2448, 2048]", "5 MP"), 6, "camera.resolution", "2 values are expected"),
    (changed("[2448, 2048]", "2448"), 6, "camera.resolution", "columns and rows"),
    (
        changed("pose_uncertainty:", "  edge_detector: {quantization: 1}\npose_uncertainty:"),
        7,
        "camera.edge_detector.quantization",
        "1 px",
    ),
    (
        changed("pose_uncertainty:", "  edge_detector: {quantization: -1 px}\npose_uncertainty:"),
        7,
        "camera.edge_detector.quantization",
        "must not be negative",
    ),
    (
        changed("pose_uncertainty:", "  principal_point: 3 px\npose_uncertainty:"),
        7,
        "camera.principal_point",
        "2 values",
    ),
    (changed("pose_uncertainty:", "  blur_limit: 0 px\npose_uncertainty:"), 7, "camera.blur_limit", "must be positive"),
    (
        changed("pose_uncertainty:", "  f_number: 8\npose_uncertainty:"),
        3,
        "camera",
        "an aperture needs a focus distance",
    ),
    (
        changed("pose_uncertainty:", "  focus_distance: 1 m\n  f_number: 0\npose_uncertainty:"),
        8,
        "camera.f_number",
        "a plain number",
    ),
    (
        changed("pose_uncertainty:", "  f_number: 8\n  focus_distance: 5 mm\npose_uncertainty:"),
        8,
        "camera.focus_distance",
        "longer than the focal",
    ),
]

BAD_POSE_ERRORS = [
    (changed("0.02 deg", "0.02"), 9, "pose_uncertainty.rotation", "an angle with its unit, such as 0.02 deg"),
    (changed("0.02 deg", "0.02 mm"), 9, "pose_uncertainty.rotation", "'mm' is not a unit of angle"),
    (changed("0.02 deg", "-0.02 deg"), 9, "pose_uncertainty.rotation", "must not be negative"),
    (changed("0.1 mm", "'[1, 2] mm'"), 8, "pose_uncertainty.translation", "1 or 3 values are expected here, not 2"),
    (changed("  rotation: 0.02 deg\n", ""), 7, "pose_uncertainty", "required key rotation missing"),
    (
        changed("  rotation: 0.02 deg\n", "  covariance: c.yaml\n"),
        8,
        "pose_uncertainty.translation",
        "takes the place of",
    ),
    (
        changed("  translation: 0.1 mm\n  rotation: 0.02 deg\n", "  frame: {position: '[0, 0, 0] mm'}\n"),
        7,
        "pose_uncertainty",
        "required keys translation and rotation missing",
    ),
    (
        with_frame("{position: [0, 0, 1]}"),
        8,
        "pose_uncertainty.frame.position",
        "the unit is missing",
    ),
    (with_frame("{position: '[0, 0] mm'}"), 8, "pose_uncertainty.frame.position", "3 values"),
    (with_frame("{position: '[0, 0, nan] mm'}"), 8, "pose_uncertainty.frame.position", "not finite"),
    (with_frame(""), 8, "pose_uncertainty.frame", "the section is empty"),
    (with_frame("'[0, 0, 1] mm'"), 8, "pose_uncertainty.frame", "not a section"),
    (
        with_frame("\n    position: '[0, 0, 1] mm'\n    quaternion: [1, 0, 0, 1]"),
        10,
        "pose_uncertainty.frame.quaternion",
        "not of unit length",
    ),
    (
        with_frame("\n    position: '[0, 0, 1] mm'\n    quaternion: [1, 0, 0]"),
        10,
        "pose_uncertainty.frame.quaternion",
        "4 plain numbers",
    ),
    (
        with_frame("\n    position: '[0, 0, 1] mm'\n    quaternion: [a, 0, 0, 0]"),
        10,
        "pose_uncertainty.frame.quaternion",
        "plain numbers",
    ),
    (
        with_frame("{position: '[0, 0, 1] mm', quaternion: [.nan, 0, 0, 0]}"),
        8,
        "pose_uncertainty.frame.quaternion",
        "not of unit length",
    ),
]

BAD_REQUIREMENTS = [
    (changed("  error: 0.05 mm\n", ""), 10, "requirement", "exactly one of accuracy, error, fraction_of_tolerance"),
    (changed("  error: 0.05 mm\n", "  error: 0.05 mm\n  accuracy: 0.9\n"), 11, "requirement.error", "more than one"),
    (changed("error: 0.05 mm", "accuracy: 1.5"), 11, "requirement.accuracy", "between 0 and 1"),
    (changed("error: 0.05 mm", "accuracy: 0"), 11, "requirement.accuracy", "must be positive"),
    (changed("error: 0.05 mm", "accuracy: 1 mm"), 11, "requirement.accuracy", "'mm' makes no ratio"),
    (changed("error: 0.05 mm", "error: 5 %"), 11, "requirement.error", "'%' is not a unit of length"),
    (changed("error: 0.05 mm", "fraction_of_tolerance: 10"), 11, "requirement.fraction_of_tolerance", "at most 1"),
    (changed("0.95", "95"), 12, "requirement.probability", "between 0 and 1"),
    (changed("0.95", "1"), 12, "requirement.probability", "between 0 and 1"),
    (changed("0.95", ".nan"), 12, "requirement.probability", "not finite"),
]

CANDIDATES = MINIMAL + "candidates:\n  "
BAD_OPTIONS = [
    (CANDIDATES + "distance: '[600, 300] mm'\n", 14, "candidates.distance", "the nearer distance comes first"),
    (CANDIDATES + "distance: [300, 600]\n", 14, "candidates.distance", "the unit is missing"),
    (CANDIDATES + "distance: -3 mm\n", 14, "candidates.distance", "must be positive"),
    (CANDIDATES + "directions: 0\n", 14, "candidates.directions", "greater than or equal to 1"),
    (CANDIDATES + "directions: 10000000000\n", 14, "candidates.directions", "less than or equal to 1000000"),
    (CANDIDATES + "rolls: many\n", 14, "candidates.rolls", "a whole number"),
    (CANDIDATES + "rolls: true\n", 14, "candidates.rolls", "a whole number"),
    (CANDIDATES + "targets: -1\n", 14, "candidates.targets", "greater than or equal to 0"),
    (CANDIDATES + "viewpoints: [a]\n", 14, "candidates.viewpoints", "text"),
    (CANDIDATES + "cone:\n    axis: [0, 0, 1]\n", 14, "candidates.cone.half_angle", "an angle, such as 60 deg"),
    (CANDIDATES + "cone: {half_angle: 0 deg}\n", 14, "candidates.cone.half_angle", "must be positive"),
    (CANDIDATES + "cone:\n    half_angle: 200 deg\n", 15, "candidates.cone.half_angle", "at most 180 deg"),
    (CANDIDATES + "cone:\n    half_angle: 1 deg\n    axis: [0, 0, 0]\n", 16, "candidates.cone.axis", "no direction"),
    (
        CANDIDATES + "cone:\n    half_angle: 1 deg\n    axis: '[0, 0, 1] mm'\n",
        16,
        "candidates.cone.axis",
        "3 plain numbers",
    ),
    (MINIMAL + "observation:\n  margin: -1 px\n", 14, "observation.margin", "must not be negative"),
    (MINIMAL + "observation:\n  grazing_angle: 2\n", 14, "observation.grazing_angle", "an angle with its unit"),
]

BAD_CHARACTERISTICS = [
    (with_characteristics("id: B", "id: A"), 7, "part.characteristics[1].id", "first in line 4"),
    (with_characteristics("id: A", "id: ''"), 4, "part.characteristics[0].id", "the text is empty"),
    (with_characteristics("id: A", "id: 5"), 4, "part.characteristics[0].id", "in quotes"),
    (with_characteristics("- id: B\n      ", "- "), 7, "part.characteristics[1].id", "required key missing"),
    (
        with_characteristics("[1, 0, 0]", "[0, 0, 0]"),
        5,
        "part.characteristics[0].points",
        "the two points are the same",
    ),
    (with_characteristics(", [1, 0, 0]"), 5, "part.characteristics[0].points", "at least 2 items"),
    (with_characteristics("      tolerance: 0.1 mm\n"), 7, "part.characteristics[1]", "nothing but its id"),
    (with_characteristics("[1, 0, 0]", "[1, 0, .nan]"), 5, "part.characteristics[0].points", "not finite"),
    (with_characteristics("      unit: mm\n"), 5, "part.characteristics[0].points", "with unit: mm beside them"),
    (with_characteristics("unit: mm", "unit: s"), 6, "part.characteristics[0].unit", "'s' is not a unit of length"),
    (
        with_characteristics("      points: [[0, 0, 0], [1, 0, 0]]\n"),
        5,
        "part.characteristics[0].unit",
        "the unit belongs to points",
    ),
    (
        with_characteristics("[1, 0, 0]", "'[1, 0, 0] mm / 2'"),
        5,
        "part.characteristics[0].points",
        "'mm / 2' is not a unit",
    ),
    (with_characteristics("0.1 mm", "0.1"), 8, "part.characteristics[1].tolerance", "the unit is missing"),
    (with_characteristics("0.1 mm", "-0.1 mm"), 8, "part.characteristics[1].tolerance", "must be positive"),
    (with_characteristics("0.1 mm", "'[0.1, -0.1] mm'"), 8, "part.characteristics[1].tolerance", "less than the upper"),
    (
        with_characteristics("0.1 mm", "0.1 mm\n      observed: middle"),
        9,
        "part.characteristics[1].observed",
        "'ends' or 'whole'",
    ),
    (
        with_characteristics("0.1 mm", "0.1 mm\n      tolerence: 1 mm"),
        9,
        "part.characteristics[1].tolerence",
        "'tolerance'?",
    ),
    (changed("camera:\n", "  characteristics: {id: A}\ncamera:\n"), 3, "part.characteristics", "a list"),
    (changed("camera:\n", "  characteristics:\n    - A\ncamera:\n"), 4, "part.characteristics[0]", "not a section"),
    (
        changed("camera:\n", "  characteristics:\n    -\ncamera:\n"),
        4,
        "part.characteristics[0]",
        "the section is empty",
    ),
    (changed("camera:\n", "  general_tolerance: 0 mm\ncamera:\n"), 3, "part.general_tolerance", "must be positive"),
]


@pytest.mark.parametrize(
    ("text", "line", "key", "telling"),
    BAD_TEXTS
    + BAD_LISTS
    + BAD_SECTIONS
    + BAD_CAMERAS
    + BAD_POSE_ERRORS
    + BAD_REQUIREMENTS
    + BAD_OPTIONS
    + BAD_CHARACTERISTICS,
)
def test_a_bad_file_is_reported_with_line_and_key(tmp_path, text, line, key, telling):
    error = error_of(tmp_path, text)
    assert telling in str(error)
    assert (error.line, error.key) == (line, key)


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(InspectionFileError, match="does not exist"):
        read_inspection_file(tmp_path / "none.yaml")
    with pytest.raises(InspectionFileError, match="a folder"):
        read_inspection_file(tmp_path)


def test_all_problems_are_reported_at_once_in_order(tmp_path):
    text = (
        with_characteristics("0.1 mm", "0.1")
        .replace("16 mm", "16 s")
        .replace("  rotation: 0.02 deg", "  rotation: 0.02 deg\n  fraem: '[0, 0, 1] mm'")
        .replace("0.95", "95 %\n  probability: 1")
        + "candidates:\n  rolls: 1.5\n  cone: {half_angle: 60}\n"
    )
    text = text.replace("  resolution: [2448, 2048]\n", "")
    file = str(tmp_path / "inspection.yaml")
    message = str(error_of(tmp_path, text))
    assert message.startswith(f"{file}: 7 problems\n")
    reported = [
        line.removeprefix(f"{file}:").rsplit(": ", 1)[0] for line in message.split("\n") if line.startswith(file)
    ]
    assert reported[1:] == [
        "8:part.characteristics[1].tolerance",
        "9:camera.resolution",
        "10:camera.focal_length",
        "15:pose_uncertainty.fraem",
        "19:requirement.probability",
        "21:candidates.rolls",
        "22:candidates.cone.half_angle",
    ]


IDENTITY = "\n".join(f"- [{', '.join('1' if i == j else '0' for j in range(6))}]" for i in range(6)) + "\n"
COVARIANCE = changed("  translation: 0.1 mm\n  rotation: 0.02 deg\n", "  covariance: c.yaml\n")


def with_covariance(tmp_path, text):
    (tmp_path / "c.yaml").write_text(text)
    return tmp_path


def test_covariance_rows(tmp_path):
    file = read(with_covariance(tmp_path, IDENTITY), COVARIANCE)
    np.testing.assert_array_equal(file.setup.pose_error.covariance, np.eye(6))
    assert file.other_files == (tmp_path / "c.yaml",)


def test_covariance_with_order_and_units(tmp_path):
    rows = "\n".join(f"  - {row}" for row in np.diag([4.0, 5.0, 6.0, 1.0, 2.0, 3.0]).tolist())
    text = f"units: [um, mrad]\norder: rotation first\ncovariance:\n{rows}\n"
    file = read(with_covariance(tmp_path, text), COVARIANCE)
    np.testing.assert_allclose(file.setup.pose_error.covariance, np.diag([1, 2, 3, 4, 5, 6]) * 1e-6, rtol=1e-14)


def test_covariance_with_a_pose(tmp_path):
    text = changed("  covariance: c.yaml\n", "  covariance: c.yaml\n  frame: {position: '[0, 0, 1] mm'}\n", COVARIANCE)
    assert position(read(with_covariance(tmp_path, IDENTITY), text)) == [0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("text", "line", "key", "telling"),
    [
        ("", None, None, "the file is empty"),
        ("- [1, 0\n", 2, None, "not valid YAML"),
        ("12\n", 1, None, "not a 6x6 matrix"),
        (IDENTITY + IDENTITY, 1, None, "12 rows"),
        ("covariance:\n  - [1]\n", 1, "covariance", "1 rows"),
        (IDENTITY.replace("[0, 1, 0, 0, 0, 0]", "[0, 1, 0]"), 2, "[1]", "not a row of six numbers"),
        (IDENTITY.replace("[0, 1, 0, 0, 0, 0]", "[0, 1 mm, 0, 0, 0, 0]"), 2, "[1]", "not six finite numbers"),
        (IDENTITY.replace("[0, 1, 0, 0, 0, 0]", "[0, .nan, 0, 0, 0, 0]"), 2, "[1]", "not six finite numbers"),
        ("order: translation first\n", 1, "covariance", "required key missing"),
        ("covarience: 1\n", 1, "covarience", "did you mean 'covariance'?"),
        ("covariance: 3\nunits: mm\n", 2, "units", "such as [mm, rad]"),
        ("covariance: 3\nunits: [mm, s]\n", 2, "units", "'s' is not a unit of angle"),
        ("covariance: 3\norder: backwards\n", 2, "order", "translation first or rotation first"),
    ],
)
def test_bad_covariance_files_are_reported_in_their_own_lines(tmp_path, text, line, key, telling):
    with_covariance(tmp_path, text)
    with pytest.raises(InspectionFileError) as caught:
        read(tmp_path, COVARIANCE)
    assert caught.value.file == str(tmp_path / "c.yaml")
    assert (caught.value.line, caught.value.key) == (line, key)
    assert telling in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "telling"),
    [
        ("[1, 0", "[-1, 0", "negative variance"),
        ("[1, 0", "[1, 2", "not symmetric"),
        ("[1, 0, 0, 0, 0, 0]\n- [0,", "[1, 2, 0, 0, 0, 0]\n- [2,", "not positive semidefinite"),
    ],
)
def test_a_matrix_that_is_no_covariance(tmp_path, old, new, telling):
    with_covariance(tmp_path, changed(old, new, IDENTITY))
    error = error_of(tmp_path, COVARIANCE)
    assert telling in str(error)
    assert (error.line, error.key) == (8, "pose_uncertainty.covariance")


@pytest.mark.parametrize("name", ["none.yaml", "."])
def test_a_missing_covariance_file_is_reported_where_it_is_named(tmp_path, name):
    error = error_of(tmp_path, changed("c.yaml", name, COVARIANCE))
    assert (error.line, error.key) == (8, "pose_uncertainty.covariance")
