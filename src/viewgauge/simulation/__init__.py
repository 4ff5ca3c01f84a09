"""The full camera model by brute force, independent of the laws it judges."""

from .averaged_errors import estimate_averaged_probability, simulate_mean_errors
from .full_camera import Estimate, estimate_success_probability, simulate_length_errors
from .quasi_monte_carlo import FullModelEstimates, Sampling, estimate_success_probabilities, require_precision

__all__ = [
    "Estimate",
    "FullModelEstimates",
    "Sampling",
    "estimate_averaged_probability",
    "estimate_success_probabilities",
    "estimate_success_probability",
    "require_precision",
    "simulate_length_errors",
    "simulate_mean_errors",
]
