"""What files of samples, board images and pairs of poses give: the pose error, the hand-eye calibration, the camera."""
