"""Samples of a hand-eye calibration: pairs of the robot's pose and the board's in the camera, one format a file."""
