"""What is implausible in an inspection: one file for each of the things that it holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...findings import Finding
from ..sort_characteristics import without_allowed_error
from .camera_findings import camera_findings
from .placement_findings import distance_findings, limits_findings, measurand_points, part_findings
from .pose_findings import pose_findings
from .requirement_findings import requirement_findings
from .viewpoint_findings import viewpoint_findings

if TYPE_CHECKING:
    from ..inspection import ExplicitViewpoints, Inspection

__all__ = ["implausible", "implausible_viewpoints"]


def implausible(inspection: Inspection) -> tuple[Finding, ...]:
    """Every finding of an inspection, in the order of the sections of its file."""
    judged, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    findings = [
        *part_findings(inspection.part.mesh),
        *camera_findings(inspection.camera),
        *pose_findings(inspection.pose_error),
        *requirement_findings(inspection.requirement, judged),
        *limits_findings(inspection.limits, inspection.camera),
    ]
    if inspection.viewpoints is None:
        findings += distance_findings(inspection.candidates, inspection.camera, inspection.limits, judged)
    else:
        findings += implausible_viewpoints(inspection, inspection.viewpoints)
    return tuple(findings)


def implausible_viewpoints(inspection: Inspection, viewpoints: ExplicitViewpoints) -> tuple[Finding, ...]:
    """Every finding of viewpoints that are given for an inspection."""
    points = measurand_points(inspection.part.characteristics)
    found = viewpoint_findings(
        viewpoints.ids, viewpoints.T_part_camera, inspection.part.mesh, inspection.camera, points
    )
    return tuple(found)
