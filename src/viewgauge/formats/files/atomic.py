"""Outputs that are complete or absent: written beside their place, then renamed into it."""

from __future__ import annotations

import ctypes
import errno
import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ...exceptions import InputError
from .scratch import make_scratch

__all__ = ["atomic_path", "move_into_place", "replaced_in_one_step", "write_text_atomically", "writing_in"]

_HERE, _EXCHANGE = -100, 2  # AT_FDCWD; RENAME_EXCHANGE of Linux, RENAME_SWAP of macOS
_STORAGE_ERRORS = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO}


@contextmanager
def atomic_path(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary path of the same name and volume, renamed to ``path`` when the block ends well.

    The block may make a file or a folder there. If it raises, what stood at ``path`` before is left as it was.
    A device or pipe (``/dev/stdout``) is given as it is.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    given = Path(path)
    if given.exists() and not given.is_file() and not given.is_dir():
        yield given  # not where its links lead: that of a pipe is no path
        return
    target = Path(os.path.realpath(path))
    try:
        workplace = make_scratch(target.parent)
    except OSError as error:
        raise _cannot_write(path, error) from error
    try:
        yield workplace / target.name
        move_into_place(workplace / target.name, target)
    except OSError as error:
        if error.errno in _STORAGE_ERRORS:
            raise _cannot_write(path, error) from error
        raise
    finally:
        shutil.rmtree(workplace, ignore_errors=True)


@contextmanager
def replaced_in_one_step(folder: Path) -> Iterator[Path]:
    """A copy of an existing folder to write to; when the block ends well, it takes the folder's place in one step.

    Whoever looks, or kills the process, meets the old files or the new ones and no mixture. Files that the block does
    not write stay as they are: the copy shares them. Where the system cannot do so, the folder itself is given.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    target = Path(os.path.realpath(folder))
    try:
        workplace = make_scratch(target.parent)
    except OSError:  # nothing may be written beside the folder
        yield folder
        return
    try:
        copy = workplace / target.name
        try:
            shutil.copytree(target, copy, symlinks=True, copy_function=os.link)
        except OSError:  # no links here (shutil.Error too), or a file that nobody may read
            yield folder
            return
        yield copy
        if not exchange(copy, target):
            for made in sorted(copy.iterdir()):
                os.replace(made, target / made.name)
    finally:
        shutil.rmtree(workplace, ignore_errors=True)


def write_text_atomically(path: str | os.PathLike[str], text: str) -> None:
    """Write a UTF-8 text file whole or not at all; line ends are written as they stand in ``text``.

    Raises
    ------
    InputError
        If the place cannot be written to.
    """
    if Path(path).is_dir():
        raise InputError("a file cannot be written where a folder is", file=path, hint="give the path of a file")
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="")


@contextmanager
def writing_in(path: str | os.PathLike[str]) -> Iterator[None]:
    """The system's errors of a block that writes ``path`` or beside it, as InputError."""
    try:
        yield
    except OSError as error:
        raise _cannot_write(path, error) from error


def move_into_place(made: Path, target: Path) -> None:
    """Rename what was made in a folder of its own to ``target`` on the same volume, in place of what is there.

    A folder that is replaced is moved beside ``made``, whose folder is to be taken away afterwards.

    Raises
    ------
    InputError
        If the place cannot be written to, or a file would replace a folder.
    """
    try:
        if not target.is_dir():
            os.replace(made, target)
            return
        if not made.is_dir():
            raise InputError("a file cannot be written where a folder is", file=target, hint="give another path")
        if exchange(made, target):
            return
        old = made.with_name(f"{target.name}.old")  # a folder with content cannot be replaced in one step
        os.replace(target, old)
        try:
            os.replace(made, target)
        except OSError:
            os.replace(old, target)
            raise
    except OSError as error:
        raise _cannot_write(target, error) from error


def exchange(one: Path, other: Path) -> bool:
    """Let two folders change places in one step of the file system; False where the system cannot."""
    if os.name != "posix":
        return False
    library = ctypes.CDLL(None, use_errno=True)
    places = os.fsencode(one), os.fsencode(other)
    if sys.platform == "linux" and library is not None and hasattr(library, "renameat2"):
        return bool(library.renameat2(_HERE, places[0], _HERE, places[1], _EXCHANGE) == 0)
    if sys.platform == "darwin" and library is not None and hasattr(library, "renamex_np"):
        return bool(library.renamex_np(*places, _EXCHANGE) == 0)
    return False


def _cannot_write(path: str | os.PathLike[str], error: OSError) -> InputError:
    folder = Path(path).absolute().parent
    if not folder.exists():
        hint = f"create the folder {folder} first"
    elif not folder.is_dir():
        hint = f"{folder} is a file, not a folder"
    elif error.errno in _STORAGE_ERRORS:
        hint = "free some space on the volume or choose another place"
    else:
        hint = "choose a place where you may write"
    return InputError(f"cannot be written: {error.strerror or error}", file=path, hint=hint)
