"""What is implausible in samples of a pose error, with the likely cause: units, orders, inverses, rows that slipped."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...findings import Finding
from ...geometry import invert, pose_from_quaternion, quaternion_from_pose

__all__ = ["error_findings", "pair_findings", "position_findings", "rotation_angles"]

_RADIUS_MM = 300.0
"""A turn of one rad counts as much as this shift."""

_LEAST_TRAVEL_MM = 5.0
_LEAST_MM, _MOST_MM, _REFUSED_MM, _MOST_MEAN_MM = 5e-4, 10.0, 30.0, 50.0
_MOST_RAD, _MOST_MEAN_RAD = np.radians(3.0), np.radians(10.0)
_NEAREST_MM, _FARTHEST_MM = 10.0, 4000.0  # of the ratio of the two deviations
_FAR = 20.0  # times the median error
_BETTER = 10.0  # times smaller errors are what another reading must give
_DOUBTFUL = 1e-3  # mean error from which on other readings are tried, of _RADIUS_MM and rad
_FITS = 0.02
_FEWEST_SLIPPED = 3

Poses = NDArray[np.float64]


def position_findings(positions_mm: NDArray[np.float64], where: str) -> Iterator[Finding]:
    """Whether positions ``(n, 3)`` are those of a robot in mm."""
    largest = float(np.abs(positions_mm).max(initial=0.0))
    if 0 < largest < _LEAST_TRAVEL_MM:
        yield Finding(
            "pose_positions",
            f"every coordinate is within {largest:.3g} mm of the origin",
            "a robot's travel of 50 mm and more",
            "metres under the names of mm (name the columns x_m, y_m, z_m)",
            where,
            refused=True,
        )
    elif largest > 5e4:
        yield Finding(
            "pose_positions",
            f"a coordinate is {largest:.3g} mm",
            "a reach of some metres",
            "um under the names of mm, or mm under those of m",
            where,
            refused=True,
        )


def error_findings(errors: NDArray[np.float64], names: Sequence[str], where: str) -> Iterator[Finding]:
    """What is implausible in errors ``(n, 6)``, mm and rad, translation first."""
    if len(errors) < 2:
        return
    yield from _far(errors, names, where)
    shift, turn = (float(np.sqrt(errors[:, part].var(axis=0).mean())) for part in (slice(0, 3), slice(3, 6)))
    if shift == 0 and turn == 0:
        yield Finding("pose_translation", "all errors are equal", "scatter", where=where, refused=True)
        return
    if 0 < shift < _LEAST_MM or shift > _MOST_MM:
        cause = (
            "m under the names of mm" if shift < _LEAST_MM else "um under the names of mm, or poses that do not match"
        )
        found = f"the standard deviation of the position is {shift:.3g} mm"
        refused = not _LEAST_MM < shift < _REFUSED_MM
        yield Finding("pose_translation", found, "1 um to 10 mm", cause, where, refused=refused)
    if turn > _MOST_RAD:
        found = f"the standard deviation of the orientation is {np.degrees(turn):.3g} deg"
        cause = "deg under the names of rad, or poses that do not match"
        yield Finding("pose_rotation", found, "at most 3 deg", cause, where, refused=True)
    mean = errors.mean(axis=0)
    far, turned = float(np.linalg.norm(mean[:3])), float(np.linalg.norm(mean[3:]))
    if far > max(_MOST_MEAN_MM, 3 * shift) or turned > max(_MOST_MEAN_RAD, 3 * turn):
        found = f"the mean error is {far:.3g} mm and {np.degrees(turned):.3g} deg"
        cause = "commanded and measured poses of two frames (base or tool)"
        yield Finding("pose_mean", found, "some mm", cause, where, refused=True)
    if shift > 0 and turn > 0 and not _NEAREST_MM < shift / turn < _FARTHEST_MM:
        small = shift / turn > 1e3
        found = f"standard deviations of {shift:.3g} mm and {1e3 * np.degrees(turn):.3g} mdeg are of no one robot"
        usual = "an orientation held as well as the position at 0.01 to 4 m from it"
        cause = (
            "angles in rad under the names of deg or mrad" if small else "angles in deg or mrad under the names of rad"
        )
        if not small:
            cause += ", or lengths in m under the names of mm"
        yield Finding("pose_rotation", found, usual, cause, where, refused=True)


def _far(errors: NDArray[np.float64], names: Sequence[str], where: str) -> Iterator[Finding]:
    about = errors - np.median(errors, axis=0)
    for part, unit, scale in ((slice(0, 3), "mm", 1.0), (slice(3, 6), "deg", 180 / np.pi)):
        size = np.linalg.norm(about[:, part], axis=1)
        usual = float(np.median(size))
        rows = np.flatnonzero(size > _FAR * usual)
        if usual > 0 and 0 < len(rows) < len(size) / 4:
            found = f"the error of {_some([names[int(k)] for k in rows])} is {scale * size[rows].max():.4g} {unit}"
            ordinary = f"{scale * usual:.2g} {unit}, the median of this file"
            yield Finding("far_sample", found, ordinary, "a wrong row", where, refused=True)


@dataclass(frozen=True)
class _Reading:
    """Another meaning of the measured (or commanded) poses: what it says, and the poses by it."""

    cause: str
    measured: Callable[[Poses], Poses]
    commanded: Callable[[Poses], Poses]


def pair_findings(commanded: Poses, measured: Poses, names: Sequence[str], where: str) -> Iterator[Finding]:
    """Whether poses ``(n, 4, 4)`` mm were measured as they were commanded, by trying other meanings of them."""
    error = _mismatch(commanded, measured)
    if len(error) < 2 or np.median(error) < _DOUBTFUL:
        if len(error) >= 2:
            yield from _slipped(commanded, measured, error, names, where)
        return
    best, cause = float(np.median(error)) / _BETTER, ""
    for reading in _readings():
        left = float(np.median(_mismatch(reading.commanded(commanded), reading.measured(measured))))
        if left < best:
            best, cause = left, reading.cause
    if cause:
        shift, turn = _typical(commanded, measured)
        found = f"measured and commanded poses differ by {shift:.4g} mm and {turn:.3g} deg (medians)"
        yield Finding("pose_pairs", found, "some mm and less than 1 deg", cause, where, refused=True)
        return
    slipped = list(_slipped(commanded, measured, error, names, where))
    yield from slipped
    if not slipped:
        yield from _of_two_frames(commanded, measured, where)


def _typical(commanded: Poses, measured: Poses) -> tuple[float, float]:
    shift = np.linalg.norm(measured[:, :3, 3] - commanded[:, :3, 3], axis=1)
    return float(np.median(shift)), float(np.degrees(np.median(rotation_angles(commanded, measured))))


def rotation_angles(first: Poses, second: Poses) -> NDArray[np.float64]:
    """``(n,)`` rad: by which the rotations of two poses differ."""
    trace = np.einsum("nij,nij->n", first[:, :3, :3], second[:, :3, :3])
    chord = np.linalg.norm(first[:, :3, :3] - second[:, :3, :3], axis=(1, 2))  # exact where the angle is small
    small = 2 * np.arcsin(np.clip(chord / np.sqrt(8), 0, 1))
    return np.asarray(np.where(trace > 2, small, np.arccos(np.clip((trace - 1) / 2, -1, 1))))


def _mismatch(commanded: Poses, measured: Poses) -> NDArray[np.float64]:
    shift = np.linalg.norm(measured[:, :3, 3] - commanded[:, :3, 3], axis=1)
    return np.asarray(shift / _RADIUS_MM + rotation_angles(commanded, measured))


def _readings() -> Iterator[_Reading]:
    def same(poses: Poses) -> Poses:
        return poses

    units = [("", 1.0)] + [
        (f"the units: the measured positions are {text} too {size} (a factor of {text})", factor)
        for text, factors in (("1000", 1000.0), ("25.4", 25.4), ("10", 10.0))
        for size, factor in (("small", factors), ("large", 1 / factors))
    ]
    turns: list[tuple[str, Callable[[Poses], Poses]]] = [
        ("", same),
        ("the order of the quaternion: the measured one is x y z w under the names w x y z", _scalar_was_last),
        ("the order of the quaternion: the measured one is w x y z under the names x y z w", _scalar_was_first),
        ("the measured poses are the inverse of what was commanded", invert),
        ("the measured rotations are transposed", _transposed),
    ]
    for unit, factor in units:
        for turn, reading in turns:
            causes = [text for text in (unit, turn) if text]
            if causes:
                yield _Reading(" and ".join(causes), partial(_scaled_then, factor, reading), same)
    orders = (
        ("x y z w under the names w x y z", _scalar_was_last),
        ("w x y z under the names x y z w", _scalar_was_first),
    )
    for last, reading in orders:
        yield _Reading(f"the order of the quaternion: the commanded one is {last}", same, reading)


def _scaled_then(factor: float, reading: Callable[[Poses], Poses], poses: Poses) -> Poses:
    scaled = poses.copy()
    scaled[:, :3, 3] *= factor
    return reading(scaled)


def _reordered(poses: Poses, order: list[int]) -> Poses:
    quaternions = quaternion_from_pose(poses)[:, order]
    return np.asarray(pose_from_quaternion(poses[:, :3, 3], quaternions))


def _scalar_was_last(poses: Poses) -> Poses:
    return _reordered(poses, [3, 0, 1, 2])


def _scalar_was_first(poses: Poses) -> Poses:
    return _reordered(poses, [1, 2, 3, 0])


def _transposed(poses: Poses) -> Poses:
    turned = poses.copy()
    turned[:, :3, :3] = poses[:, :3, :3].swapaxes(1, 2)
    return turned


def _slipped(
    commanded: Poses, measured: Poses, error: NDArray[np.float64], names: Sequence[str], where: str
) -> Iterator[Finding]:
    """Rows whose measured pose is that of another row."""
    n = len(error)
    bad = np.flatnonzero(error > _FITS)
    if len(bad) < _FEWEST_SLIPPED or n > 5000:
        return
    all_of = np.array([_mismatch(commanded, np.broadcast_to(measured[k], commanded.shape)) for k in bad])
    nearest = all_of.argmin(axis=1)
    fits = (all_of.min(axis=1) < np.minimum(error[bad] / _BETTER, _FITS)) & (nearest != bad)
    if fits.sum() < max(_FEWEST_SLIPPED, 0.6 * len(bad)):
        return
    steps = (nearest - bad)[fits]
    step = int(np.median(steps))
    first = int(bad[fits][0])
    if (steps == step).mean() > 0.6 and step:
        side = "below" if step > 0 else "above"
        neighbour = f"the row {side}" if abs(step) == 1 else f"the row {abs(step)} rows {side}"
        start = f"after row {first} ({names[first - 1]})" if first else "from the first row on"
        found = f"{start} {fits.sum()} rows are measured as their neighbour, {neighbour}, was commanded"
        cause = "a measurement is missing or there twice, and the rows below it have moved"
    else:
        found = f"{fits.sum()} rows are measured as other rows were commanded, the first of them row {first + 1}"
        found += f" ({names[first]})"
        cause = "commanded and measured poses are in two orders"
    yield Finding("rows_do_not_match", found, "rows of one pose each", cause, where, refused=True)


def _of_two_frames(commanded: Poses, measured: Poses, where: str) -> Iterator[Finding]:
    """Whether one constant transform, on the left (base) or on the right (tool), makes the poses equal."""
    before = float(np.median(_mismatch(commanded, measured)))
    if before < _FITS:
        return
    for k, side in ((0, "base or tracker"), (1, "flange or tool")):
        offsets = measured @ invert(commanded) if k == 0 else invert(commanded) @ measured
        spread = [np.median(_mismatch(offsets, np.broadcast_to(offset, offsets.shape))) for offset in offsets]
        constant = offsets[int(np.argmin(spread))]
        moved = constant @ commanded if k == 0 else commanded @ constant
        if float(np.median(_mismatch(moved, measured))) < before / _BETTER:
            shift, turn = _typical(commanded, measured)
            found = (
                f"measured and commanded poses differ by {shift:.4g} mm and {turn:.3g} deg (medians), and constantly"
            )
            cause = f"they are in two frames: express both in the same {side} frame"
            yield Finding("pose_pairs", found, "some mm and less than 1 deg", cause, where, refused=True)
            return


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
