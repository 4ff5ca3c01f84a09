"""What the numbers of a calibration mean: matrices, lens models by their names, and what no camera has."""
