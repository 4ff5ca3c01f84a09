"""Tables with columns roll, pitch, yaw."""

from .angle_columns import AngleColumns

__all__ = ["ROLL_PITCH_YAW"]

ROLL_PITCH_YAW = AngleColumns(
    key="rpy",
    name="x y z roll pitch yaw",
    form="table with the columns x, y, z, roll, pitch, yaw; roll, pitch, yaw about the fixed x, y, z",
    cannot_say="the unit of lengths (--unit) and of angles (--angle), unless names of columns do (x_mm, roll_deg)",
    angles=("roll", "pitch", "yaw"),
    rotation="fixed-xyz",
)
