"""Calibrations as OpenCV and ROS write them alike: a camera matrix and distortion coefficients."""

from __future__ import annotations

from .camera_file import CalibrationDocument, CameraFile

__all__ = ["has_camera_matrix", "read_camera_matrix"]

_MATRIX = ("camera_matrix", "cameraMatrix", "Camera_Matrix", "intrinsic_matrix", "K", "k", "M1", "mtx")
_DISTORTION = (
    "distortion_coefficients",
    "distortion_coefficents",  # as ROS once wrote it
    "distCoeffs",
    "dist_coeffs",
    "Distortion_Coefficients",
    "D",
    "d",
    "D1",
    "dist",
)
_SIZE = (("image_width", "image_height"), ("image_Width", "image_Height"), ("width", "height"))


def has_camera_matrix(document: CalibrationDocument) -> bool:
    """Whether there is a camera matrix, under any of its names."""
    return any(key in document.sections for key in _MATRIX)


def read_camera_matrix(document: CalibrationDocument, name: str | None, format_: str) -> CameraFile | None:
    """The calibration, of a format of this name; None where a problem was noted."""
    sections, problems = document.sections, document.problems
    if name is not None:
        problems.add((), "the file has one camera without a name", got=name, hint="leave the name out")
    key = next(key for key in _MATRIX if key in sections)
    matrix = document.matrix((key,), sections[key], (3, 3))
    where = next((key for key in _DISTORTION if key in sections), None)
    given = sections.get(where) if where else []
    values = given.get("data") if isinstance(given, dict) else given
    flat = (
        [item for row in values for item in (row if isinstance(row, list) else [row])]
        if isinstance(values, list)
        else values
    )
    coefficients = document.numbers((where or key,), flat, None)
    model = sections.get("distortion_model")
    if model is None:
        fisheye = sections.get("fisheye_model") in (1, True)
        model = "equidistant" if fisheye else "plumb_bob"
    lens = document.lens(str(model), coefficients, (where or key,))
    size = next(([sections[a], sections[b]] for a, b in _SIZE if {a, b} <= sections.keys()), None)
    resolution = document.resolution(("image_width",), document.numbers(("image_width",), size, (2,), optional=True))
    covariance = document.covariance(sections, (), lens)
    if matrix is None:
        return None
    if abs(matrix[0, 1]) > 1e-6 * abs(matrix[0, 0]):
        problems.add((key,), "skew is not known here", got=matrix[0, 1], expected="0 in row 1, column 2")
    focal, centre = (matrix[0, 0], matrix[1, 1]), (matrix[0, 2], matrix[1, 2])
    pairs = (float(focal[0]), float(focal[1])), (float(centre[0]), float(centre[1]))
    return document.checked(CameraFile(format_, *pairs, lens, resolution, covariance), (key,))
