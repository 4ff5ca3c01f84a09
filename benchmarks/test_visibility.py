"""Visibility: the cheap conditions, and rays beside what Embree does with rays that were made before."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import part
from viewgauge.geometry import VIEWS
from viewgauge.visibility import VISIBLE, Culling, Occluder, SightLines

pytestmark = pytest.mark.benchmark(group="visibility")


@pytest.mark.parametrize("threads", [1, 2])
def test_culling(threads: int, tiny: bool, timed: Callable[..., None]) -> None:
    """All conditions but occlusion."""
    i = part.inspection()
    culling, views = Culling(part.measurands(), i.camera, i.limits), part.blocks(600 if tiny else 30_000)
    timed(
        part.on_threads(threads, lambda block: culling.reasons(block, VIEWS), views),
        count=len(views) * len(part.measurands()) * VIEWS,
        unit="pairs",
        rounds=15,
        name=f"culling, {threads} thread{'s' * (threads > 1)}",
    )


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("way", ["ours", "embree"])
def test_rays(way: str, threads: int, tiny: bool, timed: Callable[..., None]) -> None:
    """Rays from the measurands that pass the other conditions."""
    i = part.inspection()
    occluder = Occluder(i.part.mesh)
    culling, lines = Culling(part.measurands(), i.camera, i.limits), SightLines(part.measurands(), occluder)
    work = []
    for block in part.blocks(600 if tiny else 30_000):
        measurand, viewpoint = np.nonzero(culling.reasons(block, VIEWS) == VISIBLE)
        work.append((block, viewpoint.astype(np.int64), measurand.astype(np.int64)))
    sets = [rays for one in work for rays in _rays_of(lines, *one)]
    if way == "ours":
        call = part.on_threads(threads, lambda one: lines.hidden(*one), work)
    else:
        call = part.on_threads(threads, lambda rays: occluder.blocked(*rays), sets)
    name = "rays of measurands" if way == "ours" else "Embree alone, the same rays, made before"
    count = sum(len(rays[2]) for rays in sets)
    timed(call, count=count, unit="rays", rounds=9, name=f"{name}, {threads} thread{'s' * (threads > 1)}")


def _rays_of(lines: SightLines, *pairs: np.ndarray) -> list[tuple[np.ndarray, ...]]:
    """The rays that are cast for pairs: of each start, of each end whose start is seen, and so on."""
    cast: list[tuple[np.ndarray, ...]] = []
    kept = lines._occluder

    class Noting:
        centre_mm = kept.centre_mm

        def blocked(self, *rays: np.ndarray) -> np.ndarray:
            cast.append(rays)
            return kept.blocked(*rays)

    lines._occluder = Noting()  # type: ignore[assignment]
    lines.hidden(*pairs)
    lines._occluder = kept
    return cast
