"""Universal Robots: x y z rx ry rz; other makers write turns about axes under the same names."""

from dataclasses import replace

from .angle_columns import AngleColumns

__all__ = ["ROTATION_COLUMNS", "UNIVERSAL_ROBOTS"]

ROTATION_COLUMNS = AngleColumns(
    key="rxryrz",
    name="x y z rx ry rz",
    form="table with the columns x, y, z, rx, ry, rz",
    cannot_say="the unit of lengths (--unit) and of angles (--angle), and what the angles mean (--rotation); "
    "--from ur says all three for Universal Robots: m, rad, rotation vector",
    angles=("rx", "ry", "rz"),
)

UNIVERSAL_ROBOTS = replace(
    ROTATION_COLUMNS,
    key="ur",
    name="Universal Robots x y z rx ry rz",
    form="the same columns, or poses p[x, y, z, rx, ry, rz] in text; m, a rotation vector in rad",
    cannot_say="that it is one (the columns have other makers' names): --from ur",
    unit="m",
    angle="rad",
    rotation="rotation-vector",
)
