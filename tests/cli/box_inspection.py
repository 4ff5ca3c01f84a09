"""The inspection of a box that the tests of the commands start from, in the current folder."""

from __future__ import annotations

from pathlib import Path

from inspections import BOX, sections
from viewgauge.cli import main


def write(name="inspection.yaml", **changes):
    Path(name).write_text(sections(**{**BOX, **changes}))


def refused(capsys, *arguments):
    """The message of a command that has to end with exit code 2."""
    assert main([str(a) for a in arguments]) == 2
    out, err = capsys.readouterr()
    assert err.startswith("viewgauge: ")
    assert "Traceback" not in err
    assert out == ""
    return err
