"""Read an inspection: its file, its part, and whatever else it names."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from ..exceptions import InputError, InspectionFileError
from ..findings import Finding, admit, require_known
from ..formats.inspection.inspection_text import read_inspection_text
from ..formats.part_formats import reading_part

if TYPE_CHECKING:  # what takes long to import is imported while a child process reads the part
    from ..formats.inspection.inspection_file import CharacteristicEntry, InspectionFile
    from ..part import Characteristic, NotMeasurable, Part
    from ..planning.inspection import Inspection

__all__ = ["load"]

_FOCUS_MATTERS = 0.01  # of the image scale


def load(
    path: str | PathLike[str],
    *,
    part: str | PathLike[str] | None = None,
    chord_error_mm: float | None = None,
    meanwhile: Callable[[], object] | None = None,
    within: str | PathLike[str] | None = None,
    may_be_empty: bool = False,
) -> Inspection:
    """Read an inspection file and everything that it names.

    Parameters
    ----------
    path
        The inspection file (YAML).
    part
        CAD file or mesh, in place of the file's own ``part.file``.
    chord_error_mm
        How far the mesh of a CAD part may be from its curved faces; None to choose it by the part's size.
    meanwhile
        Called once the inspection file is found right, while another process still reads a STEP file: the time to
        import what comes next.
    within
        The only folder from which files that the inspection file names may be read; None for any.
    may_be_empty
        Accept a CAD part without any characteristic, to say what it is.

    Raises
    ------
    InputError
        If a file cannot be read or something in it cannot be used; it says where.
    """
    text = read_inspection_text(path, None if within is None else Path(within))
    part_path = Path(part) if part is not None else text.part_file
    if chord_error_mm is not None and not (math.isfinite(chord_error_mm) and chord_error_mm > 0):
        raise InputError("must be a positive length", key="chord_error", got=f"{chord_error_mm} mm")
    with nullcontext() if part_path is None else reading_part(part_path, chord_error_mm, text.part_unit) as finish:
        from ..formats.inspection.inspection_file import read_inspection_file

        file = read_inspection_file(text)
        if part_path is None or finish is None:
            raise InspectionFileError(
                "no part is given", file=file.path, key="part.file", hint="name the part's file there, or with --part"
            )
        if meanwhile is not None:
            meanwhile()
        return _inspection(file, part_path, _with_entries(finish(), file, may_be_empty=may_be_empty))


def _inspection(file: InspectionFile, part_path: Path, part: Part) -> Inspection:
    from ..formats.poses.viewpoints_file import read_viewpoints
    from ..planning.inspection import ExplicitViewpoints

    viewpoints = None
    if file.viewpoints_file is not None:
        ids, poses = read_viewpoints(file.viewpoints_file)
        viewpoints = ExplicitViewpoints(ids, poses)
    if note := _focus_note(file):
        part = replace(part, notes=(*part.notes, note))
    used = (file.path, part_path, file.viewpoints_file, *file.other_files)
    inspection = file.inspection(
        part,
        name=file.path.stem if file.path.stem != "inspection" else part_path.stem,
        viewpoints=viewpoints,
        inputs={f.name: hashlib.sha256(f.read_bytes()).hexdigest() for f in used if f is not None},
    )
    return replace(inspection, findings=_admitted(inspection, file), accepted=file.accepted)


def _focus_note(file: InspectionFile) -> str:
    """What the image scale owes to the focus, where it is not stated and the stated distances make it matter."""
    camera, distances = file.setup.camera, file.distance_mm
    if camera.focus_distance_mm is not None or file.is_calibrated or distances is None:
        return ""
    longer = 1 / max(1 - camera.focal_length_mm / distances[0], 0.01) - 1
    if longer <= _FOCUS_MATTERS:
        return ""
    return (
        f"no focus_distance is given, so the principal distance is taken as the focal length: focused at "
        f"{distances[0]:g} mm, images are {longer:.1%} larger"
    )


def _admitted(inspection: Inspection, file: InspectionFile) -> tuple[Finding, ...]:
    """The findings that are shown as warnings; raises InputError for those that are refused and not accepted."""
    from ..planning.plausibility import implausible

    read = tuple(dict.fromkeys((*inspection.part.findings, *file.findings)))
    said = {finding.name for finding in read}  # by whoever read the file, who knows more of it
    findings = (*read, *(finding for finding in implausible(inspection) if finding.name not in said))
    try:
        require_known(file.accepted, findings)
        return admit(findings, file.accepted)
    except InputError as error:
        raise InspectionFileError(
            error.problem, file=file.path, key=error.key, got=error.got, expected=error.expected, hint=error.hint
        ) from None


def _with_entries(part: Part, file: InspectionFile, *, may_be_empty: bool) -> Part:
    """The part with the inspection file's own characteristics and tolerances.

    An entry with two points, or on features, adds a characteristic (or takes the place of the PMI's of the same id);
    any other changes the tolerance or observation of the PMI's; the general tolerance goes to those that have none.
    """
    from ..part import Characteristic
    from .features.stated_characteristics import FeatureIds

    characteristics = {characteristic.id: characteristic for characteristic in part.characteristics}
    not_measurable = {entry.id: entry for entry in part.not_measurable}
    notes, features = list(part.notes), FeatureIds(part, file)
    features.check_datums()
    for entry in file.characteristics:
        if not entry.is_override:
            if entry.id in characteristics or entry.id in not_measurable:
                what = "two points replace" if entry.stated is None else "features replace"
                notes.append(f"characteristic {entry.id}: the inspection file's {what} the part's PMI")
            replaced = characteristics.get(entry.id) or not_measurable.pop(entry.id, None)
            own = _own_characteristic(entry, part, file) if entry.stated is None else features.characteristic(entry)
            if replaced is not None:
                own = replace(own, indication=replaced.indication)
            if isinstance(own, Characteristic):
                characteristics[entry.id] = own
            else:
                characteristics.pop(entry.id, None)
                not_measurable[entry.id] = own
        elif changed := [name for name in characteristics if name == entry.id or name.startswith(f"{entry.id}/")]:
            characteristics |= {name: _changed(characteristics[name], entry) for name in changed}
        elif not any(name == entry.id or name.startswith(f"{entry.id}/") for name in not_measurable):
            raise InspectionFileError(
                f"characteristic {entry.id!r} is not in the part's PMI",
                file=file.path,
                line=entry.line,
                key="part.characteristics",
                expected=_known(characteristics, not_measurable),
                hint="give it two points, or correct its id",
            )
    if file.general_tolerance_mm is not None:
        for name, characteristic in characteristics.items():
            if characteristic.tolerance_mm is None:
                characteristics[name] = _with_tolerance(characteristic, file.general_tolerance_mm)
    if not characteristics and not not_measurable:
        drawn = any(finding.name == "graphical_pmi" for finding in part.findings)
        if not may_be_empty or part.solids is None or drawn:
            raise InspectionFileError(
                "there is no characteristic to measure: the part brings none, and the file gives none",
                file=file.path,
                key="part.characteristics",
                got=" ".join(part.notes) or None,
                hint=_next_step(part),
            )
        notes.append(f"The part brings no characteristic, and the inspection file states none: {_next_step(part)}.")
    return replace(
        part,
        characteristics=tuple(characteristics.values()),
        not_measurable=tuple(not_measurable.values()),
        notes=tuple(notes),
        brep=None,
    )


def _next_step(part: Part) -> str:
    """What a user does for a part without characteristics."""
    if part.brep is None:
        return "add characteristics with an id and two points to part.characteristics"
    return (
        "`viewgauge features` with the part's file lists its features; with --propose it writes characteristics on them"
    )


def _own_characteristic(entry: CharacteristicEntry, part: Part, file: InspectionFile) -> Characteristic | NotMeasurable:
    from ..part import Characteristic, NotMeasurable
    from ..part.characteristics.point_pairs import measurand_on_mesh, missing_edge

    assert entry.ends_mm is not None  # the caller's condition
    try:
        measurand = measurand_on_mesh(part.mesh, *entry.ends_mm)
    except InputError as error:
        raise InspectionFileError(
            f"characteristic {entry.id!r}: {error.problem}",
            file=file.path,
            line=entry.line,
            key="part.characteristics",
            got=error.got,
            expected=error.expected,
            hint=error.hint,
        ) from error
    if reason := missing_edge(measurand):
        return NotMeasurable(entry.id, "measurand", reason, measurand.length_mm, entry.tolerance_mm)
    return Characteristic(
        entry.id, "measurand", measurand.length_mm, entry.tolerance_mm, (measurand,), entry.observed or "ends"
    )


def _changed(characteristic: Characteristic, entry: CharacteristicEntry) -> Characteristic:
    changed = replace(characteristic, observed=entry.observed or characteristic.observed)
    return changed if entry.tolerance_mm is None else _with_tolerance(changed, entry.tolerance_mm)


def _with_tolerance(characteristic: Characteristic, tolerance_mm: tuple[float, float]) -> Characteristic:
    indication = replace(characteristic.indication, toleranced=True)
    return replace(characteristic, tolerance_mm=tolerance_mm, indication=indication)


def _known(characteristics: dict[str, Characteristic], not_measurable: dict[str, NotMeasurable]) -> str:
    names = [*characteristics, *not_measurable]
    return "one of " + ", ".join(names[:20]) + (", …" if len(names) > 20 else "") if names else "no id: there is no PMI"
