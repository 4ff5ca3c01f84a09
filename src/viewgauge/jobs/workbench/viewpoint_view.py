"""What the camera sees from viewpoints, small enough to be shown."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from ...evaluation import TableBlock
from ...formats.files.images import encoded_png
from ...geometry import invert, transform
from ...part import Characteristic, Mesh
from ...planning.improve.knob_values import with_pixel_pitch
from ...report import SeenCharacteristic, ViewpointView
from ...sensors import Camera
from ...simulation.renderer import Renderer
from ...visibility import REASONS

__all__ = ["ViewpointViews"]

_WIDTH_PX = 480
_RAYS = 8


class ViewpointViews:
    """Makes the views of viewpoints; the part is made ready once.

    Parameters
    ----------
    mesh
        The part's mesh.
    """

    def __init__(self, mesh: Mesh) -> None:
        self._renderer = Renderer(mesh.vertices, mesh.triangles, rays_per_pixel=_RAYS)

    def view(
        self,
        name: str,
        T_part_camera: NDArray[np.float64],
        camera: Camera,
        characteristics: tuple[Characteristic, ...],
        table: TableBlock,
        row: int = 0,
        planned: Mapping[str, Collection[str | None]] | None = None,
    ) -> ViewpointView:
        """The view of one viewpoint.

        Parameters
        ----------
        table, row
            The table of these characteristics, and the viewpoint's row in it.
        planned
            The viewpoints that each characteristic is measured from, by id.
        """
        seen = []
        part_to_camera = invert(T_part_camera)
        for j, characteristic in enumerate(characteristics):
            visible, ends = bool(table.visible[row, j]), None
            if visible:
                measurand = characteristic.measurands[int(table.measurand[row, j])]
                points = transform(part_to_camera, np.stack([measurand.start, measurand.end]))
                ends = camera.to_pixels(camera.project(points))
            seen.append(
                SeenCharacteristic(
                    characteristic.id,
                    REASONS[int(table.reason[row, j])],
                    ends,
                    float(table.probability[row, j]) if visible else 0.0,
                    name in (planned or {}).get(characteristic.id, ()),
                )
            )
        small = smaller_camera(camera, _WIDTH_PX)
        light = self._renderer.radiance(T_part_camera, small)
        grey = np.clip(np.rint(255 * light ** (1 / 1.6)), 0, 255).astype(np.uint8)
        return ViewpointView(name, encoded_png(grey), camera.resolution, tuple(seen))


def smaller_camera(camera: Camera, width_px: int) -> Camera:
    """A camera that sees the same with at most so many columns, and without errors."""
    return with_pixel_pitch(camera.without_errors, max(camera.resolution[0] / width_px, 1.0))
