"""Samples of a pose error as poses that were commanded and measured."""

from __future__ import annotations

from ...measurement import PoseSamples, errors_of_poses
from .sample_file import SampleDocument, SampleFile

__all__ = ["CommandedSamples"]


class CommandedSamples:
    """CSV of poses commanded, ``x, y, z, qw, qx, qy, qz``, and measured, the same seven with ``measured_`` before."""

    suffixes = (".csv",)
    expected = "x, y, z, qw, qx, qy, qz with measured_x, ..., measured_qz"

    def read(self, document: SampleDocument) -> SampleFile | None:
        """The errors of the measured poses; None where the columns are others."""
        table = document.table
        if table is None:
            return None
        commanded, measured = table.poses(""), table.poses("measured_")
        if commanded is None or measured is None:
            return None
        samples = PoseSamples(errors_of_poses(commanded, measured), table.names)
        return SampleFile(samples, "poses commanded and measured")
