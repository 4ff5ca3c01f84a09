"""Calibration targets beside the ChArUco board: how each is found in an image."""
