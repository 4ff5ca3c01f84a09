"""The section ``camera.edge_detector``: how accurately edges are located in an image."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, StrictInt, model_validator

from ...errors import edge_point_deviation
from ...exceptions import InputError
from ...sensors import EdgeDetector
from .values import Pixels, PixelsOrZero, PositiveNumber, Section

__all__ = ["EdgeDetectorSection"]


_WITH_SIGNAL_TO_NOISE = ("signal_to_noise", "blur", "samples", "smoothing")


class EdgeDetectorSection(Section):
    """How edges are found: by quantization (the paper's), or sub-pixel, with the noise of an edge point."""

    model_config = ConfigDict(
        json_schema_extra={
            "oneOf": [
                {"required": ["quantization"], "maxProperties": 1},
                {
                    "required": ["noise"],
                    "properties": dict.fromkeys(
                        ("quantization", "signal_to_noise", "blur", "samples", "smoothing"), False
                    ),
                },
                {"required": ["signal_to_noise", "blur"], "properties": {"quantization": False, "noise": False}},
            ]
        }
    )

    quantization: PixelsOrZero | None = Field(
        default=None, description="the quantization step of an edge's place, such as 1 px; alone"
    )
    noise: PixelsOrZero | None = Field(
        default=None, description="the standard deviation of an edge point along the edge's normal, such as 0.1 px"
    )
    signal_to_noise: PositiveNumber | None = Field(
        default=None,
        description="an edge's step over the standard deviation of a pixel's noise, such as 50; in place of noise",
    )
    blur: PixelsOrZero | None = Field(
        default=None, description="the standard deviation of the lens's blur, such as 0.7 px; with signal_to_noise"
    )
    samples: Annotated[StrictInt, Field(ge=1, le=1000)] = Field(
        default=1, description="how many independent scan lines make one edge point: a whole number, by default 1"
    )
    smoothing: Pixels | None = Field(
        default=None, description="the standard deviation of the detector's smoothing filter, such as 1 px"
    )
    offset: PixelsOrZero = Field(
        default=0.0,
        description="the standard uncertainty of an offset that all edges share, such as 0.05 px; by default 0 px",
    )
    edge_points: Annotated[StrictInt, Field(ge=2, le=10_000)] | None = Field(
        default=None, description="how many edge points a line is fitted to: a whole number from 2 on"
    )
    clear_of_corner: PixelsOrZero = Field(
        default=0.0, description="how far edge points stay away from a corner, by default 0 px"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.quantization is not None:
            others = [name for name in self.model_fields_set if name != "quantization"]
            if others:
                raise InputError(
                    "a sub-pixel edge detector takes the place of quantization",
                    key="quantization",
                    expected=f"quantization, or {', '.join(sorted(others))}",
                )
            return self
        if (self.noise is None) == (self.signal_to_noise is None):
            raise InputError(
                "the noise of an edge point is stated once",
                key="noise" if self.noise is not None else None,
                expected="noise (px), or signal_to_noise with blur; or quantization (px) alone",
            )
        if self.signal_to_noise is not None and self.blur is None:
            raise InputError("required key missing", key="blur", expected="the lens's blur, such as 0.7 px")
        if self.noise is not None and (self.blur is not None or self.smoothing is not None or self.samples != 1):
            raise InputError("noise stands for blur, samples and smoothing", key="noise", expected="it alone")
        return self

    def build(self) -> EdgeDetector | float:
        """The edge detector, or the quantization step, px; raises InputError."""
        if self.quantization is not None:
            return self.quantization
        noise = self.noise
        if noise is None:
            assert self.signal_to_noise is not None and self.blur is not None  # noqa: PT018  # see _one_way
            noise = float(edge_point_deviation(self.signal_to_noise, self.blur, self.samples, self.smoothing))
        return EdgeDetector(noise, self.offset, self.edge_points, self.clear_of_corner)
