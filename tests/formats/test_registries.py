"""A format from outside the package is found, before those that are known, and leaves again."""

from __future__ import annotations

from contextlib import contextmanager

import numpy as np
import pytest

import viewgauge as vg
from viewgauge.exceptions import PartFileError
from viewgauge.formats.cameras.camera_file import CameraFile
from viewgauge.formats.cameras.camera_formats import CAMERA_FORMATS, read_camera_file
from viewgauge.formats.files.registry import SuffixRegistry
from viewgauge.formats.part_formats import PART_FORMATS, reading_part
from viewgauge.formats.poses.pose_samples_file import SAMPLE_FORMATS, SampleFile, read_pose_samples
from viewgauge.formats.tables.table_store import TABLE_FORMATS, TableLayout, open_table
from viewgauge.measurement import PoseSamples
from viewgauge.part import Mesh, Part


@contextmanager
def registered(registry, format_):
    registry.register(format_)
    try:
        yield
    finally:
        registry.unregister(format_)


class Kind:
    def __init__(self, *suffixes):
        self.suffixes = suffixes


def test_the_latest_of_a_suffix_is_asked_first(tmp_path):
    first, second = Kind(".a", ".b"), Kind(".b")
    registry = SuffixRegistry(first)
    with registered(registry, second):
        assert registry.of(tmp_path / "x.B") is second
        assert registry.suffixes == (".b", ".a")
    assert registry.of(tmp_path / "x.b") is first
    assert registry.of(tmp_path / "b") is None


class Triangle:
    name, suffixes = "a triangle", (".tri",)

    @contextmanager
    def reading(self, path, chord_error_mm, unit):  # noqa: ARG002 - as the protocol has it
        yield lambda: Part(path.stem, Mesh(np.eye(3), np.array([[0, 1, 2]])), ())


def test_a_part_file(tmp_path):
    path = tmp_path / "one.tri"
    with reading_part(path) as finish, pytest.raises(PartFileError, match="is not known") as caught:
        finish()
    assert caught.value.expected == (
        "STEP (.stp, .step, .p21, .stpz, .stp.gz, .step.gz, .p21.gz) or a mesh (.stl, .ply, .obj, .3mf, .glb)"
    )
    with registered(PART_FORMATS, Triangle()), reading_part(path) as finish:
        assert finish().name == "one"


class FirstLine:
    name, described, cannot_say = "first line", "a first line", "anything"

    def recognises(self, document):
        return document.text.startswith("fx fy cx cy:")

    def read(self, document, stated):  # noqa: ARG002 - as the protocol has it
        fx, fy, cx, cy = map(float, document.text.partition(":")[2].split())
        return CameraFile(self.name, (fx, fy), (cx, cy), None, None, None)


def test_a_calibration(tmp_path):
    path = tmp_path / "camera.txt"
    path.write_text("fx fy cx cy: 4 5 1 2\n")
    with pytest.raises(vg.InspectionFileError, match="a Kalibr camchain"):
        read_camera_file(path)
    with registered(CAMERA_FORMATS, FirstLine()):
        assert read_camera_file(path).focal_length_px == (4.0, 5.0)


class Lines:
    suffixes = (".txt",)

    def __init__(self):
        self.chunks = []

    def open(self, path, layout, fingerprint):
        return (path.name, layout, fingerprint)


def test_a_table(tmp_path):
    layout = TableLayout(["v"], ["c"], (), 1)
    with pytest.raises(vg.InputError, match="is not known"):
        open_table(tmp_path / "t.txt", layout)
    with registered(TABLE_FORMATS, Lines()):
        assert open_table(tmp_path / "t.txt", layout, "job") == ("t.txt", layout, "job")


class Zeros:
    suffixes, expected = (".zeros",), "nothing"

    def read(self, document):  # noqa: ARG002 - as the protocol has it
        return SampleFile(PoseSamples(np.zeros((3, 6)), ("a", "b", "c")), "zeros")


def test_samples(tmp_path):
    with pytest.raises(vg.InputError, match="unknown kind of file"):
        read_pose_samples(tmp_path / "s.zeros")
    with registered(SAMPLE_FORMATS, Zeros()):
        assert read_pose_samples(tmp_path / "s.zeros").kind == "zeros"
