"""What of a camera's optics is used only in part, or not modelled."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from ....findings import Finding
from ....sensors import Camera

__all__ = ["camera_findings"]


def camera_findings(camera: Camera, section: Mapping[str, object]) -> Iterator[Finding]:
    """The findings of a camera and of the section of the inspection file that states it."""
    if (radius := camera.field_radius_px) is not None:
        angle = math.degrees(math.atan(camera.field_tangent))
        corners = camera.border_of_sensor_px - np.asarray(camera.principal_point)
        corner = float(np.linalg.norm(corners, axis=1).max())
        yield Finding(
            "field_limited",
            f"the lens model gives each place one direction up to {radius:.0f} px from the principal point "
            f"({radius / corner:.1%} of the way to the farthest corner, {angle:.1f} deg from the axis); the image "
            "beyond is not used",
            cause="a wide lens whose corners lie beyond 90 deg from the axis"
            if angle > 88
            else "the calibration's points did not reach the corners",
            where="camera",
        )
    if "calibration" in section and camera.intrinsics_covariance is None:
        yield Finding(
            "not_calibrated",
            "the calibration states no uncertainty, so that the camera counts as not calibrated: errors of its "
            "intrinsics are in no probability",
            usual="the standard uncertainties that calibration programs print; state them in "
            "camera.calibration_uncertainty, or calibrate with viewgauge characterize --camera",
            where="camera.calibration",
        )
    if section.get("shutter") == "rolling":
        yield Finding(
            "rolling_shutter",
            "a rolling shutter is not modelled: where the camera or the part moves during the exposure, each row is "
            "displaced by the speed times its delay; nothing changes where both stand still",
            cause="images that are taken in motion",
            where="camera.shutter",
        )
    if section.get("colour_filter") == "bayer":
        yield Finding(
            "colour_filter",
            "a Bayer filter is not modelled: of each colour only a half or a quarter of the pixels is measured, so "
            "that edges are noisier and, where a lens has lateral colour, displaced by colour",
            usual="no filter; state in edge_detector the noise of edges in the image as it is converted",
            where="camera.colour_filter",
        )
