"""Kalibr's camchain: a section for each camera, with ``intrinsics``, ``distortion_coeffs`` and ``resolution``."""

from __future__ import annotations

from .camera_file import CalibrationDocument, CameraFile

__all__ = ["KalibrFormat"]


class KalibrFormat:
    """Camchains of Kalibr."""

    name, described = "Kalibr", "a Kalibr camchain"

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether there is a section with intrinsics."""
        return bool(_cameras(document))

    def read(self, document: CalibrationDocument, name: str | None) -> CameraFile | None:
        """The calibration of a camera, by default the only one; None where a problem was noted."""
        sections, problems, cameras = document.sections, document.problems, _cameras(document)
        name = name or (cameras[0] if len(cameras) == 1 else None)
        if name not in cameras:
            problem = "no such camera in the file" if name else "the file has several cameras"
            hint = None if name else "name one: calibration_camera in the inspection file, --name in the command"
            problems.add((), problem, got=name, expected=" or ".join(cameras), hint=hint)
            return None
        where, section = (name,), sections[name]
        kind = section.get("camera_model", "pinhole")
        if kind != "pinhole":
            problems.add((*where, "camera_model"), "unknown camera model", got=kind, expected="pinhole")
        numbers = document.numbers((*where, "intrinsics"), section["intrinsics"], (4,))
        coefficients = document.numbers((*where, "distortion_coeffs"), section.get("distortion_coeffs", []), None)
        size = document.numbers((*where, "resolution"), section.get("resolution"), (2,), optional=True)
        lens = document.lens(str(section.get("distortion_model", "none")), coefficients, (*where, "distortion_model"))
        if numbers is None:
            return None
        resolution = document.resolution((*where, "resolution"), size)
        covariance = document.covariance(section, where, lens)
        focal, centre = (numbers[0], numbers[1]), (numbers[2], numbers[3])
        return document.checked(
            CameraFile(self.name, focal, centre, lens, resolution, covariance), (*where, "intrinsics")
        )


def _cameras(document: CalibrationDocument) -> list[str]:
    return [key for key, value in document.sections.items() if isinstance(value, dict) and "intrinsics" in value]
