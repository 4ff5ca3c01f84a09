"""One line on standard error where the numerical kernels have to be compiled first, which takes a while.

numba announces each function that it compiles, but not one that it finds in its cache. Importing numba takes long, so
nothing is done before some command imports it.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType

__all__ = ["LINE", "report_compiling"]

LINE = "compiling the numerical kernels (the first time only, up to half a minute)"

_EVENTS = "numba.core.event"


def report_compiling() -> None:
    """Print one line when the first kernel is compiled that the cache lacks; call it before numba is imported."""
    sys.meta_path.insert(0, _Finder())


class _Finder:
    """Finds numba's module of events as Python does, and listens as soon as it is loaded."""

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        if name != _EVENTS:
            return None
        sys.meta_path.remove(self)
        spec = PathFinder.find_spec(name, path, target)
        if spec is None or spec.loader is None:
            return spec
        load = spec.loader.exec_module

        def load_and_listen(module: ModuleType) -> None:
            load(module)
            _listen(module)

        spec.loader.exec_module = load_and_listen  # type: ignore[method-assign]
        return spec


def _listen(events: ModuleType) -> None:
    class Listener(events.Listener):  # type: ignore[name-defined,misc] # known only now
        reported = False

        def on_start(self, event: object) -> None:
            # what is never cached is compiled within what is, or too small to mention
            if not self.reported and event.data["dispatcher"].stats.cache_path is not None:  # type: ignore[attr-defined]
                self.reported = True
                print(LINE, file=sys.stderr, flush=True)

        def on_end(self, event: object) -> None:
            pass

    events.register("numba:compile", Listener())
