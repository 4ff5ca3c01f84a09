"""The keys that say where the camera may stand, right and wrong."""

from __future__ import annotations

import numpy as np
import pytest

from inspections import POSE_UNCERTAINTY, WHOLE_PIXELS, sections
from viewgauge.exceptions import InspectionFileError
from viewgauge.formats.inspection.inspection_file import read_inspection_file
from viewgauge.part import Mesh, Part
from viewgauge.planning.region import Box, ForbiddenBox, Hemisphere, Standoff

BASE = (
    sections(camera=WHOLE_PIXELS, pose_uncertainty=POSE_UNCERTAINTY, requirement="{accuracy: 0.99, probability: 0.95}")
    + "candidates:\n"
)

PART = Part("part", Mesh(np.eye(3), np.array([[0, 1, 2]])), ())


def read(folder, text):
    path = folder / "inspection.yaml"
    path.write_text(BASE + text)
    return read_inspection_file(path).inspection(PART)


def test_places_are_read(tmp_path):
    options = read(
        tmp_path,
        """\
  box: {lowest: "[-300, -300, 5] mm", highest: "[30, 30, 70] cm"}
  hemisphere: {centre: "[0, 0, 10] mm", axis: [0, 1, 1], radius: 0.6 m}
  forbidden:
    - {lowest: "[0, 0, 0] mm", highest: "[100, 100, 100] mm"}
    - {lowest: "[-9, -9, -9] mm", highest: "[-8, -8, -8] mm"}
  standoff: 2 cm
""",
    ).candidates
    assert options.regions == (
        Box((-300.0, -300.0, 5.0), (300.0, 300.0, 700.0)),
        Hemisphere((0.0, 0.0, 10.0), (0.0, 1.0, 1.0), 600.0),
        ForbiddenBox((0.0,) * 3, (100.0,) * 3),
        ForbiddenBox((-9.0,) * 3, (-8.0,) * 3),
        Standoff(20.0),
    )


def test_nothing_given_is_nothing_asked(tmp_path):
    assert read(tmp_path, "  rolls: 2\n").candidates.regions == ()
    assert read(tmp_path, "  standoff: 0 mm\n").candidates.regions == (Standoff(0.0),), "out of the part all the same"


@pytest.mark.parametrize(
    ("text", "line", "key", "words"),
    [
        ("  box: {lowest: '[0, 0, 0] mm'}\n", 5, "candidates.box.highest", "required key missing"),
        ("  box: {lowest: '[0, 0, 0] mm', highest: '[1, 1, 0] mm'}\n", 5, "candidates.box.highest", "box is empty"),
        ("  box: {lowest: [0, 0, 0], highest: '[1, 1, 1] mm'}\n", 5, "candidates.box.lowest", "unit"),
        ("  box: {lowest: '[0, 0] mm', highest: '[1, 1, 1] mm'}\n", 5, "candidates.box.lowest", "3"),
        ("  box: {lowest: '[0, 0, 0] deg', highest: '[1, 1, 1] mm'}\n", 5, "candidates.box.lowest", "length"),
        ("  box: '[0, 1] mm'\n", 5, "candidates.box", "not a section"),
        (
            "  box: {lower: '[0, 0, 0] mm', highest: '[1, 1, 1] mm'}\n",
            5,
            "candidates.box.lower",
            "did you mean 'lowest'",
        ),
        ("  hemisphere: {axis: [0, 0, 0]}\n", 5, "candidates.hemisphere.axis", "no direction"),
        ("  hemisphere: {axis: '[0, 0, 1] mm'}\n", 5, "candidates.hemisphere.axis", "plain numbers"),
        ("  hemisphere:\n    radius: -3 mm\n", 6, "candidates.hemisphere.radius", "positive"),
        ("  forbidden: {lowest: '[0, 0, 0] mm'}\n", 5, "candidates.forbidden", "a list"),
        (
            "  forbidden:\n    - {lowest: '[0, 0, 0] mm', highest: '[1, 1, 1] mm'}\n    - 7\n",
            7,
            "candidates.forbidden[1]",
            "not a section",
        ),
        ("  standoff: -1 mm\n", 5, "candidates.standoff", "negative"),
        ("  standoff: 3\n", 5, "candidates.standoff", "unit"),
    ],
)
def test_what_is_wrong_is_reported_with_its_place(tmp_path, text, line, key, words):
    with pytest.raises(InspectionFileError) as caught:
        read(tmp_path, text)
    error = caught.value
    assert (error.line, error.key) == (line, key)
    assert words in str(error)
