"""By what a job that is started again is known."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from importlib.metadata import version

import numpy as np
from numpy.typing import NDArray

from ..part.measurand_table import MeasurandTable
from ..planning.inspection import ExplicitViewpoints, Inspection
from .chunks import EvaluationJob

__all__ = ["job_fingerprint"]


def job_fingerprint(inspection: Inspection, job: EvaluationJob, *more: object) -> str:
    """A hash of all that the results of a job's chunks depend on: contents, not only the files they came from.

    Parameters
    ----------
    more
        What else they depend on; told apart by ``repr``.
    """
    said = [version("viewgauge"), job.method, inspection.seed, sorted(inspection.inputs.items()), job.setup.camera]
    said += [
        job.setup.requirement,
        job.setup.limits,
        inspection.candidates,
        len(job.source),
        job.mesh.chord_error_mm,
        more,
    ]
    said += [inspection.averaged_viewpoints, job.setup.pose_error.common_covariance is not None]
    said += [(d.id, d.nominal_mm, d.tolerance_mm, len(d.measurands)) for d in job.characteristics]
    digest = hashlib.sha256(repr(said).encode())
    for array in _arrays(job):
        digest.update(repr(array.shape).encode())
        digest.update(array.tobytes())
    if isinstance(job.source, ExplicitViewpoints):
        digest.update("\n".join(job.source.ids).encode())
    return digest.hexdigest()


def _arrays(job: EvaluationJob) -> Iterator[NDArray[np.generic]]:
    measurands = MeasurandTable.of(job.characteristics)
    yield from (measurands.points, measurands.normals, measurands.whole)
    yield from (job.mesh.vertices, job.mesh.triangles)
    yield from (job.setup.pose_error.covariance, np.asarray(job.setup.pose_error.T_camera_frame, dtype=float))
    if job.setup.pose_error.common_covariance is not None:
        yield job.setup.pose_error.common_covariance
    if isinstance(job.source, ExplicitViewpoints):
        yield job.source.T_part_camera
