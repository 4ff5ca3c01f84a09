"""The exact camera by brute force, independent of the laws it judges."""

from .exact_camera import Estimate, estimate_success_probability, simulate_length_errors

__all__ = ["Estimate", "estimate_success_probability", "simulate_length_errors"]
