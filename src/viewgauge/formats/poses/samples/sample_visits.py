"""Samples of a pose error as measured poses of repeated visits."""

from __future__ import annotations

from ....measurement import PoseSamples, errors_about_group_means
from ....measurement.pose.sample_findings import position_findings
from .sample_file import SampleDocument, SampleFile

__all__ = ["VisitSamples"]


class VisitSamples:
    """CSV ``pose, x, y, z, qw, qx, qy, qz``: poses measured; rows of one name are visits of one commanded pose."""

    suffixes = (".csv",)
    expected = "pose, x, ..., qz"

    def read(self, document: SampleDocument) -> SampleFile | None:
        """The errors about the mean of each pose; None where the columns are others."""
        table = document.table
        if table is None:
            return None
        poses, visits = table.poses(""), table.text("pose")
        if poses is None or visits is None:
            return None
        table.require_used()
        errors, groups = errors_about_group_means(poses, visits)
        samples = PoseSamples(errors, table.names, repeated=True)
        findings = tuple(position_findings(poses[:, :3, 3], str(document.path)))
        return SampleFile(samples, f"repeated visits of {groups} poses", groups, findings)
