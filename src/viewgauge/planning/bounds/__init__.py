"""Bounds that hold for every camera pose of a continuous region, not only for sampled ones."""

from .branch_and_bound import Bound, Budget
from .certificate import Certificate, certify
from .viewpoints_bound import ViewpointsBound, viewpoints_lower_bound

__all__ = ["Bound", "Budget", "Certificate", "ViewpointsBound", "certify", "viewpoints_lower_bound"]
