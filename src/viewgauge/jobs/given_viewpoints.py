"""Viewpoints that a job is given, or samples by itself."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from os import PathLike
from typing import overload

from numpy.typing import ArrayLike

from ..exceptions import InputError, NoCandidateError
from ..execution.chunks import ViewpointSource, candidate_grid
from ..findings import admit
from ..formats.poses.viewpoints_file import read_viewpoints
from ..geometry import require_poses
from ..planning import without_allowed_error
from ..planning.inspection import ExplicitViewpoints, Inspection
from ..planning.plausibility import implausible_viewpoints

__all__ = ["ViewpointsLike", "sampled_viewpoints", "viewpoints_of"]

_log = logging.getLogger(__name__)

ViewpointsLike = ExplicitViewpoints | str | PathLike[str] | ArrayLike | None
"""A viewpoints file (CSV), poses ``T_part_camera`` ``(n, 4, 4)`` mm, or None for those that the inspection names."""


def viewpoints_of(inspection: Inspection, viewpoints: ViewpointsLike) -> ExplicitViewpoints:
    """Viewpoints as they may be given: a file, poses, or those that the inspection names; raises InputError."""
    if viewpoints is None:
        if inspection.viewpoints is None:
            raise InputError(
                "no viewpoints to evaluate", hint="give a viewpoints file (CSV), or name one in candidates.viewpoints"
            )
        return inspection.viewpoints
    if isinstance(viewpoints, str | PathLike):
        return _looked_at(inspection, ExplicitViewpoints(*read_viewpoints(viewpoints)))
    if not isinstance(viewpoints, ExplicitViewpoints):
        poses = require_poses(viewpoints, "viewpoints").reshape(-1, 4, 4)
        viewpoints = ExplicitViewpoints(tuple(f"S{k}" for k in range(1, len(poses) + 1)), poses)
    if not len(viewpoints):
        raise InputError("no viewpoints to evaluate", key="viewpoints", got="no pose", expected="at least one")
    return viewpoints


def _looked_at(inspection: Inspection, viewpoints: ExplicitViewpoints) -> ExplicitViewpoints:
    """The viewpoints of a file; raises InputError where they are implausible and not accepted, or logs a warning."""
    for finding in admit(implausible_viewpoints(inspection, viewpoints), inspection.accepted):
        _log.warning("%s", finding)
    return viewpoints


def sampled_viewpoints(inspection: Inspection) -> tuple[ViewpointSource, Sequence[str]]:
    """The candidates that a plan would sample, and their names; raises NoCandidateError where nothing is measured."""
    characteristics, _ = without_allowed_error(inspection.part.characteristics, inspection.requirement)
    if not characteristics:
        raise NoCandidateError("nothing can be measured, so no viewpoint is sampled: see viewgauge check")
    grid = candidate_grid(inspection, characteristics)
    return grid, _Numbered(len(grid))


class _Numbered(Sequence[str]):
    """The names C1, C2, … of any number of viewpoints, made when they are asked for."""

    def __init__(self, count: int) -> None:
        self._places = range(1, count + 1)

    def __len__(self) -> int:
        return len(self._places)

    @overload
    def __getitem__(self, k: int) -> str: ...
    @overload
    def __getitem__(self, k: slice) -> list[str]: ...
    def __getitem__(self, k: int | slice) -> str | list[str]:
        return [f"C{place}" for place in self._places[k]] if isinstance(k, slice) else f"C{self._places[k]}"
