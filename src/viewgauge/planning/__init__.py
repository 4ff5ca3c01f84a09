"""Which viewpoints to use: candidates around the part, and the fewest of them that measure everything."""

from .candidates.candidate_grid import CandidateGrid, default_distance_range, spread_directions
from .candidates.candidate_options import CandidateOptions
from .compose import (
    assigned_viewpoint,
    choose_viewpoints,
    compose_plan,
    planned_not_measurable,
)
from .cover.dominance import Undominated, probability_levels
from .cover.minimum_cover import Cover, minimum_cover, most_probable_minimum_cover
from .cover.viewpoint_pool import ViewpointPool
from .findings import Averaged, ChosenViewpoints, NotMetFindings, PlanRecord
from .plan import Acquisition, Plan, PlannedCharacteristic, PlannedViewpoint, Status
from .refine.refinement import Refinement, RefinementStep, Refiner
from .sort_characteristics import SortedCharacteristics, sort_characteristics, toleranced, without_allowed_error

__all__ = [
    "Acquisition",
    "Averaged",
    "CandidateGrid",
    "CandidateOptions",
    "ChosenViewpoints",
    "Cover",
    "NotMetFindings",
    "Plan",
    "PlanRecord",
    "PlannedCharacteristic",
    "PlannedViewpoint",
    "Refinement",
    "RefinementStep",
    "Refiner",
    "SortedCharacteristics",
    "Status",
    "Undominated",
    "ViewpointPool",
    "assigned_viewpoint",
    "choose_viewpoints",
    "compose_plan",
    "default_distance_range",
    "minimum_cover",
    "most_probable_minimum_cover",
    "planned_not_measurable",
    "probability_levels",
    "sort_characteristics",
    "spread_directions",
    "toleranced",
    "without_allowed_error",
]
