"""Formats of poses, one file each; :mod:`~viewgauge.formats.poses.pose_formats` finds them."""
