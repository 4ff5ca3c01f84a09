"""Kinds of pose-error samples, one file each; :mod:`~viewgauge.formats.poses.pose_samples_file` finds them."""
