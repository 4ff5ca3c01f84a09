"""The lens of a camera's section: its model by name or by asking, its coefficients under any of their names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ....exceptions import InputError
from ....findings import Finding
from ....geometry import Lens
from ...files.problems import KeyPath, dotted
from ..camera_file import Stated
from ..reading.calibration_document import CalibrationDocument
from ..reading.key_account import KeyAccount
from ..reading.key_names import COEFFICIENT_NAMES, DISTORTION, FISHEYE_FLAG, MODEL, RADIAL, TANGENTIAL, is_matrix
from .foreign_lens import replaced_foreign_lens
from .inverse_lens import ImageFrame
from .lens_names import LensKind, lens_kind, lens_names
from .model_question import ask_for_model

__all__ = ["ReadLens", "read_lens"]

_FOREIGN = (LensKind.INVERSE_RADIAL_TANGENTIAL, LensKind.MODIFIED_RADIAL_TANGENTIAL, LensKind.F_THETA)


@dataclass(frozen=True)
class ReadLens:
    """A lens as it was read; None without distortion."""

    lens: Lens | None
    findings: tuple[Finding, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Coefficients:
    where: KeyPath
    values: list[float]
    kind: LensKind = LensKind.UNSAID  # what their names say of the model


def read_lens(
    account: KeyAccount,
    frame: ImageFrame | None,
    stated: Stated,
    corner: float | None,
    model_numbers: Mapping[int, str] | None = None,
    has_covariance: bool = False,
) -> ReadLens | None:
    """The lens of a section; None where a problem was noted.

    Parameters
    ----------
    frame
        Where the image lies; None where its size is not known.
    corner
        Distance of the farthest corner of the image, as a tangent; None where it is not known.
    model_numbers
        Names of models that a format writes as numbers.
    has_covariance
        Whether the section states an uncertainty, of coefficients that are 0 too.
    """
    document, problems = account.document, len(account.document.problems.found)
    kind, where = _stated_kind(account, stated, model_numbers or {})
    given = _coefficients(account)
    if len(document.problems.found) > problems or kind is None:
        return None
    if given is None:
        return _without_coefficients(account, kind, stated, where)
    if kind is LensKind.UNSAID:
        kind = given.kind
    values = given.values
    if not any(values) and kind is not LensKind.EQUIDISTANT and not has_covariance:
        unsure = kind is LensKind.UNSAID and len(values) == 4
        return ReadLens(None, (_all_zero(document, given.where),) if unsure else ())
    if kind is LensKind.NONE:
        expected = "coefficients that are all 0, or the model that they are of"
        document.problems.add(given.where, "coefficients of a lens without distortion", got=values, expected=expected)
        return None
    if kind is LensKind.UNSAID and len(values) == 4:
        ask_for_model(document, given.where, values, corner)
        return None
    if kind in _FOREIGN:
        lens = replaced_foreign_lens(document, given.where, kind, values, frame)
        return None if lens is None else ReadLens(lens.lens, notes=(lens.note,))
    lens_model = LensKind.EQUIDISTANT if kind is LensKind.EQUIDISTANT else LensKind.RADIAL_TANGENTIAL
    made = _lens(document, given.where, lens_model, values)
    return None if made is None else ReadLens(made)


def _lens(document: CalibrationDocument, where: KeyPath, kind: LensKind, values: list[float]) -> Lens | None:
    if kind is LensKind.EQUIDISTANT and len(values) > 4 and not any(values[4:]):
        values = values[:4]
    if kind is LensKind.RADIAL_TANGENTIAL and len(values) == 14:
        if any(values[12:]):
            document.problems.add(where, "a tilted sensor is not known here", got=values[12:], expected="0, 0")
            return None
        values = values[:12]
    try:
        return Lens(kind.value, tuple(values))
    except InputError as error:
        document.problems.add(where, error.problem, got=error.got, expected=error.expected)
        return None


def _without_coefficients(account: KeyAccount, kind: LensKind, stated: Stated, where: KeyPath) -> ReadLens | None:
    document = account.document
    if kind is LensKind.NONE:
        return ReadLens(None)
    if kind not in (LensKind.UNSAID, LensKind.RADIAL_TANGENTIAL):
        document.problems.add(where, "the coefficients of the lens are missing", got=kind.value, expected="4 numbers")
        return None
    if stated.model is not None and kind is LensKind.RADIAL_TANGENTIAL:
        document.problems.add(where, "the file has no distortion coefficients", got=stated.model, expected="none")
        return None
    finding = Finding(
        "no_distortion",
        "the file has no distortion coefficients, so that the lens counts as free of distortion",
        "coefficients, or the model none",
        "they were left out when the file was written",
        f"{document.path}: {dotted(account.where)}" if account.where else str(document.path),
    )
    return ReadLens(None, (finding,))


def _all_zero(document: CalibrationDocument, where: KeyPath) -> Finding:
    return Finding(
        "lens_model",
        "the four distortion coefficients are 0, and the file does not say of which model: taken as no distortion",
        "a model that is said",
        "",
        f"{document.path}: {dotted(where)}",
    )


def _stated_kind(account: KeyAccount, stated: Stated, numbers: Mapping[int, str]) -> tuple[LensKind | None, KeyPath]:
    """What the file's keys and the user say of the model, and where; None where a problem was noted."""
    document = account.document
    said: dict[LensKind, KeyPath] = {}
    unknown = False
    for name in sorted(MODEL):
        entry = account.take({name}, _is_word)
        if entry is None or entry.value is None:
            continue
        value = numbers.get(entry.value, entry.value) if isinstance(entry.value, int) else entry.value
        kind = lens_kind(str(value))
        if kind is None:
            what = "camera" if name in ("cameramodel", "cameratype", "type", "projection") else "distortion"
            document.problems.add(entry.where, f"unknown {what} model", got=value, expected=f"pinhole; {lens_names()}")
            unknown = True
            continue
        said.setdefault(kind, entry.where)
    flag = account.take(FISHEYE_FLAG, _is_word)
    if flag is not None and flag.value is not None:
        fisheye = str(flag.value).lower() in ("1", "1.0", "true", "yes")
        if not fisheye and str(flag.value).lower() not in ("0", "0.0", "false", "no"):
            document.problems.add(flag.where, "not a yes or no", got=flag.value, expected="1 or 0")
        said.setdefault(LensKind.EQUIDISTANT if fisheye else LensKind.RADIAL_TANGENTIAL, flag.where)
    if unknown:
        return None, account.where
    said.pop(LensKind.UNSAID, None)
    if len(said) > 1:
        got = " and ".join(kind.value for kind in said)
        document.problems.add(next(iter(said.values())), "the file says two models of the lens", got=got)
        return None, account.where
    kind, where = next(iter(said.items()), (LensKind.UNSAID, account.where))
    return _agreed(document, kind, where, stated), where


def _agreed(document: CalibrationDocument, kind: LensKind, where: KeyPath, stated: Stated) -> LensKind | None:
    """The file's model or the user's; None, with a problem, where they differ."""
    if stated.model is None:
        return kind
    meant = lens_kind(stated.model)
    expected = "fisheye, radial-tangential or none"
    if meant is None or meant is LensKind.UNSAID or meant in _FOREIGN:
        document.problems.add((), "not a lens model", got=stated.model, expected=expected)
        return None
    if kind not in (LensKind.UNSAID, meant):
        hint = "leave the model out"
        document.problems.add(where, "the file says another model", got=stated.model, expected=kind.value, hint=hint)
        return None
    return meant


def _coefficients(account: KeyAccount) -> _Coefficients | None:
    """The coefficients in the order of their model; None where there are none or a problem was noted."""
    document = account.document
    found: list[_Coefficients] = []
    entry = account.take(DISTORTION, is_matrix)
    if entry is not None:
        values = document.numbers(entry.where, entry.value, None)
        if values:
            found.append(_Coefficients(entry.where, values))
    elif (
        text := account.take(DISTORTION, lambda value: value is not None and not isinstance(value, dict))
    ) is not None:
        document.numbers(text.where, text.value, None)  # which says what is expected
    radial, tangential = account.take(RADIAL, is_matrix), account.take(TANGENTIAL, is_matrix)
    if radial is not None:
        k = document.numbers(radial.where, radial.value, (2, 3)) or [0.0, 0.0]
        p = document.numbers(tangential.where, tangential.value, (2,)) if tangential else None
        found.append(_Coefficients(radial.where, [*k[:2], *(p or [0.0, 0.0]), *k[2:]], LensKind.RADIAL_TANGENTIAL))
    elif tangential is not None:
        document.problems.add(tangential.where, "tangential distortion without radial", expected="both")
    by_name = _by_name(account)
    if by_name is not None:
        found.append(by_name)
    if len(found) > 1:
        same = all(each.values == found[0].values for each in found)
        if not same:
            document.problems.add(found[1].where, "the file states the distortion twice", got=found[1].values)
    return found[0] if found else None


def _by_name(account: KeyAccount) -> _Coefficients | None:
    """Coefficients that each have a key: k1, k2, p1, ..."""
    entries = {name: account.take({name}, _is_word) for name in COEFFICIENT_NAMES}
    given = {name: entry for name, entry in entries.items() if entry is not None and entry.value is not None}
    if not given:
        return None
    numbers = {name: account.document.number(entry.where, entry.value) for name, entry in given.items()}
    where = next(iter(given.values())).where
    order = {name: numbers.get(name) or 0.0 for name in COEFFICIENT_NAMES}
    if "k4" in given and not given.keys() - {"k1", "k2", "k3", "k4"}:
        return _Coefficients(where, [order[name] for name in ("k1", "k2", "k3", "k4")])
    last = max(COEFFICIENT_NAMES.index(name) for name in given if order[name]) if any(order.values()) else 3
    count = next(count for count in (4, 5, 8, 12, 14) if last < count)
    return _Coefficients(where, list(order.values())[:count], LensKind.RADIAL_TANGENTIAL)


def _is_word(value: Any) -> bool:
    return not isinstance(value, list | dict)
