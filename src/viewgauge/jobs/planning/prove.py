"""What is proven of a plan over all poses that the region allows, not only of those that were tried."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...execution.chunks import EvaluationJob
from ...planning import CandidateGrid, assigned_setting
from ...planning.bounds import Certificate, SettingsBound, certify, settings_lower_bound
from .choice import Choice
from .refine import Arrangement

__all__ = ["certificates", "least_anywhere"]


def least_anywhere(job: EvaluationJob, choice: Choice, arrangement: Arrangement) -> SettingsBound:
    """How few settings could measure what the arrangement does, wherever in the grid's region they stand."""
    assert isinstance(job.source, CandidateGrid)  # the caller's condition
    required, table = job.requirement.probability, arrangement.table
    count, met = len(arrangement.T_part_camera), assigned_setting(table, required) >= 0
    if count <= 1:  # what is measured needs one
        return SettingsBound(count, (), 0)
    certain = (choice.kept.level > 0) & choice.kept.certain
    attained = np.concatenate([certain, table.visible & (table.probability >= required)])[:, met]
    return settings_lower_bound(
        [job.dimensions[j] for j in np.flatnonzero(met)],
        job.requirement,
        job.camera,
        job.head,
        job.limits,
        job.source.region,
        attained=attained,
        enough=count,
    )


def certificates(job: EvaluationJob, dimensions: Sequence[int]) -> dict[int, Certificate]:
    """What is proven of dimensions that are not met, of the job's by index."""
    assert isinstance(job.source, CandidateGrid)  # the caller's condition
    region = job.source.region
    return {
        j: certify(job.dimensions[j], job.requirement, job.camera, job.head, job.limits, region) for j in dimensions
    }
