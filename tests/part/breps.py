"""B-reps built from plain arrays: prisms over a polygon, with drilled holes."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from viewgauge.part import Brep, Edge, Face, Mesh, PmiRecord, Reference

NOWHERE = np.zeros(3)
ARC_POINTS = 33  # of half a turn


def face(index):
    return Reference("face", index)


def edge(index):
    return Reference("edge", index)


def pmi_record(kind, nominal_mm, first, second=(), tolerance_mm=(-0.1, 0.1), name="D", label="size"):
    return PmiRecord(name, kind, label, nominal_mm, tolerance_mm, tuple(first), tuple(second))


class Solid:
    """Collects faces and edges; :meth:`brep` turns them into a Brep."""

    def __init__(self):
        self.faces, self.edges, self.pmi_records, self._lines = [], [], [], {}

    def plane(self, *loops):
        """A flat face with an outer loop, counter-clockwise from outside, and straight inner loops; its index."""
        outer = np.asarray(loops[0], dtype=float)
        normal = sum(np.cross(a - outer[0], b - outer[0]) for a, b in pairwise(outer[1:]))
        index = len(self.faces)
        self.faces.append([("plane", outer[0], normal / np.linalg.norm(normal), np.nan, False), []])
        for loop in loops:
            for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True):
                self._line(index, np.asarray(a, dtype=float), np.asarray(b, dtype=float))
        return index

    def _line(self, face_index, a, b):
        key = frozenset((tuple(np.round(a, 9)), tuple(np.round(b, 9))))
        if key not in self._lines:
            self._lines[key] = len(self.edges)
            self.edges.append({"kind": "line", "points": np.array([a, b]), "faces": [], "normals": []})
        line = self.edges[self._lines[key]]
        line["faces"].append(face_index)
        line["normals"].append(np.tile(self.faces[face_index][0][2], (2, 1)))
        self.faces[face_index][1].append(self._lines[key])

    def cylinder(self, ends, end_faces, radius, *, concave=True, parts=2):
        """A cylindrical surface between two flat faces, in ``parts`` equal faces; their indices.

        ``ends``: two centres; ``end_faces``: the indices of the flat faces at them.
        """
        ends = np.asarray(ends, dtype=float)
        axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        x = np.cross(axis, [0.36, 0.48, 0.8])
        x /= np.linalg.norm(x)
        y = np.cross(axis, x)
        first = len(self.faces)
        indices = list(range(first, first + parts))
        for _ in indices:
            self.faces.append([("cylinder", ends[0], axis, radius, concave), []])
        sweep = 2 * np.pi / parts
        for k, index in enumerate(indices):
            angle = k * sweep + np.linspace(0, sweep, ARC_POINTS)
            radial = np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * y
            for centre, end_face in zip(ends, end_faces, strict=True):
                self._arc(index, end_face, centre, axis, radius, radial, -1 if concave else 1)
            self._ruling(indices[k - 1], index, ends + radius * radial[0], radial[0] * (-1 if concave else 1))
        return indices

    def _arc(self, index, end_face, centre, axis, radius, radial, sense):
        normals = [radial * sense, np.tile(self.faces[end_face][0][2], (len(radial), 1))]
        closed = bool(np.allclose(radial[0], radial[-1]))
        for touched in (index, end_face):
            self.faces[touched][1].append(len(self.edges))
        shape = {"kind": "circle", "points": centre + radius * radial, "centre": centre, "axis": axis}
        self.edges.append(
            {**shape, "radius_mm": radius, "faces": [index, end_face], "normals": normals, "closed": closed}
        )

    def _ruling(self, before, after, points, normal):
        faces = [after] if before == after else [before, after]
        for index in faces:
            self.faces[index][1].append(len(self.edges))
        normals = [np.tile(normal, (2, 1)) for _ in faces]
        flags = {"seam": before == after, "smooth": before != after}
        self.edges.append({"kind": "line", "points": points, "faces": faces, "normals": normals, **flags})

    def brep(self, *pmi_records):
        faces = tuple(Face(*surface, tuple(edges)) for surface, edges in self.faces)
        return Brep("test part", "mm", faces, tuple(_edge(**given) for given in self.edges), self._mesh(), pmi_records)

    def _mesh(self):
        """A bounding box: measurands do not look at the mesh."""
        points = np.concatenate([given["points"] for given in self.edges])
        return box_mesh(points.min(axis=0), points.max(axis=0))


def _edge(kind, points, faces, normals, centre=NOWHERE, axis=NOWHERE, radius_mm=np.nan, closed=False, **flags):
    return Edge(kind, points, tuple(faces), np.stack(normals, axis=1), centre, axis, radius_mm, closed, **flags)


def box_mesh(low, high):
    """A box as twelve triangles."""
    corners = np.array(
        [[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])], dtype=float
    )
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    return Mesh(corners, np.array(triangles, dtype=np.int64))


def prism(profile_xz, depth):
    """A solid extruded along y from 0 to depth; its profile is counter-clockwise in the x-z plane.

    Faces: 0 at y = 0, 1 at y = depth, 2 + k over the profile's side from corner k to corner k + 1.
    """
    x, z = np.asarray(profile_xz, dtype=float).T
    front, back = (np.stack([x, np.full_like(x, y), z], axis=1) for y in (0.0, depth))
    solid = Solid()
    solid.plane(front)
    solid.plane(back[::-1])
    for k in range(len(x)):
        n = (k + 1) % len(x)
        solid.plane([front[k], back[k], back[n], front[n]])
    return solid


def slotted_block():
    """60 x 40 x 30 mm, with a slot 20 wide and 12 deep along y (x from 15 to 35) and a step at x = 50, z = 20.

    Faces: 0, 1 ends in y; 2 bottom; 3 right side; 4 step floor; 5 riser; 6 top right; 7, 9 slot walls (x = 35,
    x = 15); 8 slot floor; 10 top left; 11 left side.
    """
    return prism([(0, 0), (60, 0), (60, 20), (50, 20), (50, 30), (35, 30), (35, 18), (15, 18), (15, 30), (0, 30)], 40.0)


def drilled_plate(centres, radius=4.0, parts=2, thickness=10.0):
    """A plate 100 x 60 with through holes; the indices of each hole's cylindrical faces.

    Faces: 0, 1 ends in y; 2 bottom (z = 0), 3 (x = 100), 4 top, 5 (x = 0).
    """
    solid = prism([(0, 0), (100, 0), (100, thickness), (0, thickness)], 60.0)
    holes = [solid.cylinder([(x, y, 0.0), (x, y, thickness)], (2, 4), radius, parts=parts) for x, y in centres]
    return solid, holes


def moved(brep, rotation, translation):
    """The same part after a rigid motion: ``rotation`` (3, 3), ``translation`` (3,) mm."""
    R, t = np.asarray(rotation), np.asarray(translation)
    faces = tuple(replace(f, origin=R @ f.origin + t, axis=R @ f.axis) for f in brep.faces)
    edges = tuple(
        replace(e, points=e.points @ R.T + t, normals=e.normals @ R.T, centre=R @ e.centre + t, axis=R @ e.axis)
        for e in brep.edges
    )
    return replace(brep, faces=faces, edges=edges, mesh=replace(brep.mesh, vertices=brep.mesh.vertices @ R.T + t))
