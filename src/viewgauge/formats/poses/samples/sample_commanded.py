"""Samples of a pose error as poses that were commanded and measured."""

from __future__ import annotations

import numpy as np

from ....measurement import PoseSamples, errors_of_poses
from ....measurement.pose.sample_findings import pair_findings, position_findings
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
        measured = table.poses("measured_", "actual_")
        commanded = table.poses("commanded_", "nominal_", "target_", "")
        if commanded is None or measured is None:
            return None
        table.require_used()
        where = str(document.path)
        findings = (
            *position_findings(np.concatenate([commanded[:, :3, 3], measured[:, :3, 3]]), where),
            *pair_findings(commanded, measured, table.names, where),
        )
        samples = PoseSamples(errors_of_poses(commanded, measured), table.names)
        return SampleFile(samples, "poses commanded and measured", findings=findings)
