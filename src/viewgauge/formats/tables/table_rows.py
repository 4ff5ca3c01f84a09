"""A table as rows, one a pair of viewpoint and characteristic, written chunk by chunk in order.

Chunks may come in any order. One that is early waits on the disk beside the table, so memory holds one chunk.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ..files.atomic import atomic_path
from .table_layout import TableLayout

__all__ = ["RowTable", "Sink", "Values"]

Values = Mapping[str, NDArray[np.generic]]
"""The values of a chunk: for each column its array ``(m, D)``."""

Sink = Callable[[int, Values], None]
"""Writes the rows of a chunk, given its number."""

OpenSink = Callable[[Path, "str | os.PathLike[str]", TableLayout], AbstractContextManager[Sink]]


class RowTable:
    """A file of rows under construction: complete at ``path`` when its block ends well, else absent.

    Parameters
    ----------
    layout
        What the table consists of.
    open_sink
        Opens what writes the rows of a format, given the temporary file, the path and the layout.

    Raises
    ------
    InputError
        If the place cannot be written to, or the sink cannot be opened.
    """

    done: Mapping[int, Mapping[str, Any]] = {}  # an unfinished file is not kept

    def __init__(self, path: str | os.PathLike[str], layout: TableLayout, open_sink: OpenSink) -> None:
        self._layout = layout
        self._next = 0
        self._early: dict[int, Path] = {}
        with ExitStack() as stack:
            temporary = stack.enter_context(atomic_path(path))
            beside = None if temporary.exists() else temporary.parent  # a device has no place beside it
            self._aside = Path(stack.enter_context(TemporaryDirectory(prefix=".viewgauge-", dir=beside)))
            self._sink = stack.enter_context(open_sink(temporary, path, layout))
            self._stack = stack.pop_all()

    def write(self, first_viewpoint: int, values: Values, summary: Mapping[str, Any] | None = None) -> None:  # noqa: ARG002 - nothing is kept
        """Write the chunk of viewpoints that begins with ``first_viewpoint``; for each column its array ``(m, D)``."""
        chunk = self._layout.chunk_of(first_viewpoint)
        if chunk < self._next or chunk in self._early:
            raise ValueError(f"chunk {chunk} was written before")
        checked = self._layout.checked(chunk, values)
        if chunk > self._next:
            self._early[chunk] = self._aside / f"{chunk}.npz"
            np.savez(self._early[chunk], **checked)  # type: ignore[arg-type] # names of columns, not of options
            return
        self._sink(chunk, checked)
        self._next += 1
        while self._next in self._early:
            path = self._early.pop(self._next)
            with np.load(path, allow_pickle=False) as stored:
                self._sink(self._next, stored)
            path.unlink()
            self._next += 1

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None and self._next < self._layout.chunks:
            incomplete = ValueError(f"chunk {self._next} is missing")
            self._stack.__exit__(ValueError, incomplete, None)
            raise incomplete
        self._stack.__exit__(kind, error, trace)
