"""Which settings to use: candidates around the part, and the fewest of them that measure everything."""

from .candidates.candidate_grid import CandidateGrid, default_distance_range, spread_directions
from .candidates.candidate_options import CandidateOptions
from .compose import (
    Averaged,
    assigned_setting,
    choose_settings,
    compose_plan,
    planned_not_measurable,
    without_allowed_error,
)
from .cover.dominance import Undominated, probability_levels
from .cover.minimum_cover import Cover, minimum_cover, surest_minimum_cover
from .cover.viewpoint_pool import SettingPool
from .plan import Look, Plan, PlannedDimension, PlannedSetting
from .refine.refinement import Refinement, RefinementStep, Refiner

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
    "planned_not_measurable",
    "probability_levels",
    "spread_directions",
    "surest_minimum_cover",
    "without_allowed_error",
]
