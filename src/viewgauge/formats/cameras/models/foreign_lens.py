"""Lens models not known here, read by way of a radial-tangential lens that agrees within a hundredth of a px."""

from __future__ import annotations

from dataclasses import dataclass

from ....geometry import Lens
from ...files.problems import KeyPath
from ..reading.calibration_document import CalibrationDocument
from .inverse_lens import (
    LARGEST_RESIDUAL_PX,
    ImageFrame,
    Rays,
    brown_conrady_rays,
    modified_brown_conrady_rays,
    replaced_lens,
)
from .lens_names import LensKind

__all__ = ["ForeignLens", "replaced_by_radial_tangential", "replaced_foreign_lens"]


@dataclass(frozen=True)
class ForeignLens:
    """The lens in place of a foreign one, and what is said about it."""

    lens: Lens
    note: str


def replaced_foreign_lens(
    document: CalibrationDocument, where: KeyPath, kind: LensKind, values: list[float], frame: ImageFrame | None
) -> ForeignLens | None:
    """The lens in place of one of RealSense's models; None where a problem was noted."""
    if kind is LensKind.F_THETA:
        hint = "calibrate the lens with the fisheye model of OpenCV (Kannala-Brandt)"
        document.problems.add(where, "the f-theta model is not known here", got=values, hint=hint)
        return None
    if len(values) == 4:
        values = [*values, 0.0]
    if len(values) != 5:
        document.problems.add(where, "another number of coefficients", got=f"{len(values)} numbers", expected="5")
        return None
    five = tuple(values)
    inverse = kind is LensKind.INVERSE_RADIAL_TANGENTIAL
    rays = brown_conrady_rays(five) if inverse else modified_brown_conrady_rays(five)
    name = "inverse Brown-Conrady" if inverse else "modified Brown-Conrady"
    return replaced_by_radial_tangential(document, where, name, rays, frame)


def replaced_by_radial_tangential(
    document: CalibrationDocument, where: KeyPath, name: str, rays: Rays, frame: ImageFrame | None
) -> ForeignLens | None:
    """The radial-tangential lens in place of a model by its rays; None where a problem was noted.

    Parameters
    ----------
    name
        The model's name, for messages.
    frame
        Where the image lies; None where its size is not known.
    """
    if frame is None:
        document.problems.add(
            where,
            f"the {name} model is converted over the image, whose size the file does not say",
            expected="columns and rows",
            hint="say it: camera.resolution in the inspection file, --size on the command line",
        )
        return None
    replaced = replaced_lens(rays, frame)
    if replaced is None or not replaced.residual_px <= LARGEST_RESIDUAL_PX:
        document.problems.add(
            where,
            f"the {name} model cannot be converted here",
            got="none" if replaced is None else f"the nearest is {replaced.residual_px:.2g} px off",
            expected=f"a lens that a radial-tangential one replaces within {LARGEST_RESIDUAL_PX} px over the image",
            hint="calibrate with the model of OpenCV, or convert the file with the program that wrote it",
        )
        return None
    residual = replaced.residual_px
    most = f"{residual:.1g}" if residual >= 1e-6 else "less than 1e-06"
    count = len(replaced.lens.coefficients)
    return ForeignLens(
        replaced.lens,
        f"{name} model converted to a radial-tangential one ({count} coefficients): at most {most} px off in the image",
    )
