"""What the writers share: the size that a format needs, the model's name there, and numbers with every digit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ....exceptions import InputError
from ..camera_file import CameraFile

__all__ = ["coefficients_within", "listed", "required_size"]


def required_size(camera: CameraFile, program: str) -> tuple[int, int]:
    """Columns and rows; raises InputError where they are not known."""
    if camera.resolution is None:
        raise InputError(
            f"{program} needs the size of the image, which the calibration does not say",
            key="--size",
            expected="columns x rows: 1920x1080",
        )
    return camera.resolution


def coefficients_within(camera: CameraFile, counts: Mapping[str, tuple[int, ...]], program: str) -> list[float]:
    """The lens's coefficients, brought to a number that the program knows by leaving out or adding zeros at the end.

    Parameters
    ----------
    counts
        The numbers that the program knows, ascending, by the lens's model.

    Raises
    ------
    InputError
        Where the program knows no lens of so many coefficients.
    """
    assert camera.lens is not None  # callers ask for a lens
    values = list(camera.lens.coefficients)
    while values and values[-1] == 0.0:
        values.pop()
    known = counts.get(camera.lens.model, ())
    count = next((count for count in known if count >= len(values)), None)
    if count is None:
        raise InputError(
            f"{program} has no lens with these coefficients",
            got=f"{camera.lens.model}, {len(values)} coefficients",
            expected=f"at most {max(known)} coefficients" if known else "another model",
            hint="calibrate with fewer coefficients, or write it for OpenCV (--as opencv)",
        )
    return values + [0.0] * (count - len(values))


def listed(values: Iterable[float]) -> str:
    """Numbers in brackets, every digit kept."""
    return f"[{', '.join(repr(float(value)) for value in values)}]"
