"""Bodies that touch or overlap, united: what lies between them neither hides nor is seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .orientation import shells

__all__ = ["Union", "united"]

_TOUCHING = 1e-5  # of the diagonal of all bodies: boxes that are nearer touch
_OVERLAP = 2e-6  # of the diagonal: by how much bodies are enlarged that touch but for rounding
_MOST_BODIES = 5_000


@dataclass(frozen=True)
class Union:
    """Bodies that have become one mesh.

    Parameters
    ----------
    vertices, triangles
        ``(n, 3)`` mm and ``(m, 3)``.
    note
        What was done, or why it could not be done; empty where no bodies touch.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    note: str = ""


def united(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> Union:
    """The union of all closed shells that touch, of a mesh whose triangles face outward.

    A shell that is turned inside (a cavity) belongs to the body around it.
    """
    bodies = _bodies(vertices, triangles)
    if len(bodies) < 2:
        return Union(vertices, triangles)
    diagonal = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    clusters = _clusters([vertices[np.unique(body)] for body in bodies], _TOUCHING * diagonal)
    several = [cluster for cluster in clusters if len(cluster) > 1]
    if not several:
        return Union(vertices, triangles)
    touching = sum(len(cluster) for cluster in several)
    unchanged = Union(vertices, triangles, "")
    if len(bodies) > _MOST_BODIES:
        why = f"there are {len(bodies)}, and at most {_MOST_BODIES} are united"
        return Union(vertices, triangles, _failure(touching, why))
    points, faces = [vertices], [body for cluster in clusters if len(cluster) == 1 for body in (bodies[cluster[0]],)]
    count, joined = len(vertices), 0
    for cluster in several:
        try:
            result, before, after = _union(vertices, [bodies[k] for k in cluster], _OVERLAP * diagonal)
        except _NoUnionError as error:
            return Union(vertices, triangles, _failure(touching, str(error)))
        if after == before:  # their boxes touch, they do not
            faces += [bodies[k] for k in cluster]
            continue
        joined += before - after + 1
        points.append(result[0])
        faces.append(result[1] + count)
        count += len(result[0])
    if not joined:
        return unchanged
    note = f"{joined} bodies touch and were united: faces between them neither hide nor have edges"
    return Union(np.concatenate(points), np.concatenate(faces), note)


def _failure(bodies: int, why: str) -> str:
    return (
        f"{bodies} bodies lie close together and could not be united ({why}): edges where they touch may count as "
        "hidden; unite them where the part was drawn"
    )


class _NoUnionError(Exception):
    """The bodies cannot be united; the reason is its text."""


def _bodies(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Triangles of each body: a shell that faces outward, with the cavities within its box."""
    parts = [triangles[shell] for shell in shells(triangles)]
    volumes = np.array([_volume(vertices, part) for part in parts])
    outward = [k for k in range(len(parts)) if volumes[k] > 0]
    boxes = [(vertices[part.ravel()].min(axis=0), vertices[part.ravel()].max(axis=0)) for part in parts]
    bodies = {k: [parts[k]] for k in outward}
    for k in np.flatnonzero(volumes <= 0).tolist():
        around = [
            j for j in outward if (boxes[j][0] <= boxes[k][0]).all() and (boxes[k][1] <= boxes[j][1]).all()
        ]  # the smallest that is around it
        if around:
            bodies[min(around, key=lambda j: volumes[j])].append(parts[k])
    return [np.concatenate(body) for body in bodies.values()]


def _volume(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> float:
    a, b, c = np.moveaxis(vertices[triangles] - vertices[triangles[0, 0]], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def _clusters(points: Sequence[NDArray[np.float64]], apart_mm: float) -> list[list[int]]:
    """Numbers of the bodies, together where a chain of touching boxes joins them."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    low = np.array([p.min(axis=0) for p in points]) - apart_mm
    high = np.array([p.max(axis=0) for p in points])
    first: list[int] = []
    second: list[int] = []
    for k in range(len(points)):
        near = np.flatnonzero(((low <= high[k]) & (low[k] <= high)).all(axis=1))
        first += [k] * len(near)
        second += near.tolist()
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(len(points),) * 2)
    label = connected_components(graph, directed=False)[1]
    return [np.flatnonzero(label == k).tolist() for k in range(label.max() + 1)]


def _union(
    vertices: NDArray[np.float64], bodies: Sequence[NDArray[np.int64]], overlap_mm: float
) -> tuple[tuple[NDArray[np.float64], NDArray[np.int64]], int, int]:
    """The union as vertices and triangles, and the number of separate bodies before and after it.

    Faces that touch but for rounding leave a gap; then each body is enlarged by a few millionths, so that they overlap.
    """
    import manifold3d  # late: only meshes of several bodies need it

    solids = [_solid(vertices, body) for body in bodies]
    result = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add)
    after = len(_outer(result))
    if after > 1 and _near(result, overlap_mm):
        enlarged = manifold3d.Manifold.batch_boolean([_enlarged(s, overlap_mm) for s in solids], manifold3d.OpType.Add)
        if len(_outer(enlarged)) < after:
            result, after = enlarged, len(_outer(enlarged))
    if (status := result.status()) != manifold3d.Error.NoError or result.is_empty():
        raise _NoUnionError(f"manifold3d: {status.name}")
    mesh = result.to_mesh64()
    return (np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts, dtype=np.int64)), len(bodies), after


def _solid(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> Any:
    import manifold3d

    used, numbers = np.unique(triangles, return_inverse=True)
    faces = np.ascontiguousarray(numbers.reshape(-1, 3).astype(np.uint64))
    solid = manifold3d.Manifold(manifold3d.Mesh64(np.ascontiguousarray(vertices[used]), faces))
    if solid.status() != manifold3d.Error.NoError:
        raise _NoUnionError(f"manifold3d: a body is {solid.status().name}")
    return solid


def _outer(solid: Any) -> list[Any]:
    """The separate bodies of a solid."""
    return list(solid.decompose())


def _near(solid: Any, distance_mm: float) -> bool:
    """Whether two separate bodies of a solid are nearer than a distance, without touching."""
    bodies = _outer(solid)
    if len(bodies) > 200:
        return True
    boxes = np.array([body.bounding_box() for body in bodies])  # low x, y, z, high x, y, z
    for k, body in enumerate(bodies):
        for j in range(k):
            apart = np.maximum(boxes[k, :3] - boxes[j, 3:], boxes[j, :3] - boxes[k, 3:]).max()
            if apart <= distance_mm and body.min_gap(bodies[j], 2 * distance_mm) <= distance_mm:
                return True
    return False


def _enlarged(solid: Any, by_mm: float) -> Any:
    """A solid whose box is larger by a length on each side."""
    box = np.array(solid.bounding_box()).reshape(2, 3)
    centre, half = box.mean(axis=0), np.ptp(box, axis=0) / 2
    factor = 1 + by_mm / np.maximum(half, by_mm)
    return solid.translate(tuple(-centre)).scale(tuple(factor)).translate(tuple(centre))
