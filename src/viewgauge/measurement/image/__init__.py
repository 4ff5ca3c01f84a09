"""A part in an image: edges, rims, the pose from which it was taken, the length of a measurand and its law."""
