"""Geometry that a STEP file does not hold but another file does, which it names."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePosixPath, PureWindowsPath

from ....exceptions import PartFileError
from ..step_text import Record, StepText
from .step_sections import referenced_files

__all__ = ["external_files", "refuse_without_geometry"]

_DOCUMENTS = ("DOCUMENT_FILE", "DOCUMENT")
_IDENTIFICATIONS = (
    "APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT",
    "EXTERNAL_IDENTIFICATION_ASSIGNMENT",
    "EXTERNALLY_DEFINED_ITEM",
    "EXTERNALLY_DEFINED_SHAPE_REPRESENTATION",
)
_CAD_SUFFIXES = frozenset(
    f".{word}"
    for word in (
        *(
            "stp",
            "step",
            "p21",
            "stpz",
            "stpx",
            "stpxz",
            "stpa",
            "jt",
            "igs",
            "iges",
            "x_t",
            "x_b",
            "sat",
            "sab",
            "qif",
        ),
        *(
            "prt",
            "asm",
            "sldprt",
            "sldasm",
            "catpart",
            "catproduct",
            "cgr",
            "ipt",
            "iam",
            "par",
            "psm",
            "model",
            "3dxml",
        ),
        *("stl", "obj", "ply", "3mf", "glb", "gltf", "wrl", "fcstd", "qif", "x_b"),
    )
)


def external_files(text: StepText, source: str) -> list[str]:
    """Names of the files that hold geometry of this one, in the order of its records."""
    words: list[str] = []
    for _, record in text.parts(*_DOCUMENTS, *_IDENTIFICATIONS):
        words += _words(record)
    named = [" ".join(word.split()) for word in words if _is_cad_file(word)]
    return list(dict.fromkeys([*named, *referenced_files(source)]))


def refuse_without_geometry(text: StepText, source: str) -> None:
    """Refuse a file without any geometry of its own, and name the files that hold it.

    Raises
    ------
    PartFileError
        Always.
    """
    files = external_files(text, source)
    if not files:
        documents = [word for _, record in text.parts("DOCUMENT_FILE") for word in _words(record)]
        files = list(dict.fromkeys(documents))
    if files:
        shown = ", ".join(files[:10]) + (", ..." if len(files) > 10 else "")
        which = "another file" if len(files) == 1 else f"{len(files)} other files"
        raise PartFileError(
            f"the geometry is in {which}: {shown}",
            got="references to files, and no solid, surface or triangle",
            expected="a file that holds its geometry",
            hint=f"give {files[0]} as the part, or export the assembly as one file",
        )
    kinds = ", ".join(f"{count} {name}" for name, count in _most_frequent(text))
    raise PartFileError(
        "the file holds no geometry: no solid, surface or triangle",
        got=f"{len(text.bodies)} records" + (f" ({kinds})" if kinds else ""),
        expected="a solid part",
        hint="export the part's solid, not only its structure, wireframe or drawing",
    )


def _words(record: Record) -> list[str]:
    """The texts among a record's parameters, typed values too."""
    words: list[str] = []
    for parameter in record.parameters:
        if isinstance(parameter, str) and parameter.strip():
            words.append(parameter)
        elif isinstance(parameter, Record):
            words += _words(parameter)
    return words


def _is_cad_file(word: str) -> bool:
    name = PurePosixPath(PureWindowsPath(word.strip()).name)
    suffixes = [suffix.lower() for suffix in name.suffixes]
    return any(suffix in _CAD_SUFFIXES for suffix in suffixes[-2:])


def _most_frequent(text: StepText) -> Iterable[tuple[str, int]]:
    counts: dict[str, int] = {}
    for number in text.bodies:
        for part in text.records(number)[:1]:
            counts[part.type] = counts.get(part.type, 0) + 1
    return sorted(counts.items(), key=lambda item: -item[1])[:4]
