"""Camera calibrations as other programs write them: OpenCV, ROS, Kalibr."""
