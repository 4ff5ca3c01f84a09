"""What a lens shows is in the image or not as the pixels say."""

from dataclasses import replace

import numpy as np
import pytest

from viewgauge.geometry import Lens, invert, look_at, transform, view_block
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.sensors import Camera
from viewgauge.visibility import REASONS, Culling, ObservationLimits

PINHOLE = Camera(6.0, (0.00345, 0.00345), (2448, 2048))
LENSES = {
    "barrel": Lens("radial-tangential", (-0.12, 0.01, 0, 0)),
    "pincushion": Lens("radial-tangential", (0.15, 0.05, 1e-3, 0)),
    "fisheye": Lens("equidistant", (0, 0, 0, 0)),
}


@pytest.mark.parametrize("lens", LENSES.values(), ids=LENSES)
def test_a_measurand_is_out_of_view_where_a_pixel_of_its_ends_is(lens):
    camera, limits = replace(PINHOLE, lens=lens), ObservationLimits(margin_px=20, minimum_length_px=0)
    rng = np.random.default_rng(1)
    count, poses = 400, np.array([look_at(rng.normal(0, 1, 3) * 150, rng.normal(0, 30, 3)) for _ in range(60)])
    points = rng.normal(0, 60, (count, 2, 3))
    normals = rng.normal(0, 1, (count, 2, 6, 3))
    normals = np.concatenate([normals, -normals], axis=2)  # some face is always turned to the camera
    measurands = MeasurandTable(points, normals, np.zeros(count, bool), np.arange(count), np.arange(count))
    reason = Culling(measurands, camera, limits).reasons(view_block(poses), len(poses))[:, : len(poses)]
    seen = transform(invert(poses)[:, None], points.reshape(-1, 3)).reshape(len(poses), count, 2, 3)
    front = (seen[..., 2] > 0).all(axis=-1)
    ideal = camera.project(np.where(front[..., None, None], seen, [0.0, 0, 1]))
    px = camera.to_pixels(ideal)
    inside = ((px >= 19.5) & (px <= np.array([2448, 2048]) - 20.5)).all(axis=(-1, -2))
    # where the lens folds far outside, it puts points back into the image that it does not show
    inside &= np.isclose(camera.from_pixels(px), ideal, atol=1e-6).all(axis=(-1, -2))
    out = np.isin(reason.T, REASONS.index("out_of_view"))
    assert (out[front] == ~inside[front]).all()
    assert 0.05 < inside[front].mean() < 0.95
    pinhole = Culling(measurands, PINHOLE, limits).reasons(view_block(poses), len(poses))[:, : len(poses)]
    assert (pinhole != reason).any(), "the lens matters"


def around(camera, inset_px):
    """``(n, 2)`` px: places all around the image, so far within its edges."""
    (columns, rows), along = camera.resolution, np.linspace(0, 1, 101)
    u, v = (inset_px + along * (size - 2 * inset_px) for size in (columns, rows))
    sides = [(u, u * 0 + w) for w in (inset_px, rows - inset_px)] + [
        (v * 0 + w, v) for w in (inset_px, columns - inset_px)
    ]
    return np.concatenate([np.stack(side, axis=1) for side in sides]) - 0.5


@pytest.mark.parametrize("lens", [*LENSES.values(), Lens("radial-tangential", (-0.1, 0.02, 4e-3, -3e-3))])
@pytest.mark.parametrize(("inset_px", "reason"), [(0.25, ""), (-0.25, "out_of_view")])
def test_what_the_lens_shows_ends_where_the_image_does(lens, inset_px, reason):
    """A quarter of a pixel within an edge of the image a point is in view, as much beyond it is not; all around."""
    camera, limits = replace(PINHOLE, lens=lens), ObservationLimits(0, 0, 0)
    rays = camera.from_pixels(around(camera, inset_px)) / camera.focal_length_mm
    ends = np.tile([0.0, 0.0, 100.0], (len(rays), 2, 1))  # the other one in the middle of the image
    ends[:, 1, :2] = 100 * rays
    normals, each = np.tile([0.0, 0.0, -1.0], (len(rays), 2, 1, 1)), np.arange(len(rays))
    measurands = MeasurandTable(ends, normals, np.zeros(len(rays), bool), each, each)
    found = Culling(measurands, camera, limits).reasons(view_block(np.eye(4)[None]), 1)[:, 0]
    assert {REASONS[code] for code in found} == {reason}
