"""From samples of a head's pose error to the covariance file that a plan reads."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..io.covariance_file import write_covariance
from ..io.pose_samples_file import read_pose_samples
from ..measurement import HeadCharacter, characterize_head, small_sample_factor

__all__ = ["Characterization", "characterize", "describe_characterization", "write_head"]

_AXES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class Characterization:
    """A head's character, from how many samples of which kind.

    Parameters
    ----------
    inputs
        SHA-256 of the file, by its name.
    """

    head: HeadCharacter
    samples: int
    kind: str
    inputs: dict[str, str]


def characterize(samples: str | PathLike[str]) -> Characterization:
    """Covariance, mean, confidence and normality of a head's pose error.

    Parameters
    ----------
    samples
        File of samples (:mod:`~viewgauge.io.pose_samples_file`): poses commanded and measured, repeated visits, errors,
        or joints and measured poses.

    Raises
    ------
    InputError
        If the file cannot be used, or has too few samples.
    """
    file = read_pose_samples(samples)
    path = Path(samples)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    head = characterize_head(file.samples, file.groups)
    return Characterization(head, len(file.samples.errors), file.kind, {path.name: digest})


def write_head(character: Characterization, path: str | PathLike[str], *, with_mean: bool = False) -> None:
    """Write the covariance file that ``head.covariance`` of an inspection names.

    Parameters
    ----------
    with_mean
        The systematic part is not taken away by calibration: it counts as if it were drawn anew (second moment about
        zero).
    """
    head = character.head
    covariance = head.second_moment if with_mean else head.covariance
    write_covariance(path, covariance, head.degrees_of_freedom, head.mean, character.inputs)


def describe_characterization(character: Characterization) -> dict[str, Any]:
    """As JSON-ready data: mm and rad; what is not defined is null."""
    head = character.head
    return {
        "inputs": character.inputs,
        "kind": character.kind,
        "samples": character.samples,
        "degrees_of_freedom": head.degrees_of_freedom,
        "covariance": head.covariance.tolist(),
        "axes": [
            {
                "axis": axis,
                "standard_deviation": float(head.deviation[k]),
                "standard_deviation_interval": head.deviation_interval[k].tolist(),
                "mean": float(head.mean[k]),
                "mean_interval": head.mean_interval[k].tolist(),
                "normality_p": float(head.normality[k]),
            }
            for k, axis in enumerate(_AXES)
        ],
        "correlation": (head.covariance / np.outer(_safe(head.deviation), _safe(head.deviation))).tolist(),
        "skewness_p": None if np.isnan(head.skewness_p) else head.skewness_p,
        "kurtosis_p": None if np.isnan(head.kurtosis_p) else head.kurtosis_p,
        "outliers": list(head.outliers),
        "factor_at_95": small_sample_factor(head.degrees_of_freedom, 0.95),
    }


def _safe(deviation: np.ndarray) -> np.ndarray:
    return np.where(deviation > 0, deviation, 1.0)
