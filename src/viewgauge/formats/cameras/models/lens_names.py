"""The names by which programs call one and the same lens model."""

from __future__ import annotations

import re
from enum import Enum

__all__ = ["LensKind", "lens_kind", "lens_names"]


class LensKind(Enum):
    """What a name says of the lens."""

    RADIAL_TANGENTIAL = "radial-tangential"
    EQUIDISTANT = "equidistant"
    NONE = "none"
    UNSAID = "pinhole"
    """A name of the projection before the lens, or of the sensor, which says nothing of distortion."""
    INVERSE_RADIAL_TANGENTIAL = "inverse radial-tangential"
    MODIFIED_RADIAL_TANGENTIAL = "modified radial-tangential"
    F_THETA = "f-theta"


_NAMES = {
    LensKind.RADIAL_TANGENTIAL: "plumb_bob rational_polynomial rational radtan radtan8 radial-tangential "
    "radialtangential8 radial_tangential_distortion brown brown_conrady brown_conrady5 brownconradydistortion opencv "
    "opencv4 opencv5 opencv8 opencv12 full_opencv radial polynomial thin_prism plumb_bob_8 standard",
    LensKind.EQUIDISTANT: "equidistant equi fisheye kannala_brandt kannala_brandt4 kannala_brandt_4 kb kb4 kb8 "
    "opencv_fisheye fisheye_opencv equidistant_distortion pinhole_equidistant equidistant4 opencvfisheye cv_fisheye",
    LensKind.NONE: "none no_distortion nodistortion undistorted",
    LensKind.UNSAID: "pinhole perspective mono monocular rgb color colour camera frame pinhole_camera pinhole_model",
    LensKind.INVERSE_RADIAL_TANGENTIAL: "inverse_brown_conrady",
    LensKind.MODIFIED_RADIAL_TANGENTIAL: "modified_brown_conrady",
    LensKind.F_THETA: "ftheta f_theta",
}
_KINDS = {re.sub(r"[^a-z0-9]", "", name.lower()): kind for kind, names in _NAMES.items() for name in names.split()}


def lens_kind(name: str) -> LensKind | None:
    """What a name says of the lens; None for an unknown one. An empty name says nothing."""
    plain = re.sub(r"[^a-z0-9]", "", name.lower())
    plain = plain.removeprefix("distortion").removesuffix("distortion")
    return _KINDS.get(plain, LensKind.UNSAID if not plain else None)


def lens_names() -> str:
    """Usual names, for messages."""
    return "plumb_bob, rational_polynomial, radtan, radial-tangential, equidistant, fisheye, kannala_brandt, none"
