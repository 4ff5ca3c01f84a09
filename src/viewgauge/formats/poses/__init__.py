"""Poses and what is known of their errors: viewpoints, pose samples, covariances, views of a board."""
