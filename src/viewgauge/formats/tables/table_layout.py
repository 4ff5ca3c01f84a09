"""The structure of a table over (viewpoint, characteristic): ids, columns and chunks, without the values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

__all__ = ["Column", "TableLayout"]


@dataclass(frozen=True)
class Column:
    """A column of the table.

    Parameters
    ----------
    name
        The column's name as it is written.
    kind
        The type of its values: "real" (float64), "flag" (bool), "whole" (int64), or "name" (indices into ``names``).
    names
        The texts that the indices of a "name" column stand for; written in their place.
    in_rows
        Whether CSV and Parquet have it too, or Zarr only.
    """

    name: str
    kind: Literal["real", "flag", "whole", "name"] = "real"
    names: tuple[str, ...] = ()
    in_rows: bool = True

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """The type of the values as they are read again; names are text as wide as the longest name."""
        if self.kind == "name":
            return np.dtype(f"<U{max(1, *map(len, self.names))}")
        return np.dtype({"real": "<f8", "flag": "|b1", "whole": "<i8"}[self.kind])


@dataclass(frozen=True)
class TableLayout:
    """Ids, columns and chunks of a table.

    Parameters
    ----------
    viewpoint_ids, characteristic_ids
        Ids of n viewpoints and of D characteristics. Only slices of the viewpoints' ids are asked for.
    columns
        The columns in the order in which they are written.
    chunk_viewpoints
        Number of viewpoints that are written at once: chunk k is the viewpoints from ``k * chunk_viewpoints``.
    coordinates
        Properties of the characteristics, by name, ``(D,)``; in Zarr only.
    attrs
        Attributes of the whole table; in Zarr only.
    """

    viewpoint_ids: Sequence[str]
    characteristic_ids: Sequence[str]
    columns: tuple[Column, ...]
    chunk_viewpoints: int
    coordinates: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    attrs: Mapping[str, str | float] = field(default_factory=dict)

    @property
    def chunks(self) -> int:
        """Number of chunks."""
        return -(-len(self.viewpoint_ids) // self.chunk_viewpoints)

    @property
    def row_columns(self) -> tuple[Column, ...]:
        """The columns of CSV and Parquet."""
        return tuple(column for column in self.columns if column.in_rows)

    def viewpoints(self, chunk: int) -> slice:
        """The viewpoints of a chunk."""
        first = chunk * self.chunk_viewpoints
        return slice(first, min(first + self.chunk_viewpoints, len(self.viewpoint_ids)))

    def chunk_of(self, first_viewpoint: int) -> int:
        """The chunk that begins with a viewpoint."""
        chunk, rest = divmod(first_viewpoint, self.chunk_viewpoints)
        if rest or not 0 <= chunk < self.chunks:
            raise ValueError(f"no chunk of {self.chunk_viewpoints} viewpoints begins with viewpoint {first_viewpoint}")
        return chunk

    def checked(self, chunk: int, values: Mapping[str, NDArray[np.generic]]) -> dict[str, NDArray[np.generic]]:
        """The arrays ``(m, D)`` of a chunk for each column, in the types of their kinds ("name": int64)."""
        viewpoints = self.viewpoints(chunk)
        shape = (viewpoints.stop - viewpoints.start, len(self.characteristic_ids))
        checked: dict[str, NDArray[np.generic]] = {}
        for column in self.columns:
            array = np.asarray(values[column.name])
            if array.shape != shape:
                raise ValueError(f"column {column.name} of chunk {chunk}: shape {array.shape}, expected {shape}")
            checked[column.name] = array.astype(np.int64 if column.kind == "name" else column.dtype, copy=False)
        return checked
