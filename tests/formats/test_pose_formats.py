"""Files of poses that the tests write: each read to the pose it was made from, asked about, or refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from viewgauge.exceptions import InputError
from viewgauge.formats.poses.hand_eye.hand_eye_formats import HAND_EYE_FORMATS
from viewgauge.formats.poses.pose_file import PoseConventions
from viewgauge.formats.poses.pose_formats import POSE_FORMATS, read_poses
from viewgauge.formats.poses.target_section import TARGETS

PAGE = Path(__file__).resolve().parents[2] / "docs" / "howto" / "poses.md"
TURN = Rotation.from_euler("ZYX", [31.0, -12.0, 171.0], degrees=True)
POSITION = np.array([412.5, -83.25, 610.125])
Q = TURN.as_quat()  # x y z w
M = np.block([[TURN.as_matrix(), POSITION[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])


def row(*parts):
    return ",".join(repr(float(v)) for part in parts for v in np.ravel(part))


FORMS = {
    "kuka.csv": ("X;Y;Z;A;B;C\n412,5;-83,25;610,125;31;-12;171\n", {}),
    "kuka_m.csv": (f"x_m,y_m,z_m,A [deg],B [deg],C [deg]\n{row(POSITION / 1e3)},31,-12,171\n", {}),
    "fanuc.csv": (f"x y z w p r\n{row(POSITION, TURN.as_euler('xyz', degrees=True))}\n".replace(",", " "), {}),
    "ur.csv": (f"x,y,z,rx,ry,rz\n{row(POSITION / 1e3, TURN.as_rotvec())}\n", {"kind": "ur"}),
    "script.txt": (f"  movej(a)\nhome = p[{row(POSITION / 1e3, TURN.as_rotvec())}]\n", {}),
    "abb.csv": (f"x,y,z,q1,q2,q3,q4\n{row(POSITION, Q[3], Q[:3])}\n", {}),
    "tum.txt": (f"12.5 {row(POSITION / 1e3, Q)}\n".replace(",", " "), {}),
    "seven.txt": (f"{row(POSITION, Q)}\n", {"quaternion": "xyzw", "unit": "mm"}),
    "rpy.csv": (f"name,x,y,z,roll,pitch,yaw\na,{row(POSITION, TURN.as_euler('xyz', degrees=True))}\n",
                {"unit": "mm", "angle": "deg"}),
    "named.csv": (f"x_m,y_m,z_m,orientation.x,orientation.y,orientation.z,qw\n{row(POSITION / 1e3, Q)}\n", {}),
    "blocks.txt": ("\n".join(" ".join(map(repr, map(float, line))) for line in M) + "\n", {"unit": "mm"}),
    "transposed.txt": (f"{row(M.T)}\n", {"unit": "mm"}),
    "kitti.txt": (f"{row(M[:3])}\n".replace(",", " "), {"unit": "mm"}),
    "transform.yaml": ("header: {frame_id: base}\ntransform:\n"
                       "  translation: {x: 0.4125, y: -0.08325, z: 0.610125}\n"
                       f"  rotation: {{x: {Q[0]}, y: {Q[1]}, z: {Q[2]}, w: {Q[3]}}}\n", {}),
}  # fmt: skip


@pytest.mark.parametrize("name", FORMS)
def test_read(tmp_path, name):
    text, said = FORMS[name]
    (tmp_path / name).write_text(text)
    poses = read_poses(tmp_path / name, PoseConventions(**said)).poses
    np.testing.assert_allclose(poses, M[None], rtol=0, atol=1e-9)
    inverse = read_poses(tmp_path / name, PoseConventions(**said, inverse=True)).poses
    np.testing.assert_allclose(inverse[0] @ M, np.eye(4), rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "telling"),
    [
        ("X,Y,Z,A,B,C\n0.41,0.2,0.3,31,-12,171\n", "--unit m"),
        ("X,Y,Z,A,B,C\n412,200,300,31,-112,171\n", "--rotation"),
        ("X,Y,Z,A,B,C\n412,2,3,.5,.2,3\n412,2,3,.5,.2,3\n412,2,3,.5,.2,3\n", "--angle rad"),
        ("X,Y,Z,A,B,C,force\n412,200,300,31,-12,171,5\n", "force: a column is not used"),
        ("X,Y,Z,A,B,C\n412,200,1e300,31,-12,171\n", ":2:Z: no position"),
        ("X,Y,Z,A,B,C\n412,200\n", "a row is longer or shorter"),
        ("x,y,z,rx,ry,rz\n0.4,0.2,0.3,1,2,0.5\n", "what the angles rx, ry, rz mean"),
        ("1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16\n", "the last row is not 0 0 0 1"),
        (f"{row(POSITION, Q)}\n", "--quaternion xyzw or --quaternion wxyz"),
        ("x,y,z,q1,q2,q3,q4\n400,1,2,0.1,0.2,0.3,0.4\n", ":2: the quaternion is not of unit length"),
        ("what is this\n", "not a file of poses"),
        ("", "not a file of poses"),
    ],
)
def test_asked_or_refused(tmp_path, text, telling):
    (tmp_path / "poses.csv").write_text(text)
    with pytest.raises(InputError) as raised:
        read_poses(tmp_path / "poses.csv")
    assert telling in str(raised.value)


def test_an_echo_whose_two_rotations_differ(tmp_path):
    echo = "- Translation: [0.4, 0.1, 0.3]\n- Rotation: in Quaternion [0, 0, 0, 1]\n  in RPY (degree) [90, 0, 0]\n"
    (tmp_path / "echo.txt").write_text(echo)
    with pytest.raises(InputError, match="two rotations"):
        read_poses(tmp_path / "echo.txt")


def test_the_page_has_every_format():
    page = PAGE.read_text(encoding="utf-8")
    for format_ in POSE_FORMATS:
        assert f"| {format_.name} | `{format_.key}` | {format_.form} | {format_.cannot_say} |" in page
    for pairs in HAND_EYE_FORMATS:
        assert f"| {pairs.name} | {pairs.form} | {pairs.cannot_say} |" in page
    for kind in TARGETS:
        assert f"| `{'`, `'.join(kind.types)}` | `{'`, `'.join(kind.needed)}` |" in page
