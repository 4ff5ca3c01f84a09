"""Files of poses as robots and other programs write them, each format recognised by its content.

A further format is a class or object like :class:`~viewgauge.formats.poses.pose_file.PoseFormat` in a file of
``kinds/``, and its place in ``POSE_FORMATS``, or ``POSE_FORMATS.register(...)`` from outside.
"""

from __future__ import annotations

import os
from pathlib import Path

from ...exceptions import InputError
from ...geometry import invert
from ..files.registry import Registry
from .kinds.fanuc_columns import FANUC_COLUMNS
from .kinds.fanuc_program import FanucProgram
from .kinds.kuka import KUKA
from .kinds.matrix_rows import MatrixRows
from .kinds.opencv_matrix import OpenCvMatrix
from .kinds.pose_message import PoseMessages
from .kinds.quaternion_columns import ABB, NAMED_QUATERNION
from .kinds.robot_script import RobotScript
from .kinds.roll_pitch_yaw import ROLL_PITCH_YAW
from .kinds.rotation_vector import ROTATION_COLUMNS, UNIVERSAL_ROBOTS
from .kinds.tf_echo import TransformEcho
from .kinds.trajectory import QuaternionRows, Trajectory
from .pose_file import PoseConventions, PoseDocument, PoseFile, PoseFormat

__all__ = ["POSE_FORMATS", "find_pose_format", "is_pose_file", "read_poses"]

POSE_FORMATS: Registry[PoseFormat] = Registry(
    KUKA,
    FANUC_COLUMNS,
    FanucProgram(),
    ABB,
    RobotScript(),
    ROTATION_COLUMNS,
    UNIVERSAL_ROBOTS,
    ROLL_PITCH_YAW,
    Trajectory(),
    NAMED_QUATERNION,
    MatrixRows(),
    QuaternionRows(),
    PoseMessages(),
    TransformEcho(),
    OpenCvMatrix(),
)


def find_pose_format(document: PoseDocument) -> PoseFormat | None:
    """The format of a file, by its content; None if it is of none."""
    return next((format_ for format_ in POSE_FORMATS if format_.recognises(document)), None)


def is_pose_file(path: str | os.PathLike[str]) -> bool:
    """Whether a file holds poses alone, whether or not they can be used: no measured ones, visits or pairs.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    document = PoseDocument(Path(path))
    columns = {name.strip().lower() for name in document.table.header}
    if "pose" in columns or any(name.startswith(("measured_", "actual_")) for name in columns):
        return False
    return find_pose_format(document) is not None


def read_poses(path: str | os.PathLike[str], conventions: PoseConventions | None = None) -> PoseFile:
    """Poses of a file of any of the formats.

    Parameters
    ----------
    conventions
        What the user says of the file.

    Raises
    ------
    InputError
        With file and line: the file is of no format, cannot be used, or does not say what its numbers mean.
    """
    conventions = conventions or PoseConventions()
    document = PoseDocument(Path(path))
    if conventions.kind is None:
        found = find_pose_format(document)
    else:
        found = next((format_ for format_ in POSE_FORMATS if format_.key == conventions.kind), None)
        if found is None:
            known = ", ".join(format_.key for format_ in POSE_FORMATS)
            raise InputError("unknown format of poses", key="--from", got=conventions.kind, expected=known)
        if not found.recognises(document):
            raise InputError("the file is not of this format", file=path, got=found.name, expected=found.form)
    if found is None:
        header = ", ".join(document.table.header[:12])
        first = header or next((line.strip()[:60] for line in document.text.splitlines() if line.strip()), "nothing")
        expected = "; ".join(format_.name for format_ in POSE_FORMATS)
        raise InputError("not a file of poses of a known format", file=path, got=first, expected=expected)
    file = found.read(document, conventions)
    if not conventions.inverse:
        return file
    return PoseFile(file.format, file.names, invert(file.poses), (*file.notes, "inverted, as was said"))
