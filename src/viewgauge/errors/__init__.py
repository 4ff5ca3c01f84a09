"""Probability laws of the error of a segment's image length. They take numbers, not geometry."""

from .accuracy import Accuracy
from .edge_location import edge_point_deviation, ellipse_chord_variance, line_end_variance
from .independent.independent_total import IndependentTotalError
from .independent.marsaglia import MarsagliaForm, marsaglia_form
from .independent.normal_ratio import NormalRatio
from .independent.paper_form import covariance_numerator_denominator, lambdas
from .independent.point_displacement import PointDisplacement
from .joint.averaged import AveragedError
from .projected_length import projected_length, projected_length_on_axis
from .quantization import SpatialQuantization
from .segment_displacement import SegmentDisplacement
from .total import TotalError

__all__ = [
    "Accuracy",
    "AveragedError",
    "IndependentTotalError",
    "MarsagliaForm",
    "NormalRatio",
    "PointDisplacement",
    "SegmentDisplacement",
    "SpatialQuantization",
    "TotalError",
    "covariance_numerator_denominator",
    "edge_point_deviation",
    "ellipse_chord_variance",
    "lambdas",
    "line_end_variance",
    "marsaglia_form",
    "projected_length",
    "projected_length_on_axis",
]
