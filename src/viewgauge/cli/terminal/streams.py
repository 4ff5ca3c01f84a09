"""What reaches the terminal: no control characters of the input, and the warnings of jobs."""

from __future__ import annotations

import logging
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from typing import Any, TextIO

__all__ = ["OutputError", "discard_output", "open_standard_streams", "plain_output", "terminal_of"]

_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]")


class OutputError(Exception):
    """Standard output or standard error cannot be written to, for a full disk, say."""


class _PlainText:
    """A text stream that shows control characters as text: an id may hold codes that move a terminal's cursor."""

    def __init__(self, stream: TextIO, escape: bool) -> None:
        self.stream, self.escape = stream, escape

    def write(self, text: str) -> int:
        with _named():
            self.stream.write(_CONTROL.sub(_escaped, text) if self.escape else text)
        return len(text)

    def flush(self) -> None:
        with _named():
            self.stream.flush()

    def writelines(self, lines: Any) -> None:
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


@contextmanager
def _named() -> Iterator[None]:
    """An error of writing as one of the output; a reader that has gone away is none."""
    try:
        yield
    except BrokenPipeError:
        raise
    except (OSError, ValueError) as error:  # a full device; a stream that is closed
        reason = getattr(error, "strerror", None) or str(error)
        raise OutputError(f"the output cannot be written: {reason}") from error


def _escaped(match: re.Match[str]) -> str:
    return match[0].encode("unicode_escape").decode("ascii")


class _Warnings(logging.Handler):
    """Shows warnings of jobs as those of the command."""

    def emit(self, record: logging.LogRecord) -> None:
        print(f"viewgauge: warning: {record.getMessage()}", file=sys.stderr)


def terminal_of(stream: Any) -> TextIO:
    """The stream itself, for what moves the cursor on purpose."""
    found: TextIO = stream.stream if isinstance(stream, _PlainText) else stream
    return found


def open_standard_streams() -> None:
    """Put the null device in place of standard streams that are closed, lest a file that is opened becomes one."""
    while True:
        number = os.open(os.devnull, os.O_RDWR)
        if number > 2:
            os.close(number)
            break
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115  # until the process ends


def discard_output() -> None:
    """Send what is still to be written nowhere: Python would try to write it again as it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@contextmanager
def plain_output(*, escape: bool = True) -> Iterator[None]:
    """While the block runs, what is printed holds no control characters, and warnings of jobs are printed.

    Parameters
    ----------
    escape
        False for a page of help, which is drawn with them.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a name that the terminal cannot show is no failure
    before, warnings = (sys.stdout, sys.stderr), _Warnings(logging.WARNING)
    log = logging.getLogger("viewgauge.jobs")
    sys.stdout, sys.stderr = (_PlainText(stream, escape) for stream in before)
    log.addHandler(warnings)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before
        log.removeHandler(warnings)
