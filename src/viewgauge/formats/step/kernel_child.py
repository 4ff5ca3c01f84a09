"""The child process that reads a STEP file: ``python -m viewgauge.formats.step.kernel_child FILE FOLDER OPTIONS``.

OPTIONS is JSON. It leaves ``brep.npz`` and ``brep.json`` in FOLDER, or ``error.json`` with the reason why not.
"""

from __future__ import annotations

import gc
import json
import os
import signal
import sys
from pathlib import Path
from typing import TypedDict

from ...exceptions import PartFileError

__all__ = ["Options", "main"]

_PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG


class Options(TypedDict):
    """The parent's options: chord error, mm (None: chosen from the part's size), PMI or not, memory limit, bytes."""

    chord_error_mm: float | None
    with_pmi: bool
    memory_bytes: int


def main(arguments: list[str]) -> int:
    """Read FILE into FOLDER; 0 where that worked, 1 where ``error.json`` says why not."""
    _end_with_parent()
    path, folder, options = Path(arguments[0]), Path(arguments[1]), json.loads(arguments[2])
    try:
        _limit_memory(options["memory_bytes"])
        # Imported here: its absence is reported like any other obstacle, and the limit holds for it too.
        from .brep_archive import save_brep
        from .kernel import read_part

        brep = read_part(path, chord_error_mm=options["chord_error_mm"], with_pmi=options["with_pmi"], folder=folder)
        save_brep(brep, folder)
    except PartFileError as error:
        _refuse(folder, "refused", error.problem, error)
    except ImportError as error:
        short = any(words in str(error) for words in ("failed to map segment", "Cannot allocate memory"))
        _refuse(folder, "memory" if short else "import", str(error))
    except MemoryError:
        _refuse(folder, "memory", "out of memory")
    except Exception as error:  # the kernel raises types of its own; none may reach the user as a traceback
        kind = "memory" if "OutOfMemory" in type(error).__name__ or "bad_alloc" in str(error) else "failed"
        _refuse(folder, kind, f"{type(error).__name__}: {error}".splitlines()[0])
    else:
        return 0
    return 1


def _end_with_parent() -> None:
    """End when the process that waits for the result ends, however that ends (Linux only)."""
    if sys.platform == "linux":
        import ctypes

        parent = os.getppid()
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL)
        if os.getppid() != parent:  # it has just ended
            os._exit(1)


def _limit_memory(limit: int) -> None:
    """Limit the address space (POSIX only; elsewhere there is no limit)."""
    if sys.platform != "win32":
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def _refuse(folder: Path, kind: str, problem: str, error: PartFileError | None = None) -> None:
    record: dict[str, object] = {"kind": kind, "problem": problem}
    if error is not None:
        got = None if error.got is None else str(error.got)
        record |= {"got": got, "expected": error.expected, "hint": error.hint}
    (folder / "error.json").write_text(json.dumps(record), encoding="utf-8")


if __name__ == "__main__":
    gc.disable()  # loading the kernel makes many objects and no garbage
    code = main(sys.argv[1:])
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os._exit(code)  # the result is in files by now: taking the kernel down in order costs as much as reading a part
