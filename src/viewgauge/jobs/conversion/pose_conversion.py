"""Poses: every format that is read, written as viewpoints."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from ...exceptions import InputError
from ...formats.poses.pose_file import PoseConventions, PoseFile
from ...formats.poses.pose_formats import is_pose_file, read_poses
from ...formats.poses.viewpoints_file import write_viewpoints
from .conversion import Converted

__all__ = ["POSE_MEANINGS", "PoseConversion", "conventions_of", "describe_poses"]

POSE_MEANINGS = ("kind", "unit", "angle", "rotation", "quaternion", "inverse")
"""What a user may say of a file of poses, by the names of the options."""


class PoseConversion:
    """Writes poses as a file of viewpoints."""

    kind: ClassVar[str] = "pose"
    targets: ClassVar[Mapping[str, str]] = {"viewpoints": "viewpoints (CSV: id, x, y, z, qw, qx, qy, qz)"}
    meanings: ClassVar[tuple[str, ...]] = POSE_MEANINGS

    def recognises(self, path: Path) -> bool:
        """Whether the file holds poses, whether or not they can be used."""
        try:
            return is_pose_file(path)
        except InputError:
            return False

    def write(
        self, source: Path, output: Path, target: str, meanings: Mapping[str, str], accept: tuple[str, ...]
    ) -> Converted:
        """Write the poses of a file; raises InputError."""
        del accept
        poses = read_poses(source, conventions_of(meanings))
        write_viewpoints(output, poses.names, poses.poses)
        return Converted(poses.format, self.targets[target], document=describe_poses(poses))


def conventions_of(meanings: Mapping[str, str | bool | None]) -> PoseConventions:
    """What a user said, by the names of the options."""
    said: dict[str, Any] = {name: value for name, value in meanings.items() if value not in (None, "")}
    if "inverse" in said:
        said["inverse"] = str(said["inverse"]).lower() in ("true", "yes", "1")
    return PoseConventions(**said)


def describe_poses(poses: PoseFile) -> dict[str, Any]:
    """As JSON-ready data: mm; each pose as the rows of its matrix."""
    return {
        "format": poses.format,
        "notes": list(poses.notes),
        "names": list(poses.names),
        "poses": poses.poses.tolist(),
        "covariance": None if poses.covariance is None else poses.covariance.tolist(),
    }
