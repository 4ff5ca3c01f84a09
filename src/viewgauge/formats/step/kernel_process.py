"""Reads STEP files in a child process, so that a crash of the CAD kernel is an error message."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import mmap
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import IO, TYPE_CHECKING

from ...exceptions import PartFileError
from .kernel_child import Options
from .source.unpacking import PACKED

if TYPE_CHECKING:  # the child is started before anything slow is imported
    from ...part.brep import Brep

__all__ = ["read_step", "reading_step"]

_CHILD = (sys.executable, "-P", "-m", "viewgauge.formats.step.kernel_child")
_START, _END = b"ISO-10303-21", b"END-ISO-10303-21"
_PACKED_RATIO = 10  # size of a STEP file by that of its compressed form
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")
_INSTALL = 'pip install "viewgauge[step]"'
_MESSAGE_BYTES = 4096
_MEMORY_BYTES = 6 * 2**30
_LEAST_TIMEOUT_S, _TIMEOUT_S_PER_MB, _LONGEST_TIMEOUT_S = 50.0, 10.0, 600.0
_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
# Threads and their arenas reserve address space by the core, and the limit is one of address space.
_FRUGAL = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "2"}


def read_step(
    path: str | PathLike[str],
    *,
    chord_error_mm: float | None = None,
    timeout_s: float | None = None,
    memory_bytes: int = _MEMORY_BYTES,
    _child_command: Sequence[str] = (),
) -> Brep:
    """Read a part and the dimensions of its semantic PMI from a STEP file.

    The reading is done by a child process under limits. Where it crashes, it is tried once more for the geometry
    alone, and the part's notes say so.

    Parameters
    ----------
    path
        The file (AP203, AP214 or AP242).
    chord_error_mm
        Largest distance of mesh and edge points from the true surface, mm; None: 2e-4 of the part's diagonal,
        from 0.01 to 0.1 mm.
    timeout_s
        Wall-clock limit for each attempt, s: then the child and all that it started are killed. None: 50 s, and 10 s
        for each megabyte of the file, at most 600 s.
    memory_bytes
        Limit of the child's address space, bytes (POSIX only). The kernel needs about 1 GiB to start.
    _child_command
        Stands in for the child's command line, for tests: it is called with FILE FOLDER OPTIONS.

    Returns
    -------
    Brep
        Everything in mm, in the frame of the file's root.

    Raises
    ------
    PartFileError
        If the file cannot be read, or its reading crashes, takes too long or needs too much memory.
    """
    options = Options(chord_error_mm=chord_error_mm, with_pmi=True, memory_bytes=memory_bytes)
    limit = _timeout_s(Path(path)) if timeout_s is None else timeout_s
    with _reading(Path(path), options, limit, _child_command) as finish:
        return finish()


def _timeout_s(path: Path) -> float:
    """How long reading a file may take, by its size (compressed ones by what they may hold)."""
    try:
        megabytes = path.stat().st_size / 1e6 * (_PACKED_RATIO if path.suffix.lower() in (".gz", ".stpz") else 1)
    except OSError:
        return _LEAST_TIMEOUT_S
    return min(_LEAST_TIMEOUT_S + _TIMEOUT_S_PER_MB * megabytes, _LONGEST_TIMEOUT_S)


@contextlib.contextmanager
def reading_step(path: str | PathLike[str], *, chord_error_mm: float | None = None) -> Iterator[Callable[[], Brep]]:
    """Begin what :func:`read_step` does; the block has time for other work until it calls what it is given.

    That call waits for the part, and raises whatever is wrong with it. A block that ends without it ends the child.
    """
    options = Options(chord_error_mm=chord_error_mm, with_pmi=True, memory_bytes=_MEMORY_BYTES)
    with _reading(Path(path), options, _timeout_s(Path(path)), ()) as finish:
        yield finish


@contextlib.contextmanager
def _reading(
    path: Path, options: Options, timeout_s: float, child_command: Sequence[str]
) -> Iterator[Callable[[], Brep]]:
    refusal = _refusal(path, needs_kernel=not child_command)
    if refusal is not None:

        def refuse() -> Brep:
            raise refusal

        yield refuse
        return
    command = tuple(child_command) or _CHILD
    with _attempt(command, path, options, timeout_s) as outcome_of_first:

        def finish() -> Brep:
            outcome = outcome_of_first()
            if outcome.crash:
                with _attempt(command, path, {**options, "with_pmi": False}, timeout_s) as outcome_of_second:
                    retried = outcome_of_second()
                if retried.brep is not None:
                    note = f"Reading the dimensions crashed the CAD kernel ({outcome.crash}): geometry only."
                    return replace(retried.brep, notes=(*retried.brep.notes, note))
            if outcome.brep is None:
                raise _error(path, outcome, options, timeout_s)
            return outcome.brep

        yield finish


@dataclass(frozen=True)
class _Outcome:
    """The outcome of a child: a part, a refusal (the child's record), a crash in words, or nothing in time."""

    brep: Brep | None = None
    refusal: dict[str, str | None] | None = None
    crash: str = ""
    messages: str = ""


def _refusal(path: Path, *, needs_kernel: bool) -> PartFileError | None:
    """Why no child is worth starting; None where one is."""
    try:
        _check_text(path)
    except PartFileError as error:
        return error
    absent = needs_kernel and importlib.util.find_spec("OCP") is None
    return _not_installed(path, None) if absent else None


def _check_text(path: Path) -> None:
    """Refuse what is no complete STEP file before any kernel sees it."""
    expected = f"a STEP file, which starts with {_START.decode()}"
    if path.is_dir():
        raise PartFileError("the part is a folder", file=path, expected=expected)
    try:
        with path.open("rb") as stream:
            beginning = stream.read(_MESSAGE_BYTES)
            if not beginning.strip():
                raise PartFileError("the file is empty", file=path, expected=expected)
            if beginning.startswith((*PACKED, *_UTF_16)):
                return  # the child looks inside
            if not beginning.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(_START):
                got = repr(beginning[:40].decode("latin-1"))
                raise PartFileError("this is not a STEP file", file=path, got=got, expected=expected)
            with mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as content:
                complete = content.rfind(_END) >= 0
                end = repr(content[-40:].decode("latin-1"))
    except FileNotFoundError:
        raise PartFileError("the file does not exist", file=path, hint="check the path and its spelling") from None
    except OSError as error:
        raise PartFileError("the file cannot be opened", file=path, got=error.strerror) from None
    if not complete:
        problem, expected = "the file is truncated", f"a file that ends with {_END.decode()};"
        raise PartFileError(problem, file=path, got=end, expected=expected, hint="copy or export it again")


@contextlib.contextmanager
def _attempt(
    command: Sequence[str], path: Path, options: Options, timeout_s: float
) -> Iterator[Callable[[], _Outcome]]:
    """One attempt of the child, which runs while the block does; what the block is given waits for its outcome.

    Its output goes to a file, so that none of it can block it.
    """
    with tempfile.TemporaryDirectory(prefix="viewgauge-") as name, tempfile.TemporaryFile() as output:
        child = subprocess.Popen(
            [*command, str(path.absolute()), name, json.dumps(options)],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=output,
            start_new_session=True,
            env={**os.environ, **_FRUGAL},
        )
        deadline = time.monotonic() + timeout_s
        try:
            yield lambda: _outcome(child, deadline, Path(name), output)
        finally:
            if child.returncode is None:  # nobody has asked for its outcome
                _kill(child)


def _outcome(child: subprocess.Popen[bytes], deadline: float, folder: Path, output: IO[bytes]) -> _Outcome:
    """The outcome of the child, which ends by itself or is ended at the deadline."""
    try:
        code = child.wait(max(0.0, deadline - time.monotonic()))
    except subprocess.TimeoutExpired:
        code = None
    finally:
        _kill(child)
    output.seek(max(0, output.seek(0, os.SEEK_END) - _MESSAGE_BYTES))
    messages = _COLOUR.sub("", output.read().decode("utf-8", "replace")).strip()
    if code is None:
        return _Outcome(messages=messages)
    if code == 0:
        return _delivered(folder, messages)
    return _refused(folder, code, messages)


def _kill(child: subprocess.Popen[bytes]) -> None:
    """End the child and all that it started."""
    if os.name == "posix":
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(child.pid, signal.SIGKILL)
    else:
        child.kill()
    child.wait()


def _delivered(folder: Path, messages: str) -> _Outcome:
    import numpy as np

    from .brep_archive import load_brep

    try:
        brep = load_brep(folder)
    except (OSError, ValueError, KeyError, TypeError) as error:
        return _Outcome(crash=f"its result cannot be read: {error}", messages=messages)
    arrays = [brep.mesh.vertices, *(edge.points for edge in brep.edges), *(face.origin for face in brep.faces)]
    if not all(np.all(np.isfinite(array)) for array in arrays):
        problem = "the part has coordinates that are not finite numbers"
        return _Outcome(refusal={"kind": "refused", "problem": problem, "expected": "finite coordinates"})
    return _Outcome(brep=brep)


def _refused(folder: Path, code: int, messages: str) -> _Outcome:
    try:
        return _Outcome(refusal=json.loads((folder / "error.json").read_text(encoding="utf-8")), messages=messages)
    except (OSError, ValueError):
        if "bad_alloc" in messages or "MemoryError" in messages:
            return _Outcome(refusal={"kind": "memory", "problem": "out of memory"}, messages=messages)
    if code < 0:
        with contextlib.suppress(ValueError):
            return _Outcome(crash=f"ended by {signal.Signals(-code).name}", messages=messages)
    return _Outcome(crash=f"ended with exit code {code}", messages=messages)


def _error(path: Path, outcome: _Outcome, options: Options, timeout_s: float) -> PartFileError:
    """The error that tells the user what became of the child."""
    refusal = outcome.refusal
    simpler = "export the part again, or use a mesh (STL, PLY, OBJ) with characteristics in the inspection file"
    if refusal is None and not outcome.crash:
        problem, hint = f"reading the file took longer than {timeout_s:g} s", "allow more time, or simplify the part"
        return PartFileError(problem, file=path, hint=hint)
    if refusal is None:
        last = outcome.messages.splitlines()[-1] if outcome.messages else None
        problem = f"the CAD kernel crashed on this file ({outcome.crash})"
        return PartFileError(problem, file=path, got=last, hint=simpler)
    problem = refusal.get("problem") or ""
    match refusal.get("kind"):
        case "import":
            return _not_installed(path, problem)
        case "memory":
            problem = f"reading the file needs more than {options['memory_bytes'] / 2**30:.3g} GiB of memory"
            return PartFileError(problem, file=path, hint="allow more memory, or simplify the part")
        case "failed":
            return PartFileError("the CAD kernel failed on this file", file=path, got=problem, hint=simpler)
    return PartFileError(
        problem, file=path, got=refusal.get("got"), expected=refusal.get("expected"), hint=refusal.get("hint")
    )


def _not_installed(path: Path, got: str | None) -> PartFileError:
    if got is None:
        return PartFileError("STEP files need the CAD kernel, which is not installed", file=path, hint=_INSTALL)
    hint = f"{_INSTALL}; on Debian and Ubuntu also: apt install libgl1"
    return PartFileError("STEP files need the CAD kernel, which cannot be loaded", file=path, got=got, hint=hint)
