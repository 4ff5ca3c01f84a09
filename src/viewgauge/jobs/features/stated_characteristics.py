"""Characteristics that the inspection file states on features of the part by their ids."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from ...exceptions import InputError, InspectionFileError

if TYPE_CHECKING:
    from ...formats.inspection.inspection_file import CharacteristicEntry, InspectionFile
    from ...part import Characteristic, NotMeasurable, Part
    from ...part.catalogue import Catalogue

__all__ = ["FeatureIds"]

_ROUNDING_MM = 0.005 + 1e-9  # a nominal value may be written with two decimals
_NO_POSITION = "a position is read and listed; it is not measured yet"


class FeatureIds:
    """Makes characteristics of entries that name features; the part's features are found when first asked for."""

    def __init__(self, part: Part, file: InspectionFile) -> None:
        self._part = part
        self._file = file
        self._catalogue: Catalogue | None = None

    def check_datums(self) -> None:
        """Refuse datums that are no features of the part.

        Raises
        ------
        InspectionFileError
            Naming the datum.
        """
        for letter, name in self._file.datums.items():
            try:
                self._features().feature(name)
            except InputError as error:
                raise self._error(error, f"datum {letter}", None, "part.datums") from error

    def characteristic(self, entry: CharacteristicEntry) -> Characteristic | NotMeasurable:
        """The characteristic of an entry, or why it cannot be measured.

        Raises
        ------
        InspectionFileError
            If the entry names what the part does not have, or a nominal value that is not the geometry's.
        """
        try:
            return self._characteristic(entry)
        except InputError as error:
            raise self._error(error, f"characteristic {entry.id!r}", entry.line, "part.characteristics") from error

    def _characteristic(self, entry: CharacteristicEntry) -> Characteristic | NotMeasurable:
        from ...part import Characteristic, NotMeasurable
        from ...part.catalogue import outcome_on_features
        from ...part.characteristics.outcome import Derived

        stated = entry.stated
        assert stated is not None  # the caller's condition
        catalogue = self._features()
        if stated.kind == "position":
            for name in stated.features:
                catalogue.feature(name)
            _known_datums(stated.datums, self._file.datums, self._part)
            zone = "" if stated.zone_mm is None else f" (zone {stated.zone_mm:g} mm)"
            return NotMeasurable(entry.id, "position", _NO_POSITION + zone)
        outcome = outcome_on_features(catalogue, stated.kind, stated.features)
        if not isinstance(outcome, Derived):
            nominal = float("nan") if stated.nominal_mm is None else stated.nominal_mm
            return NotMeasurable(entry.id, stated.kind, outcome.reason, nominal, entry.tolerance_mm)
        nominal = outcome.value_mm if stated.nominal_mm is None else stated.nominal_mm
        if abs(nominal - outcome.value_mm) > max(_ROUNDING_MM, 1e-6 * outcome.value_mm):
            raise InputError(
                "the nominal value disagrees with the geometry",
                got=f"nominal {nominal:.9g} mm; {stated.kind} of {' and '.join(stated.features)} in the part's file "
                f"{outcome.value_mm:.9g} mm",
                expected="the same value, to 0.005 mm",
                hint="correct the nominal value or the ids; where the model has the middle of the tolerance zone, "
                "state that value and the deviations from it",
            )
        observed = entry.observed or "ends"
        return Characteristic(entry.id, stated.kind, nominal, entry.tolerance_mm, outcome.measurands, observed)

    def _features(self) -> Catalogue:
        from ...part.catalogue import catalogue_of

        if self._part.brep is None:
            raise InputError(
                "features by ids need a STEP part with surfaces (B-rep); a mesh has none",
                hint="give the two points of the characteristic: points: [[0, 0, 40], [60, 0, 40]], unit: mm",
            )
        if self._catalogue is None:
            self._catalogue = catalogue_of(self._part.brep)
        return self._catalogue

    def _error(self, error: InputError, what: str, line: int | None, key: str) -> InspectionFileError:
        return InspectionFileError(
            f"{what}: {error.problem}",
            file=self._file.path,
            line=line,
            key=key,
            got=error.got,
            expected=error.expected,
            hint=error.hint,
        )


def _known_datums(letters: Collection[str], datums: Collection[str], part: Part) -> None:
    """Refuse letters that nothing explains; the datums of a part with PMI may be those of its file."""
    unknown = [letter for letter in letters if letter not in datums]
    if unknown and not (part.characteristics or part.not_measurable):
        raise InputError(
            f"datum {unknown[0]} is not stated",
            got=f"datums [{', '.join(letters)}]",
            expected=f"letters of part.datums: {', '.join(datums) or 'there are none'}",
            hint=f"say which feature it is: datums: {{{unknown[0]}: F1}} under part",
        )
