"""The account of a section's keys: each is used, known to be harmless, or a problem that names it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any

from ...files.problems import KeyPath
from .calibration_document import CalibrationDocument
from .harmless_keys import harmless_reason
from .key_names import plain_name

__all__ = ["Entry", "KeyAccount"]


@dataclass(frozen=True)
class Entry:
    """A key's value, and where it stands."""

    where: KeyPath
    value: Any


class KeyAccount:
    """A section of a file, of which every key must be accounted for.

    Parameters
    ----------
    where
        Where the section stands in the file.
    names
        Names of keys that are not as :func:`~.key_names.plain_name` gives them.
    """

    def __init__(
        self,
        document: CalibrationDocument,
        where: KeyPath,
        section: dict[str, Any],
        names: Mapping[str, str] | None = None,
    ) -> None:
        self.document, self.where, self.section = document, where, section
        self._open = {key: plain_name(key) for key in section} | dict(names or {})

    def take(self, names: Collection[str], suits: Callable[[object], bool] | None = None) -> Entry | None:
        """The value of the key that has one of the names; None where there is none.

        Parameters
        ----------
        suits
            Whether a value can be meant; a key with another value stays open.
        """
        keys = [key for key, name in self._open.items() if name in names]
        if suits is not None:
            keys = [key for key in keys if suits(self.section[key])]
        if not keys:
            return None
        for key in keys:
            del self._open[key]
        first, *others = keys
        differing = [key for key in others if self.section[key] != self.section[first]]
        if differing:
            self.document.problems.add(
                (*self.where, differing[0]),
                f"the file says the same thing differently under {first!r}",
                got=str(self.section[differing[0]])[:80],
                hint="remove the one that is wrong",
            )
        return Entry((*self.where, first), self.section[first])

    def close(self) -> None:
        """Note a problem for each key that was not used and is not known to be harmless."""
        for key in self._open:
            if self.section[key] in (None, "", [], {}) or harmless_reason(key) is not None:
                continue
            self.document.problems.add(
                (*self.where, key),
                "the key is not known here, and may change where the camera shows points",
                got=str(self.section[key])[:80],
                expected="keys that are used or known to be without influence on the image (see the page on formats)",
                hint="remove it from the file if it says nothing about the lens, the image or its pixels",
            )
