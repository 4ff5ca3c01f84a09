"""Binning and a region of interest: the image that is used is a part of the one that was calibrated."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..camera_file import CameraFile
from ..reading.key_account import KeyAccount

__all__ = ["ImageWindow", "read_image_window"]

_BINNING = (
    frozenset({"binningx", "binninghorizontal", "decimationx"}),
    frozenset({"binningy", "binningvertical", "decimationy"}),
)
_ROI_KEYS = {"x_offset", "y_offset", "width", "height", "do_rectify"}


@dataclass(frozen=True)
class ImageWindow:
    """The part of the image, px of the whole, and how many of its pixels are one.

    Parameters
    ----------
    size
        None for the whole image.
    """

    offset: tuple[int, int] = (0, 0)
    size: tuple[int, int] | None = None
    binning: tuple[int, int] = (1, 1)

    def of(self, camera: CameraFile) -> CameraFile:
        """The calibration of the part.

        A binned pixel's centre is the mean of those of its pixels, so that x becomes (x - offset - (b - 1)/2)/b.
        """
        if self == ImageWindow():
            return camera
        size = self.size or camera.resolution
        focal = tuple(f / b for f, b in zip(camera.focal_length_px, self.binning, strict=True))
        centre = tuple(
            (c - o - (b - 1) / 2) / b
            for c, o, b in zip(camera.principal_point_px, self.offset, self.binning, strict=True)
        )
        resolution = None if size is None else (size[0] // self.binning[0], size[1] // self.binning[1])
        words = []
        if self.size is not None:
            words.append(f"region of {self.size[0]} x {self.size[1]} px at ({self.offset[0]}, {self.offset[1]})")
        if self.binning != (1, 1):
            words.append(f"binning {self.binning[0]} x {self.binning[1]}")
        covariance = camera.covariance
        if covariance is not None:
            scale = [1 / b for b in (*self.binning, *self.binning)] + [1.0] * (len(covariance) - 4)
            covariance = tuple(
                tuple(value * scale[i] * scale[j] for j, value in enumerate(row)) for i, row in enumerate(covariance)
            )
        return replace(
            camera,
            focal_length_px=(focal[0], focal[1]),
            principal_point_px=(centre[0], centre[1]),
            resolution=resolution,
            covariance=covariance,
            notes=(*camera.notes, f"calibration of the whole image brought to the image in use: {', '.join(words)}"),
        )


def read_image_window(account: KeyAccount, whole: tuple[int, int] | None) -> ImageWindow:
    """The part of the image that is used; the whole where the section does not say or a problem was noted."""
    binning = tuple(_binning(account, names) for names in _BINNING)
    entry = account.take({"roi", "regionofinterest"}, lambda value: isinstance(value, dict))
    document = account.document
    if entry is None:
        return ImageWindow(binning=(binning[0], binning[1]))
    values: dict[str, int] = {}
    for key, value in entry.value.items():
        where = (*entry.where, key)
        if key not in _ROI_KEYS:
            document.problems.add(where, "the key is not known here", got=value, expected=", ".join(sorted(_ROI_KEYS)))
        elif key != "do_rectify":  # says what to do with the image afterwards
            number = document.number(where, value)
            if number is not None and (number < 0 or number % 1):
                document.problems.add(where, "not a number of pixels", got=value, expected="a whole number from 0 on")
            values[key] = int(number or 0)
    offset, size = ((values.get(a, 0), values.get(b, 0)) for a, b in (("x_offset", "y_offset"), ("width", "height")))
    if size == (0, 0) and offset == (0, 0):
        return ImageWindow(binning=(binning[0], binning[1]))
    if 0 in size:
        document.problems.add(entry.where, "the region has no size", got=entry.value, expected="width and height")
        return ImageWindow()
    if whole is not None and any(o + s > n for o, s, n in zip(offset, size, whole, strict=True)):
        got, expected = f"{size[0]} x {size[1]} px at {offset}", f"within {whole[0]} x {whole[1]} px"
        document.problems.add(entry.where, "the region reaches beyond the image", got=got, expected=expected)
    return ImageWindow(offset, size if size != whole else None, (binning[0], binning[1]))


def _binning(account: KeyAccount, names: frozenset[str]) -> int:
    entry = account.take(names)
    if entry is None:
        return 1
    number = account.document.number(entry.where, entry.value)
    if number is None:
        return 1
    if number < 0 or number % 1 or number > 64:
        expected = "a whole number; 0 and 1 mean no binning"
        account.document.problems.add(entry.where, "not a binning", got=entry.value, expected=expected)
        return 1
    return max(int(number), 1)
