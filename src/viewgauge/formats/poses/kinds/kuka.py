"""KUKA: X Y Z A B C of a controller's frames and points."""

from .angle_columns import AngleColumns

__all__ = ["KUKA"]

KUKA = AngleColumns(
    key="kuka",
    name="KUKA X Y Z A B C",
    form="table with the columns X, Y, Z, A, B, C; mm and deg; A about z, B about the new y, C about the new x",
    cannot_say="the frames (base, tool); Mitsubishi's A, B, C turn about x, y, z: --rotation fixed-xyz",
    angles=("a", "b", "c"),
    unit="mm",
    angle="deg",
    rotation="turning-zyx",
    middle_within_90=True,
)
