"""How well a camera pose is held: pose samples, boards, robot calibration, the covariance that follows."""
