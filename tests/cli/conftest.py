"""A folder with an inspection in it."""

from __future__ import annotations

import pytest
from box_inspection import write

from inspections import write_box


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder, also the current one, with a box and its inspection file."""
    monkeypatch.chdir(tmp_path)
    write_box()
    write()
    return tmp_path
