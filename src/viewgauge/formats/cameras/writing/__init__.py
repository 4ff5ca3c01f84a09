"""Calibrations written for other programs: one file a format, behind a registry."""
