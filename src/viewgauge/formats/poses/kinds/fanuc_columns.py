"""Fanuc: x y z w p r as a table."""

from .angle_columns import AngleColumns

__all__ = ["FANUC_COLUMNS"]

FANUC_COLUMNS = AngleColumns(
    key="fanuc",
    name="Fanuc x y z w p r",
    form="table with the columns x, y, z, w, p, r; mm and deg; w, p, r about the fixed x, y, z",
    cannot_say="the frames (UFRAME, UTOOL)",
    angles=("w", "p", "r"),
    unit="mm",
    angle="deg",
    rotation="fixed-xyz",
    middle_within_90=True,
)
