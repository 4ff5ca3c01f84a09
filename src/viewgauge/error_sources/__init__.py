"""The sources of measurement error, one file each: what each adds to the error budget, to the knobs and to the draws.

Every camera has the sources of :data:`ERROR_SOURCES`; what a camera has beside them is a :class:`LengthError` among its
``further_errors``. The simulation shares this package with the prediction, and a source keeps the two apart: its
``sensitivity`` is the linear law's, its ``displaced`` is the full camera model's, and neither calls the other. The
compiled form of the linear law is in :mod:`viewgauge.evaluation.camera_errors`.
"""

from .base import Component, DrawnView, ErrorSource, LinearTerms, SourceKind
from .length_error import LengthError
from .pose_source import scaled_pose_error
from .registry import ERROR_SOURCES, components_of, groups_of, sources_of

__all__ = [
    "ERROR_SOURCES",
    "Component",
    "DrawnView",
    "ErrorSource",
    "LengthError",
    "LinearTerms",
    "SourceKind",
    "components_of",
    "groups_of",
    "scaled_pose_error",
    "sources_of",
]
