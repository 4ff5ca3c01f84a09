"""List the features of a part, and propose characteristics on them."""

from __future__ import annotations

import os
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...exceptions import PartFileError
from ...formats.features.proposal_text import PROPOSED_TOLERANCE, proposed_section, proposed_tolerance_mm
from ...formats.files.atomic import write_text_atomically
from ...formats.part_formats import reading_part
from ...part import Part
from ...part.catalogue import Catalogue, PartFeature, Proposal, catalogue_of, propose

__all__ = ["describe_features", "read_features", "write_proposals"]


def read_features(path: str | PathLike[str]) -> tuple[Part, Catalogue]:
    """A part and its features.

    Raises
    ------
    PartFileError
        If the file cannot be read, or is a mesh, which has no features.
    """
    with reading_part(Path(path)) as finish:
        part = finish()
    if part.brep is None:
        low, high = part.mesh.bounds
        size = " x ".join(f"{length:.6g}" for length in high - low)
        raise PartFileError(
            "a mesh has triangles and no features with ids: no planes, edges or holes",
            file=path,
            got=f"a mesh of {len(part.mesh.triangles)} triangles, {size} mm",
            expected="a STEP file with surfaces (B-rep)",
            hint="give the STEP file of the part; or state characteristics of a mesh by two points each: points: "
            "[[0, 0, 40], [60, 0, 40]], unit: mm",
        )
    return part, catalogue_of(part.brep)


def describe_features(part: Part, catalogue: Catalogue, *, with_proposals: bool = False) -> dict[str, Any]:
    """The features as plain data: id, kind, position, direction and sizes of each; and what is proposed on them."""
    low, high = part.mesh.bounds
    document: dict[str, Any] = {
        "part": {
            "name": part.name,
            "length_unit": part.length_unit,
            "size_mm": _numbers(high - low),
            "solids": part.solids,
            "notes": list(part.notes),
            "characteristics_of_pmi": len(part.characteristics) + len(part.not_measurable),
        },
        "features": [_feature(feature, catalogue) for feature in catalogue.features],
    }
    if with_proposals:
        document["proposals"] = [_proposal(proposal) for proposal in propose(catalogue)]
    return document


def write_proposals(catalogue: Catalogue, part_file: str | PathLike[str], output: str | PathLike[str] | None) -> str:
    """Proposals as the section ``part`` of an inspection file, written to a file where one is given.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    folder = Path.cwd() if output is None else Path(output).absolute().parent
    try:
        name = Path(os.path.relpath(Path(part_file).absolute(), folder)).as_posix()
    except ValueError:  # on another drive
        name = Path(part_file).absolute().as_posix()
    text = proposed_section(name, propose(catalogue))
    if output is not None:
        write_text_atomically(Path(output), text)
    return text


def _feature(feature: PartFeature, catalogue: Catalogue) -> dict[str, Any]:
    described: dict[str, Any] = {
        "id": feature.id,
        "kind": feature.kind,
        "position_mm": _numbers(feature.position),
        "direction": _numbers(feature.direction),
        "sizes_mm": {name: round(size, 6) for name, size in feature.sizes_mm.items()},
    }
    if feature.kind == "slot":
        planes = {plane.references: plane.id for plane in catalogue.of_kind("plane")}
        described["planes"] = [planes[(reference,)] for reference in feature.references]
    return described


def _proposal(proposal: Proposal) -> dict[str, Any]:
    described: dict[str, Any] = {"kind": proposal.kind, "features": list(proposal.features), "what": proposal.what}
    if proposal.kind == "position":
        return described | {"datums": list(proposal.datums), "basic_mm": [round(v, 6) for v in proposal.basic_mm]}
    nominal = round(proposal.nominal_mm, 6)
    tolerance = proposed_tolerance_mm(nominal)
    return described | {
        "nominal_mm": nominal,
        "tolerance_mm": [-tolerance, tolerance],
        "tolerance_of": PROPOSED_TOLERANCE,
    }


def _numbers(values: NDArray[np.float64]) -> list[float]:
    return [float(round(value, 6) + 0.0) for value in values.tolist()]
