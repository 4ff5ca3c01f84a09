"""Which settings to use: candidates around the part, and the fewest of them that measure everything."""

from .candidates import CandidateGrid, default_distance_range, spread_directions
from .cover import Cover, minimum_cover, surest_minimum_cover
from .dominance import Undominated, probability_levels
from .options import CandidateOptions
from .plan import Averaged, assigned_setting, choose_settings, compose_plan, not_measurable, without_allowed_error
from .refinement import Refinement, RefinementStep, Refiner
from .result import Look, Plan, PlannedDimension, PlannedSetting
from .setting_pool import SettingPool

__all__ = [
    "Averaged",
    "CandidateGrid",
    "CandidateOptions",
    "Cover",
    "Look",
    "Plan",
    "PlannedDimension",
    "PlannedSetting",
    "Refinement",
    "RefinementStep",
    "Refiner",
    "SettingPool",
    "Undominated",
    "assigned_setting",
    "choose_settings",
    "compose_plan",
    "default_distance_range",
    "minimum_cover",
    "not_measurable",
    "probability_levels",
    "spread_directions",
    "surest_minimum_cover",
    "without_allowed_error",
]
