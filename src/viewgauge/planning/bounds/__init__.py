"""Bounds that hold for every camera pose of a continuous region, not only for sampled ones."""

from .branch import Bound, Budget
from .certificate import Certificate, certify
from .eyes import EyeRegion
from .settings import SettingsBound, settings_lower_bound

__all__ = ["Bound", "Budget", "Certificate", "EyeRegion", "SettingsBound", "certify", "settings_lower_bound"]
