"""What the camera sees from settings, small enough to be shown."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from ...evaluation import TableBlock
from ...formats.files.images import encoded_png
from ...geometry import invert, transform
from ...part import Dimension, Mesh
from ...planning.improve.knob_values import with_pixel_pitch
from ...report import SeenDimension, SettingView
from ...sensors import Camera
from ...simulation.renderer import Renderer
from ...visibility import REASONS

__all__ = ["SettingViews"]

_WIDTH_PX = 480
_RAYS = 8


class SettingViews:
    """Makes the views of settings; the part is made ready once.

    Parameters
    ----------
    mesh
        Of the part.
    """

    def __init__(self, mesh: Mesh) -> None:
        self._renderer = Renderer(mesh.vertices, mesh.triangles, rays_per_pixel=_RAYS)

    def view(
        self,
        name: str,
        T_part_camera: NDArray[np.float64],
        camera: Camera,
        dimensions: tuple[Dimension, ...],
        table: TableBlock,
        row: int = 0,
        planned: Mapping[str, Collection[str | None]] | None = None,
    ) -> SettingView:
        """The view of one setting.

        Parameters
        ----------
        table, row
            The table of these dimensions, and the setting's row in it.
        planned
            The settings that each dimension is measured from, by id.
        """
        seen = []
        part_to_camera = invert(T_part_camera)
        for j, dimension in enumerate(dimensions):
            visible, ends = bool(table.visible[row, j]), None
            if visible:
                gauge = dimension.gauges[int(table.gauge[row, j])]
                points = transform(part_to_camera, np.stack([gauge.start, gauge.end]))
                ends = camera.to_pixels(camera.project(points))
            seen.append(
                SeenDimension(
                    dimension.id,
                    REASONS[int(table.reason[row, j])],
                    ends,
                    float(table.probability[row, j]) if visible else 0.0,
                    name in (planned or {}).get(dimension.id, ()),
                )
            )
        small = smaller_camera(camera, _WIDTH_PX)
        light = self._renderer.radiance(T_part_camera, small)
        grey = np.clip(np.rint(255 * light ** (1 / 1.6)), 0, 255).astype(np.uint8)
        return SettingView(name, encoded_png(grey), camera.resolution, tuple(seen))


def smaller_camera(camera: Camera, width_px: int) -> Camera:
    """A camera that sees the same with at most so many columns, and without errors."""
    return with_pixel_pitch(camera.without_errors, max(camera.resolution[0] / width_px, 1.0))
