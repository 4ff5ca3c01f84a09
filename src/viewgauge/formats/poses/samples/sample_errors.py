"""Samples of a pose error that are the errors themselves."""

from __future__ import annotations

from ....measurement import PoseSamples
from .sample_file import SampleDocument, SampleFile

__all__ = ["ErrorSamples"]


class ErrorSamples:
    """CSV of errors: ``dx_mm, dy_mm, dz_mm, rx_mrad, ry_mrad, rz_mrad`` (or ``_um``, ``_m``; ``_rad``, ``_deg``)."""

    suffixes = (".csv",)
    expected = "dx_mm, dy_mm, dz_mm, rx_mrad, ry_mrad, rz_mrad"

    def read(self, document: SampleDocument) -> SampleFile | None:
        """The errors; None where the columns are others."""
        errors = None if document.table is None else document.table.errors()
        if document.table is None or errors is None:
            return None
        document.table.require_used()
        return SampleFile(PoseSamples(errors, document.table.names), "pose errors")
