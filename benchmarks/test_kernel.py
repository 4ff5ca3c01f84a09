"""From a viewpoint and a measurand to the probability: the compiled kernel beside the same in NumPy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import part
from viewgauge.evaluation import image_segment
from viewgauge.evaluation.compiled.kernel import ProbabilityKernel
from viewgauge.geometry import VIEWS
from viewgauge.visibility import VISIBLE, Culling

pytestmark = pytest.mark.benchmark(group="kernel")

FLOPS = 615
"""Floating-point operations of a pair of this part, counted by hand: projection, Jacobian and variance 120; the law 195
where both quantization errors are small against sigma (24 % of its pairs), 440 where one is (45 %), 800 where none is
(31 %)."""


@pytest.fixture(scope="module")
def kernel() -> ProbabilityKernel:
    """Of the example."""
    i = part.inspection()
    return ProbabilityKernel(part.measurands(), part.tolerances(), i.camera, i.pose_error)


@pytest.mark.parametrize("threads", [1, 2])
def test_kernel(kernel: ProbabilityKernel, threads: int, tiny: bool, timed: Callable[..., None]) -> None:
    """Every pair is evaluated, whether the measurand could be seen or not."""
    views, every = part.blocks(600 if tiny else 30_000), np.full((len(part.measurands()), VIEWS), VISIBLE, np.int8)
    timed(
        part.on_threads(threads, lambda block: kernel.probabilities(block, VIEWS, every), views),
        count=len(views) * every.size,
        unit="pairs",
        rounds=15,
        name=f"kernel, {threads} thread{'s' * (threads > 1)}",
        flops=FLOPS,
    )


@pytest.mark.parametrize("threads", [1, 2])
def test_culling_and_kernel(kernel: ProbabilityKernel, threads: int, tiny: bool, timed: Callable[..., None]) -> None:
    """As a job does it: the kernel gets what the culling leaves."""
    i = part.inspection()
    culling = Culling(part.measurands(), i.camera, i.limits)
    views = part.blocks(600 if tiny else 30_000)
    timed(
        part.on_threads(
            threads, lambda block: kernel.probabilities(block, VIEWS, culling.reasons(block, VIEWS)), views
        ),
        count=len(views) * len(part.measurands()) * VIEWS,
        unit="pairs",
        rounds=15,
        name=f"culling, then kernel, {threads} thread{'s' * (threads > 1)}",
        flops=None,
    )


def test_numpy(kernel: ProbabilityKernel, tiny: bool, timed: Callable[..., None]) -> None:
    """The readable form; it agrees with the kernel to 1e-10."""
    i, block = part.inspection(), part.blocks(600)[0]
    few = min(len(part.measurands()), 3 if tiny else 147)
    rows = block.reshape(15, VIEWS).T
    R, t = rows[:, :9].reshape(-1, 1, 1, 3, 3), rows[:, 9:12].reshape(-1, 1, 1, 3)
    points = (R @ part.measurands().points[:few, :, :, None])[..., 0] + t
    T = part.tolerances()[:few]

    def numpy_form() -> np.ndarray:
        image = image_segment(points[..., 0, :], points[..., 1, :], i.camera, i.pose_error)
        return image.success_probability(T)

    every = np.full((len(part.measurands()), VIEWS), VISIBLE, np.int8)
    front = (points[..., 2] > 0).all(axis=-1)
    ours = kernel.probabilities(block, VIEWS, every)[0][:few].T
    assert np.abs(ours - numpy_form())[front].max() < 1e-10
    timed(numpy_form, count=front.size, unit="pairs", rounds=7, name="NumPy form, 1 thread", flops=FLOPS)
