"""From a part and its requirement to a camera, a lens, and how well its pose has to be known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...evaluation import Evaluator
from ...exceptions import InputError, NoCandidateError
from ...execution.chunks import EvaluationJob, candidate_grid, evaluator_of
from ...execution.progress import Progress, Silent
from ...part import Characteristic
from ...part.measurand_table import MeasurandTable
from ...planning import default_distance_range, sort_characteristics
from ...planning.improve.catalogue import FOCAL_LENGTHS_MM, SENSORS, SensorFormat
from ...planning.improve.improvement import CameraChoice, Specification
from ...planning.improve.knobs import KNOBS, Rig
from ...planning.improve.least_change import meeting
from ...planning.inspection import Inspection
from ...sensors import Camera
from .improve import settled_change

__all__ = ["specify"]


def specify(
    inspection: Inspection,
    *,
    sensors: Sequence[SensorFormat] = SENSORS,
    focal_lengths_mm: Sequence[float] = FOCAL_LENGTHS_MM,
    progress: Progress | None = None,
) -> Specification:
    """For each sensor and lens the largest pose error, and the coarsest edge detector, with which all is met.

    A characteristic is met if one of the candidate viewpoints measures it as required.

    The edge detector's step in pixels, the covariance of the pose error up to a factor, and the requirement are the
    inspection's; so is the range of distances if it is stated, else it suits each camera. Apertures are not looked at:
    everything counts as in focus.

    Raises
    ------
    InputError
        If there is no characteristic to measure, or viewpoints are given one by one.
    """
    progress = progress or Silent()
    found = sort_characteristics(inspection.part, inspection.requirement)
    characteristics = found.judged
    if not characteristics:
        raise InputError("no characteristic can be measured; see viewgauge check", key="part")
    if inspection.viewpoints is not None:
        raise InputError(
            "a camera is specified by candidates that are sampled to suit it",
            key="viewpoints",
            got="viewpoints given one by one",
            hint="leave out viewpoints",
        )
    first = candidate_grid(inspection, characteristics)
    evaluator = evaluator_of(EvaluationJob.of(inspection, characteristics, first))
    choices = []
    with progress.stage("Trying cameras", len(sensors) * len(focal_lengths_mm)) as advance:
        for sensor in sorted(sensors, key=lambda s: s.resolution[0] * s.resolution[1]):
            for focal_length in sorted(focal_lengths_mm):
                choice = _choice(inspection, characteristics, evaluator, sensor, focal_length)
                if choice is not None:
                    choices.append(choice)
                advance(1)
    if not choices:
        raise NoCandidateError("no candidate viewpoint is left with any camera; see candidates")
    return Specification(tuple(choices), len(characteristics), found.not_measurable)


def _choice(
    inspection: Inspection,
    characteristics: Sequence[Characteristic],
    evaluator: Evaluator,
    sensor: SensorFormat,
    focal_length_mm: float,
) -> CameraChoice | None:
    pitch = (sensor.pixel_pitch_mm, sensor.pixel_pitch_mm)
    today = inspection.camera
    camera = Camera(
        focal_length_mm, pitch, sensor.resolution, today.edge_resolution_px, edge_detector=today.edge_detector
    )
    points = MeasurandTable.of(characteristics).points.reshape(-1, 3)
    distance = inspection.candidates.distance_mm or default_distance_range(points, camera)
    if today.focus_distance_mm is not None:  # focused where it looks
        focus = math.sqrt(distance[0] * distance[1])
        if focus <= focal_length_mm:
            return None
        camera = replace(camera, f_number=today.f_number, focus_distance_mm=focus, blur_limit_px=today.blur_limit_px)
    options = replace(inspection.candidates, distance_mm=distance)
    try:
        grid = candidate_grid(replace(inspection, camera=camera, candidates=options), characteristics)
    except NoCandidateError:
        return None
    poses, setup = grid.poses(0, len(grid)), Rig(camera, inspection.pose_error, distance)
    of_camera = evaluator.with_errors(camera, inspection.pose_error)
    met = int(np.count_nonzero(meeting(of_camera, poses).any(axis=0)))
    pose_error = settled_change(of_camera, poses, setup, KNOBS["pose_error"])
    translation, rotation = (
        None if pose_error.factor is None or not knob.today(setup) else pose_error.factor * knob.today(setup)
        for knob in (KNOBS["translation"], KNOBS["rotation"])
    )
    pixel = settled_change(of_camera, poses, setup, KNOBS["pixel"]) if KNOBS["pixel"].today(setup) > 0 else None
    return CameraChoice(sensor, focal_length_mm, distance, met, pose_error, translation, rotation, pixel)
