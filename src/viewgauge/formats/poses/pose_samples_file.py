"""Files of pose-error samples: CSV of poses or of errors, or YAML of joints and poses.

In CSV the order of the columns is free; lengths are mm unless the column's name ends in ``_m``. A further kind is a
class like :class:`~viewgauge.formats.poses.samples.sample_file.SampleFormat` in a file of its own, and its place in
``SAMPLE_FORMATS``, or ``SAMPLE_FORMATS.register(...)`` from outside.
"""

from __future__ import annotations

import os
from pathlib import Path

from ...exceptions import InputError
from ..files.registry import SuffixRegistry
from .pose_file import PoseConventions
from .samples.sample_commanded import CommandedSamples
from .samples.sample_errors import ErrorSamples
from .samples.sample_file import SampleDocument, SampleFile, SampleFormat
from .samples.sample_joints import JointSamples
from .samples.sample_visits import VisitSamples

__all__ = ["SAMPLE_FORMATS", "SampleFile", "read_pose_samples"]

SAMPLE_FORMATS: SuffixRegistry[SampleFormat] = SuffixRegistry(
    ErrorSamples(), CommandedSamples(), VisitSamples(), JointSamples()
)


def read_pose_samples(path: str | os.PathLike[str], conventions: PoseConventions | None = None) -> SampleFile:
    """Samples of the pose error.

    Parameters
    ----------
    conventions
        What the user says of the poses, where the names of the columns do not.

    Raises
    ------
    InputError
        With file, line and column, if anything in it cannot be used.
    """
    document = SampleDocument(Path(path), conventions)
    formats = [format_ for format_ in SAMPLE_FORMATS if document.suffix in format_.suffixes]
    if not formats:
        expected = f"one of {', '.join(SAMPLE_FORMATS.suffixes)}"
        raise InputError("unknown kind of file for samples", file=path, got=document.suffix or None, expected=expected)
    for format_ in formats:
        if (found := format_.read(document)) is not None:
            return found
    table, expected = document.table, "; or ".join(format_.expected for format_ in formats)
    if table is None:
        raise InputError("the file holds no samples of a known kind", file=path, expected=expected)
    got = ", ".join(table.header)
    raise InputError("the columns are not those of samples", file=path, line=table.line, got=got, expected=expected)
