"""Bounds that hold for every camera pose of a continuous region, not only for sampled ones."""

from .branch_and_bound import Bound, Budget
from .certificate import Certificate, certify
from .eye_region import EyeRegion
from .viewpoints_bound import SettingsBound, settings_lower_bound

__all__ = ["Bound", "Budget", "Certificate", "EyeRegion", "SettingsBound", "certify", "settings_lower_bound"]
