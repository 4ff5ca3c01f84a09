"""Files of samples: each kind read to the errors it holds, and everything wrong with one told with its line."""

from __future__ import annotations

import numpy as np
import pytest

from viewgauge.exceptions import InputError
from viewgauge.formats.poses.covariance_file import read_covariance, write_covariance
from viewgauge.formats.poses.pose_samples_file import read_pose_samples
from viewgauge.geometry import PoseError, invert, pose_from_quaternion, quaternion_from_pose
from viewgauge.simulation.full_camera import draw_pose_errors

POSE_ERROR = PoseError.from_standard_deviations(0.1, 3e-4)
POSE = "x,y,z,qw,qx,qy,qz"
MEASURED = ",".join("measured_" + name for name in POSE.split(","))


def commanded(n):
    rng = np.random.default_rng(1)
    q = rng.standard_normal((n, 4))
    return np.array(
        [pose_from_quaternion(p, r / np.linalg.norm(r)) for p, r in zip(rng.uniform(-500, 500, (n, 3)), q, strict=True)]
    )


def cells(pose, scale=1.0):
    return ",".join(repr(float(v)) for v in [*(pose[:3, 3] * scale), *quaternion_from_pose(pose)])


@pytest.fixture
def pairs():
    """Commanded and measured poses of 20 samples, and their errors."""
    poses = commanded(20)
    twist = np.random.default_rng(5).standard_normal((20, 6)) @ POSE_ERROR.factor.T
    return poses, poses @ invert(draw_pose_errors(POSE_ERROR, 20, np.random.default_rng(5))), twist


def written(tmp_path, text, name="samples.csv"):
    path = tmp_path / name
    path.write_text(text)
    return path


def test_poses_commanded_and_measured(tmp_path, pairs):
    poses, measured, errors = pairs
    rows = [f"p{k},{cells(a)},{cells(b)}" for k, (a, b) in enumerate(zip(poses, measured, strict=True))]
    found = read_pose_samples(written(tmp_path, f"id,{POSE},{MEASURED}\n" + "\n".join(rows)))
    assert found.samples.errors == pytest.approx(errors, abs=1e-9)
    assert found.samples.names[3] == "p3"
    assert found.kind == "poses commanded and measured"


def test_metres_where_the_header_says_so(tmp_path, pairs):
    poses, measured, errors = pairs
    header = ",".join(f"{name}_m" if name in ("x", "y", "z") else name for name in POSE.split(","))
    rows = [f"{cells(a, 1e-3)},{cells(b)}" for a, b in zip(poses, measured, strict=True)]
    found = read_pose_samples(written(tmp_path, f"{header},{MEASURED}\n" + "\n".join(rows)))
    assert found.samples.errors == pytest.approx(errors, abs=1e-9)
    assert found.samples.names[0] == "line 2"


def test_repeated_visits(tmp_path, pairs):
    _, measured, _ = pairs
    visited = np.concatenate([measured, measured])
    rows = [f"{k % 20},{cells(pose)}" for k, pose in enumerate(visited)]
    found = read_pose_samples(written(tmp_path, f"pose,{POSE}\n" + "\n".join(rows)))
    assert found.groups == 20
    assert found.samples.repeated
    assert np.abs(found.samples.errors).max() < 1e-8, "twice the same pose has no scatter"


def test_errors_as_they_are_in_any_unit(tmp_path):
    text = "rz_deg,dx_um,dy_mm,dz_m,rx_mrad,ry_rad\n" + "\n".join(f"{k},1000,2,0.003,4,0.005" for k in range(3))
    found = read_pose_samples(written(tmp_path, text))
    assert found.samples.errors[1] == pytest.approx([1, 2, 3, 0.004, 0.005, np.radians(1)])


def yaml_of(joints, poses):
    entries = []
    for k, (pose, values) in enumerate(zip(poses, joints, strict=True)):
        numbers = dict(zip(POSE.split(","), cells(pose, 1e-3).split(","), strict=True))
        body = "".join(f"    {name}: {value}\n" for name, value in numbers.items())
        entries.append(f"'{k}':\n  pose:\n{body}  target_joints: {list(map(float, values))}\n")
    return "".join(entries)


def test_joints_and_measured_poses(tmp_path):
    from measurement.test_serial_arm import poses_of

    joints = np.random.default_rng(2).uniform(-1, 1, (30, 2))
    found = read_pose_samples(written(tmp_path, yaml_of(joints, poses_of(joints)), "log.yaml"))
    assert np.abs(found.samples.errors).max() < 1e-5
    assert found.samples.parameters == 18
    assert "2 joints" in found.kind


GOOD = f"{POSE},{MEASURED}\n0,0,0,1,0,0,0,0,0,0,1,0,0,0\n"


@pytest.mark.parametrize(
    ("name", "text", "telling"),
    [
        ("samples.csv", "", "no samples"),
        ("samples.csv", f"{POSE},{MEASURED}\n", "no samples"),
        ("samples.csv", "a,b\n1,2\n", "columns are not those of samples"),
        ("samples.csv", f"{POSE}\n0,0,0,1,0,0,0\n", "columns are not those of samples"),
        ("samples.csv", GOOD + "0,0,0,1,0,0,0\n", ":3: a row is longer or shorter"),
        ("samples.csv", GOOD.replace("0,0,0,1,0,0,0,0", "0,0,x,1,0,0,0,0", 1), ":2:z: not a finite number"),
        ("samples.csv", GOOD.replace("0,0,0,1,0,0,0,0", "0,0,nan,1,0,0,0,0", 1), ":2:z: not a finite number"),
        ("samples.csv", GOOD.replace("0,0,0,1,0,0,0,0", "0,0,0,0,0,0,0,0", 1), ":2: "),
        ("samples.csv", GOOD.replace("x,y", "x,x", 1), "stands twice"),
        ("samples.csv", f"pose,{POSE}\na,0,0,0,1,0,0,0\n", "visited only once"),
        ("samples.txt", GOOD, "unknown kind of file"),
        ("log.yaml", "", "no samples"),
        ("log.yaml", "a: 1", ":1:a.pose: not a pose"),
        ("log.yaml", "a: {pose: {x: 0, y: 0, z: 0, qw: 1, qx: 0, qy: 0, qz: 0}}\n", "target_joints: no joint"),
        ("log.yaml", "a: [", "not valid YAML"),
        ("log.yaml", yaml_of([[0.0], [0.1, 0.2]], np.tile(np.eye(4), (2, 1, 1))), "not as many joints"),
        ("log.yaml", yaml_of([[0.0], [0.1]], np.tile(np.eye(4), (2, 1, 1))), "too few poses"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_reported(tmp_path, name, text, telling):
    with pytest.raises(InputError) as raised:
        read_pose_samples(written(tmp_path, text, name))
    assert telling in str(raised.value)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        read_pose_samples(tmp_path / "none.csv")


def test_a_covariance_is_read_back_to_the_bit(tmp_path):
    rng = np.random.default_rng(3)
    A = rng.standard_normal((6, 6))
    write_covariance(tmp_path / "head.yaml", A @ A.T, 17, rng.standard_normal(6), {"a: b.csv": "0123"})
    file = read_covariance(tmp_path / "head.yaml")
    assert (file.covariance == A @ A.T).all()
    assert file.degrees_of_freedom == 17


@pytest.mark.parametrize("value", ["2", "-1", "1.5", "many", "true"])
def test_bad_degrees_of_freedom(tmp_path, value):
    write_covariance(tmp_path / "head.yaml", np.eye(6), 17, np.zeros(6), {})
    text = (tmp_path / "head.yaml").read_text().replace("degrees_of_freedom: 17", f"degrees_of_freedom: {value}")
    (tmp_path / "head.yaml").write_text(text)
    with pytest.raises(InputError, match="degrees_of_freedom"):
        read_covariance(tmp_path / "head.yaml")
