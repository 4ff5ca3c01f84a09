"""HALCON's internal camera parameters: an area-scan camera with the division or the polynomial model, in metres.

Places are in m on the sensor there; here they are tangents: kappa, in 1/m², times the focal length squared,
in m², is the coefficient of tangents, and so on.
"""

from __future__ import annotations

import re
from typing import ClassVar

from ...geometry import Lens
from .camera_file import CameraFile, Stated
from .models.foreign_lens import replaced_by_radial_tangential
from .models.inverse_lens import ImageFrame, Rays, brown_conrady_rays, division_rays
from .models.plausible_camera import implausible_calibration
from .reading.calibration_document import CalibrationDocument
from .reading.found_cameras import only_or_named

__all__ = ["HalconFormat"]

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_ENTRY = re.compile(
    rf"^[ \t]*([A-Za-z][A-Za-z0-9]*)[ \t]*:[ \t]*([A-Za-z][A-Za-z0-9_]*)[ \t]*:\s*({_NUMBER})[ \t]*;", re.M
)
_HEAD = re.compile(r"^[ \t]*([A-Za-z][A-Za-z0-9]*)[ \t]*:[ \t]*[A-Za-z]\w*[ \t]*:", re.M)
_DIVISION, _POLYNOMIAL = ("Kappa",), ("K1", "K2", "K3", "P1", "P2")
_NEEDED = ("Focus", "Sx", "Sy", "Cx", "Cy", "ImageWidth", "ImageHeight")
_LONGEST_FOCUS_M, _LARGEST_PIXEL_M = 2.0, 1e-3
_REFUSED = {
    "Vx": "line-scan cameras move while the image is taken, which is not modelled",
    "Tilt": "tilt lenses are not known here",
    "Rot": "tilt lenses are not known here",
    "Magnification": "telecentric lenses have no focal length in px",
    "ImagePlaneDist": "tilt lenses are not known here",
}


class HalconFormat:
    """Camera parameters as ``write_cam_par`` of HALCON writes them (.cal, .dat)."""

    name: ClassVar[str] = "HALCON"
    described: ClassVar[str] = "HALCON's camera parameters"
    cannot_say: ClassVar[str] = "nothing; telecentric, tilt and line-scan cameras are refused by name"

    def recognises(self, document: CalibrationDocument) -> bool:
        """Whether there is a group of parameters, or a focal length as HALCON writes it."""
        return re.search(r"^\s*(?:ParGroup\s*:|Focus\s*:\s*foc\s*:)", document.text, re.M) is not None

    def read(self, document: CalibrationDocument, stated: Stated) -> CameraFile | None:
        """The calibration; None where a problem was noted."""
        if only_or_named(document, [""], stated.name) is None:
            return None
        values = _values(document)
        if values is None:
            return None
        focus = values["Focus"]
        focal = focus / values["Sx"], focus / values["Sy"]
        centre = values["Cx"], values["Cy"]
        size = document.resolution(("ImageWidth",), [values["ImageWidth"], values["ImageHeight"]])
        if size is None:
            return None
        lens, notes = self._lens(document, values, ImageFrame(focal, centre, size))
        if document.problems.found:
            return None
        findings = tuple(implausible_calibration(focal, centre, lens, size, str(document.path)))
        return CameraFile(self.name, focal, centre, lens, size, None, findings, notes)

    def _lens(
        self, document: CalibrationDocument, values: dict[str, float], frame: ImageFrame
    ) -> tuple[Lens | None, tuple[str, ...]]:
        focus = values["Focus"]
        k1, k2, k3, p1, p2 = (values.get(name, 0.0) for name in _POLYNOMIAL)
        rays: Rays
        if values.get("Kappa"):
            rays, name = division_rays(values["Kappa"] * focus**2), "division"
        elif any((k1, k2, k3, p1, p2)):
            # HALCON's P1 goes with x, which is p2 here
            tangents = (k1 * focus**2, k2 * focus**4, p2 * focus, p1 * focus, k3 * focus**6)
            rays, name = brown_conrady_rays(tangents), "polynomial"
        else:
            return None, ()
        made = replaced_by_radial_tangential(document, ("Kappa",) if name == "division" else ("K1",), name, rays, frame)
        return (None, ()) if made is None else (made.lens, (made.note,))


def _values(document: CalibrationDocument) -> dict[str, float] | None:
    """The parameters by name, as written, in m; None where a problem was noted."""
    problems, text = document.problems, document.text
    values: dict[str, float] = {}
    for match in _ENTRY.finditer(text):
        line = text.count("\n", 0, match.start(1)) + 1
        name = match[1]
        if name in values:
            problems.add((name,), "the parameter is there twice", line=line, hint="remove one")
        values[name] = float(match[3])
        if name in _REFUSED:
            problems.add((name,), _REFUSED[name], line=line, got=match[3])
        elif name not in (*_NEEDED, *_DIVISION, *_POLYNOMIAL):
            expected = ", ".join((*_NEEDED, *_DIVISION, *_POLYNOMIAL))
            problems.add((name,), "the parameter is not known here", line=line, got=match[3], expected=expected)
    for name in sorted(set(_HEAD.findall(text)) - values.keys() - {"ParGroup"}):
        problems.add((name,), "not a parameter with a number", expected=f"{name}:name: 0.012;")
    missing = [name for name in _NEEDED if name not in values]
    if missing and not problems.found:
        problems.add((missing[0],), "the parameter is missing", expected=", ".join(_NEEDED))
    if "Kappa" in values and values.keys() & set(_POLYNOMIAL):
        problems.add(("Kappa",), "the file has the division and the polynomial model", hint="remove one")
    if problems.found:
        return None
    if values["Focus"] == 0:
        problems.add(("Focus",), "the focal length is 0: telecentric lenses have no focal length in px")
    elif not 0 < values["Focus"] < _LONGEST_FOCUS_M:
        problems.add(("Focus",), "not a focal length in m", got=values["Focus"], expected="metres, such as 0.012")
    for name in ("Sx", "Sy"):
        if not 0 < values[name] < _LARGEST_PIXEL_M:
            problems.add((name,), "not the width of a pixel in m", got=values[name], expected="metres, such as 2.4e-06")
    return None if problems.found else values
