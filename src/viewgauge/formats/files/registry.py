"""The known formats of one kind of file: adding a format is one new class and one registration."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Generic, Protocol, TypeVar

__all__ = ["Registry", "SuffixRegistry"]

_Format = TypeVar("_Format")


class _HasSuffixes(Protocol):
    @property
    def suffixes(self) -> tuple[str, ...]: ...


_Suffixed = TypeVar("_Suffixed", bound=_HasSuffixes)


class Registry(Generic[_Format]):
    """Formats in the order in which they are asked whether a file is theirs."""

    def __init__(self, *formats: _Format) -> None:
        self._formats = list(formats)

    def register(self, format_: _Format) -> None:
        """Add a format, also from outside this package; it is asked before those that are known."""
        self._formats.insert(0, format_)

    def unregister(self, format_: _Format) -> None:
        """Take a format away again."""
        self._formats.remove(format_)

    def __iter__(self) -> Iterator[_Format]:
        return iter(tuple(self._formats))


class SuffixRegistry(Registry[_Suffixed]):
    """Formats that are recognised by the suffix of the file's name, in any case."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Every known suffix, in lower case with its point."""
        return tuple(dict.fromkeys(suffix for format_ in self for suffix in format_.suffixes))

    def of(self, path: Path) -> _Suffixed | None:
        """The format of a file of this name; None if there is none."""
        name = path.name.lower()
        return next((format_ for format_ in self if name.endswith(format_.suffixes)), None)
