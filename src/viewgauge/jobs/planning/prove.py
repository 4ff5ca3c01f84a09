"""What is proven of a plan over all poses that the region allows, not only of those that were tried."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...execution.chunks import EvaluationJob
from ...planning import CandidateGrid, assigned_viewpoint
from ...planning.bounds import Certificate, ViewpointsBound, certify, viewpoints_lower_bound
from .choice import Choice
from .refine import Arrangement

__all__ = ["certificates", "least_anywhere"]


def least_anywhere(job: EvaluationJob, choice: Choice, arrangement: Arrangement) -> ViewpointsBound:
    """How few viewpoints could measure what the arrangement does, wherever in the grid's region they are."""
    assert isinstance(job.source, CandidateGrid)  # the caller's condition
    required, table = job.setup.requirement.probability, arrangement.table
    count, met = len(arrangement.T_part_camera), assigned_viewpoint(table, required) >= 0
    if count <= 1:  # what is measured needs one
        return ViewpointsBound(count, (), 0)
    certain = (choice.kept.level > 0) & choice.kept.certain
    attained = np.concatenate([certain, table.visible & (table.probability >= required)])[:, met]
    return viewpoints_lower_bound(
        [job.characteristics[j] for j in np.flatnonzero(met)],
        job.setup,
        job.source.region,
        attained=attained,
        enough=count,
    )


def certificates(job: EvaluationJob, characteristics: Sequence[int]) -> dict[int, Certificate]:
    """What is proven of characteristics that are not met, of the job's by index."""
    assert isinstance(job.source, CandidateGrid)  # the caller's condition
    region = job.source.region
    return {j: certify(job.characteristics[j], job.setup, region) for j in characteristics}
