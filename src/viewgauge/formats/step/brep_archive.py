"""A B-rep as plain arrays and text in a folder, to be handed from one process to another.

Two files: ``brep.npz`` (arrays only, no pickled objects) and ``brep.json``. Reading them runs no code of the
writer, so a reader that was led astray by a malicious file cannot lead the program astray with it.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...findings import Finding
from ...part.brep import Brep, Edge, Face, PmiRecord, Reference
from ...part.indication import Measurability, indication_from
from ...part.mesh import Mesh

__all__ = ["load_brep", "save_brep"]


def save_brep(brep: Brep, folder: Path) -> None:
    """Write a B-rep into an existing folder."""
    edges, faces = brep.edges, brep.faces
    arrays: dict[str, NDArray[Any]] = {
        "vertices": brep.mesh.vertices,
        "triangles": brep.mesh.triangles,
        "face_origin": np.array([face.origin for face in faces], dtype=float).reshape(-1, 3),
        "face_axis": np.array([face.axis for face in faces], dtype=float).reshape(-1, 3),
        "edge_centre": np.array([edge.centre for edge in edges], dtype=float).reshape(-1, 3),
        "edge_axis": np.array([edge.axis for edge in edges], dtype=float).reshape(-1, 3),
        "edge_offsets": np.cumsum([0, *(len(edge.points) for edge in edges)]),
        "edge_points": np.concatenate([np.empty((0, 3)), *(edge.points for edge in edges)]),
        "edge_normals": np.concatenate(
            [np.empty((0, 3)), *(np.swapaxes(edge.normals, 0, 1).reshape(-1, 3) for edge in edges)]
        ),
    }
    np.savez(folder / "brep.npz", allow_pickle=False, **arrays)
    record = {
        "name": brep.name,
        "length_unit": brep.length_unit,
        "chord_error_mm": brep.mesh.chord_error_mm,
        "plus_minus_count": brep.plus_minus_count,
        "notes": brep.notes,
        "pmi_counts": dict(brep.pmi_counts),
        "findings": [asdict(finding) for finding in brep.findings],
        "solids": brep.solids,
        "faces": [[face.kind, face.radius_mm, face.concave, face.edges, face.instance] for face in faces],
        "edges": [
            [edge.kind, edge.faces, edge.radius_mm, edge.closed, edge.seam, edge.smooth, edge.instance]
            for edge in edges
        ],
        "pmi_records": [_archived_record(pmi_record) for pmi_record in brep.pmi_records],
    }
    (folder / "brep.json").write_text(json.dumps(record), encoding="utf-8")


def load_brep(folder: Path) -> Brep:
    """Read the B-rep in a folder.

    Raises
    ------
    OSError, ValueError, KeyError
        If the folder's contents are incomplete or inconsistent.
    """
    record = cast("dict[str, Any]", json.loads((folder / "brep.json").read_text(encoding="utf-8")))
    with np.load(folder / "brep.npz", allow_pickle=False) as stored:
        arrays = {name: stored[name] for name in stored.files}
    faces = tuple(
        Face(kind, origin, axis, radius, concave, tuple(edges), instance)
        for (kind, radius, concave, edges, instance), origin, axis in zip(
            record["faces"], arrays["face_origin"], arrays["face_axis"], strict=True
        )
    )
    return Brep(
        name=record["name"],
        length_unit=record["length_unit"],
        faces=faces,
        edges=_edges(record["edges"], arrays),
        mesh=Mesh(arrays["vertices"], arrays["triangles"], record["chord_error_mm"]),
        pmi_records=tuple(_pmi_record(entry) for entry in record["pmi_records"]),
        plus_minus_count=record["plus_minus_count"],
        notes=tuple(record["notes"]),
        pmi_counts=record["pmi_counts"],
        findings=tuple(Finding(**finding) for finding in record["findings"]),
        solids=record["solids"],
    )


def _edges(records: list[Any], arrays: dict[str, NDArray[Any]]) -> tuple[Edge, ...]:
    edges, used = [], 0
    spans = pairwise(arrays["edge_offsets"].tolist())
    for (kind, faces, radius, closed, seam, smooth, instance), (start, stop), centre, axis in zip(
        records, spans, arrays["edge_centre"], arrays["edge_axis"], strict=True
    ):
        count = len(faces) * (stop - start)
        normals = arrays["edge_normals"][used : used + count].reshape(len(faces), stop - start, 3)
        used += count
        points = arrays["edge_points"][start:stop]
        flags = closed, seam, smooth, instance
        edges.append(Edge(kind, points, tuple(faces), np.swapaxes(normals, 0, 1), centre, axis, radius, *flags))
    return tuple(edges)


def _archived_record(pmi_record: PmiRecord) -> list[object]:
    first, second = ([[r.kind, r.index] for r in side] for side in (pmi_record.first, pmi_record.second))
    return [
        *(pmi_record.name, pmi_record.kind, pmi_record.label, pmi_record.nominal_mm, pmi_record.tolerance_mm),
        *(first, second, pmi_record.problem, pmi_record.status, asdict(pmi_record.indication)),
    ]


def _pmi_record(entry: list[Any]) -> PmiRecord:
    name, kind, label, nominal, tolerance, first, second, problem, status, indication = entry
    first, second = (tuple(Reference(what, index) for what, index in side) for side in (first, second))
    tolerance = None if tolerance is None else tuple(tolerance)
    status, indication = Measurability(status), indication_from(indication)
    return PmiRecord(name, kind, label, nominal, tolerance, first, second, problem, status, indication)
