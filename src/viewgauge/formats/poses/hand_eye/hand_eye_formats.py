"""Files of hand-eye samples, each format recognised by its content."""

from __future__ import annotations

from pathlib import Path

from ....exceptions import InputError
from ...files.registry import Registry
from ..pose_file import PoseDocument
from .hand_eye_file import HandEyeFile, HandEyeFormat
from .matrix_pairs import MatrixPairs
from .transform_pairs import TransformPairs

__all__ = ["HAND_EYE_FORMATS", "is_hand_eye_file", "read_hand_eye"]

HAND_EYE_FORMATS: Registry[HandEyeFormat] = Registry(TransformPairs(), MatrixPairs())


def is_hand_eye_file(path: Path) -> bool:
    """Whether a YAML file holds pairs of poses; raises InputError where it cannot be read."""
    if path.suffix.lower() not in (".yaml", ".yml", ".json"):
        return False
    document = PoseDocument(path)
    return any(format_.recognises(document) for format_ in HAND_EYE_FORMATS)


def read_hand_eye(path: Path) -> HandEyeFile:
    """The pairs of a file of any of the formats; raises InputError where it is of none or cannot be used."""
    document = PoseDocument(path)
    found = next((format_ for format_ in HAND_EYE_FORMATS if format_.recognises(document)), None)
    if found is None:
        expected = "; ".join(format_.name for format_ in HAND_EYE_FORMATS)
        raise InputError("not hand-eye samples", file=path, expected=expected)
    return found.read(document)
