"""From the light on the pixels to grey values: blur, noise, bits; or black and white."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..exceptions import InputError

__all__ = ["ImageSensor"]


@dataclass(frozen=True)
class ImageSensor:
    """What makes an image of light.

    Parameters
    ----------
    blur_px
        Standard deviation of a Gaussian blur.
    noise
        Standard deviation of the noise of a pixel, as a share of full scale.
    bits
        8 or 12: of a grey value.
    black_and_white
        The paper's own image: a pixel is on when more than half of it is covered; neither blur nor noise.
    """

    blur_px: float = 0.0
    noise: float = 0.0
    bits: int = 8
    black_and_white: bool = False

    def __post_init__(self) -> None:
        for name in ("blur_px", "noise"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise InputError("must be finite and not negative", key=name, got=value)
        if self.bits not in (8, 12):
            raise InputError("unknown number of bits", key="bits", got=self.bits, expected="8 or 12")

    @property
    def margin_px(self) -> int:
        """By how much a window must be larger for the blur inside it to be right."""
        return int(np.ceil(4 * self.blur_px))

    def grey(self, radiance: NDArray[np.float32], rng: np.random.Generator) -> NDArray[np.uint16]:
        """Grey values of light ``(rows, columns)``, 0 to 1 (with ``black_and_white`` of coverage)."""
        full = 2**self.bits - 1
        if self.black_and_white:
            return np.where(radiance > 0.5, full, 0).astype(np.uint16)
        light = radiance
        if self.blur_px > 0:
            from scipy.ndimage import gaussian_filter

            light = gaussian_filter(radiance, self.blur_px, mode="nearest", truncate=4.0)
        noisy = light * full + self.noise * full * rng.standard_normal(light.shape, dtype=np.float32)
        return np.asarray(np.clip(np.rint(noisy), 0, full), dtype=np.uint16)
