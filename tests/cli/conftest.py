"""A folder with an inspection in it."""

from __future__ import annotations

import pytest
from box_inspection import write


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder, also the current one, with a box and its inspection file."""
    import trimesh

    monkeypatch.chdir(tmp_path)
    trimesh.creation.box(bounds=[(0, 0, 0), (80, 50, 40)]).export("box.stl")
    write()
    return tmp_path
