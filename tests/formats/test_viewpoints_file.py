"""The file of explicit viewpoints."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from viewgauge.exceptions import InputError, ViewpointsFileError
from viewgauge.formats.poses.viewpoints_file import read_viewpoints, write_viewpoints

HEADER = "id, x, y, z, qw, qx, qy, qz\n"
ROW = "a, 1, 2, 3, 1, 0, 0, 0\n"


def written(tmp_path, content):
    path = tmp_path / "poses.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_reads_ids_and_poses(tmp_path):
    half = math.sqrt(0.5)
    path = written(tmp_path, f"{HEADER}{ROW}b,-4.5,0,1e2,{half!r},0,0,{half!r}\n")
    ids, poses = read_viewpoints(path)
    assert ids == ("a", "b")
    np.testing.assert_array_equal(poses[0], [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])
    quarter_turn_about_z = [[0, -1, 0, -4.5], [1, 0, 0, 0], [0, 0, 1, 100], [0, 0, 0, 1]]
    np.testing.assert_allclose(poses[1], quarter_turn_about_z, atol=1e-15)  # rounding of sqrt(1/2)


@pytest.mark.parametrize(
    "content",
    [
        HEADER + ROW.replace(",", " ,  "),
        HEADER + "\n\n" + ROW + "\n,,,,,,,\n",
        (HEADER + ROW).replace("\n", "\r\n"),
        "\ufeff" + HEADER + ROW,
        "qz,qy,qx,qw,z,y,x,id,remark\n0,0,0,1,3,2,1,a,mine\n",
        HEADER + ROW.replace("a,", '"a",'),
        HEADER + ROW.replace("1, 0, 0, 0", "1.00009, 0, 0, 0"),
    ],
)
def test_accepted_forms(tmp_path, content):
    ids, poses = read_viewpoints(written(tmp_path, content))
    assert ids == ("a",)
    np.testing.assert_array_equal(poses[0, :3, 3], [1, 2, 3])


@pytest.mark.parametrize(
    ("content", "line", "key", "telling"),
    [
        ("", None, None, "the file is empty"),
        ("\n\n", None, None, "the file is empty"),
        (HEADER, None, None, "no viewpoints"),
        ("id,x,y,z,qw,qx,qy\na,1,2,3,1,0,0\n", 1, "qz", "a column is missing"),
        ("\nname,x,y\n", 2, "id, z, qw, qx, qy, qz", "columns are missing"),
        (HEADER.replace(",", ";") + ROW.replace(",", ";"), 1, "id, x, y, z, qw, qx, qy, qz", "by commas"),
        (HEADER.replace("qz", "qz, x") + ROW, 1, "x", "twice"),
        (HEADER + ROW + "b, 1, 2, 3, 1, 0, 0\n", 3, None, "another number of cells"),
        (HEADER + ROW + "b, 1, 2, 3, 1, 0, 0, 0, 9\n", 3, None, "another number of cells"),
        (HEADER + "a, 1, two, 3, 1, 0, 0, 0\n", 2, "y", "two"),
        (HEADER + "a, 1, 2 mm, 3, 1, 0, 0, 0\n", 2, "y", "without its unit"),
        (HEADER + "a, 1, 2, , 1, 0, 0, 0\n", 2, "z", "an empty cell"),
        (HEADER + "a, nan, 2, 3, 1, 0, 0, 0\n", 2, "x", "not a finite number"),
        (HEADER + "a, 1, 2, 3, 1, 0, inf, 0\n", 2, "qy", "not a finite number"),
        (HEADER + "a, 1e999, 2, 3, 1, 0, 0, 0\n", 2, "x", "not a finite number"),
        (HEADER + ROW + "b, 1, 2, 3, 1, 1, 0, 0\n", 3, "qw, qx, qy, qz", "not of unit length"),
        (HEADER + "b, 1, 2, 3, 1.0002, 0, 0, 0\n", 2, "qw, qx, qy, qz", "1.0002"),
        (HEADER + "b, 1, 2, 3, 0, 0, 0, 0\n", 2, "qw, qx, qy, qz", "not of unit length"),
        (HEADER + ROW + ROW, 3, "id", "first in line 2"),
        (HEADER + ROW.replace("a", " "), 2, "id", "the id is empty"),
        (HEADER + '"a, 1, 2, 3, 1, 0, 0, 0\n', 2, None, "not valid CSV"),
        (HEADER.encode() + "ü, 1, 2, 3, 1, 0, 0, 0\n".encode("latin-1"), 2, None, "not UTF-8"),
        ((HEADER + ROW).encode("utf-16"), 1, None, "not UTF-8"),
        (HEADER + "a\0, 1, 2, 3, 1, 0, 0, 0\n", 2, None, "binary"),
    ],
)
def test_bad_files(tmp_path, content, line, key, telling):
    path = written(tmp_path, content)
    with pytest.raises(ViewpointsFileError) as caught:
        read_viewpoints(path)
    assert caught.value.file == str(path)
    assert caught.value.line == line
    assert caught.value.key == key
    assert telling in str(caught.value)


LONG = "b, 1, 2, 3, 1, 1, 0, 0\n"


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (HEADER + ROW + LONG + "c, 1, two, 3, 1, 0, 0, 0\n", 3),
        (HEADER + ROW + LONG + ROW, 3),
        (HEADER + LONG + "c, 1\n", 2),
        (HEADER + "c, 1, two, 3, 1, 0, 0, 0\n" + LONG, 2),
        (HEADER + LONG.replace("b", "a") + LONG, 2),
        ((HEADER + "\n" + ROW + "\n" + LONG).replace("\n", "\r"), 5),
        (HEADER + ROW.replace("a", '"a\nb"') + LONG, 4),
    ],
)
def test_the_first_bad_line_is_reported(tmp_path, content, line):
    with pytest.raises(ViewpointsFileError) as caught:
        read_viewpoints(written(tmp_path, content))
    assert caught.value.line == line


def test_many_rows_are_those_of_each(tmp_path, monkeypatch):
    rng = np.random.default_rng(7)
    quaternions = rng.normal(size=(50, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
    rows = [f"S{k}, {k}, 0, 0, {', '.join(map(repr, q))}\n" for k, q in enumerate(quaternions.tolist())]
    monkeypatch.setattr("viewgauge.formats.poses.viewpoints_file._ROWS_PER_BLOCK", 16)
    ids, poses = read_viewpoints(written(tmp_path, HEADER + "".join(rows)))
    assert ids == tuple(f"S{k}" for k in range(50))
    for row, pose in zip(rows, poses, strict=True):
        np.testing.assert_array_equal(read_viewpoints(written(tmp_path, HEADER + row))[1][0], pose)
    with pytest.raises(ViewpointsFileError) as caught:
        read_viewpoints(written(tmp_path, HEADER + "".join(rows[:40]) + LONG + "".join(rows[40:])))
    assert caught.value.line == 42


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(ViewpointsFileError, match="does not exist"):
        read_viewpoints(tmp_path / "none.csv")
    with pytest.raises(ViewpointsFileError, match="a folder"):
        read_viewpoints(tmp_path)


finite = st.floats(-1e6, 1e6)


@given(
    rows=st.lists(
        st.tuples(
            finite, finite, finite, st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 1e-3)
        ),
        min_size=1,
        max_size=5,
    )
)
def test_round_trip(tmp_path_factory, rows):
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    for T, (x, y, z, q) in zip(poses, rows, strict=True):
        T[:3, :3], T[:3, 3] = Rotation.from_quat(q).as_matrix(), (x, y, z)
    ids = tuple(f'viewpoint, "{k}"' for k in range(len(rows)))
    path = tmp_path_factory.mktemp("viewpoints") / "s.csv"
    write_viewpoints(path, ids, poses)
    read_ids, read_poses = read_viewpoints(path)
    assert read_ids == ids
    np.testing.assert_array_equal(read_poses[:, :3, 3], poses[:, :3, 3])  # exact: every digit is written
    # matrix -> quaternion -> matrix: a few roundings of numbers up to 1
    np.testing.assert_allclose(read_poses, poses, rtol=0, atol=1e-14)


def test_what_cannot_be_written(tmp_path):
    with pytest.raises(InputError, match="one id"):
        write_viewpoints(tmp_path / "s.csv", ["a", "b"], np.eye(4)[None])
    with pytest.raises(InputError, match="not a rotation"):
        write_viewpoints(tmp_path / "s.csv", ["a"], 2 * np.eye(4)[None])
    with pytest.raises(InputError, match="create the folder"):
        write_viewpoints(tmp_path / "none" / "s.csv", ["a"], np.eye(4)[None])
    assert list(tmp_path.iterdir()) == []
