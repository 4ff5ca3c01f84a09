"""Conversion of foreign files: one file for each kind of content (cameras, poses), behind a small registry."""
