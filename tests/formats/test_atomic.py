"""Outputs are complete or absent."""

import errno
import os
import subprocess
import sys

import pytest

from viewgauge.exceptions import InputError
from viewgauge.formats.files.atomic import atomic_path, replaced_in_one_step, write_text_atomically


def test_writes_text_as_it_stands(tmp_path):
    path = tmp_path / "a.txt"
    write_text_atomically(path, "grün\r\nzwei\n")
    assert path.read_bytes() == "grün\r\nzwei\n".encode()
    write_text_atomically(path, "new")
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_permissions_are_those_of_an_ordinary_file(tmp_path):
    write_text_atomically(tmp_path / "a", "")
    (tmp_path / "b").write_text("")
    assert (tmp_path / "a").stat().st_mode == (tmp_path / "b").stat().st_mode


def test_a_failure_leaves_what_was_there(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")

    def fail():
        with atomic_path(path) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_a_full_volume_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match="free some space"), atomic_path(tmp_path / "a"):
        raise OSError(errno.ENOSPC, "No space left on device")


def test_other_errors_of_the_block_pass_through(tmp_path):
    with pytest.raises(FileNotFoundError), atomic_path(tmp_path / "a"):
        raise FileNotFoundError


def test_the_temporary_path_keeps_suffix_and_volume(tmp_path):
    with atomic_path(tmp_path / "table.parquet") as temporary:
        assert temporary.name == "table.parquet"
        assert temporary.parent.parent == tmp_path
        temporary.write_text("x")
    assert (tmp_path / "table.parquet").read_text() == "x"


def test_folders_are_replaced_whole(tmp_path):
    target = tmp_path / "table.zarr"
    for name in ("first", "second"):
        with atomic_path(target) as temporary:
            temporary.mkdir()
            (temporary / name).write_text(name)
        assert os.listdir(target) == [name]
    assert os.listdir(tmp_path) == ["table.zarr"]


def test_a_link_is_followed(tmp_path):
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to("real")
    write_text_atomically(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_a_device_is_written_to_and_not_replaced():
    write_text_atomically("/dev/null", "gone")
    assert not os.path.isfile("/dev/null")


@pytest.mark.parametrize(
    ("place", "hint"),
    [("none/a.txt", "create the folder"), ("file/a.txt", "is a file, not a folder"), ("folder", "path of a file")],
)
def test_unwritable_places(tmp_path, place, hint):
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError) as caught:
        write_text_atomically(tmp_path / place, "x")
    assert hint in caught.value.hint
    assert caught.value.file == str(tmp_path / place)


def test_a_file_does_not_replace_a_folder(tmp_path):
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="where a folder is"), atomic_path(tmp_path / "folder") as temporary:
        temporary.write_text("x")
    assert os.listdir(tmp_path) == ["folder"]


def test_a_folder_without_permission(tmp_path, monkeypatch):
    def refuse(**_):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("tempfile.mkdtemp", refuse)  # the superuser, who runs many a CI, may write anywhere
    with pytest.raises(InputError, match="may write"):
        write_text_atomically(tmp_path / "a", "x")


def test_a_folder_is_replaced_in_one_step_and_keeps_what_else_is_in_it(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "a.txt").write_text("old")
    (folder / "mine.txt").write_text("of the user")
    with replaced_in_one_step(folder) as made:
        (made / "b.txt").write_text("new")
        write_text_atomically(made / "a.txt", "new")
        assert (folder / "a.txt").read_text() == "old"
        assert not (folder / "b.txt").exists()
    assert {file.name: file.read_text() for file in folder.iterdir()} == {
        "a.txt": "new",
        "b.txt": "new",
        "mine.txt": "of the user",
    }
    assert [place.name for place in tmp_path.iterdir()] == ["out"]


def test_a_folder_is_as_it_was_if_the_block_fails(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "a.txt").write_text("old")

    def half_way():
        with replaced_in_one_step(folder) as made:
            write_text_atomically(made / "a.txt", "new")
            raise ValueError("half way")

    with pytest.raises(ValueError, match="half way"):
        half_way()
    assert (folder / "a.txt").read_text() == "old"
    assert [place.name for place in tmp_path.iterdir()] == ["out"]


@pytest.mark.skipif(os.name != "posix", reason="processes are looked up as POSIX has them")
def test_what_a_killed_process_left_is_taken_away_and_what_a_running_one_has_is_not(tmp_path):
    """A folder is made by a process that is killed, and another by one that runs: this one's parent."""
    code = "from pathlib import Path\nfrom viewgauge.formats.files.scratch import make_scratch\n"
    code += f"make_scratch(Path({str(tmp_path)!r}))"
    subprocess.run([sys.executable, "-c", code], check=True)
    (left,) = tmp_path.iterdir()
    running = tmp_path / left.name.replace(left.name.split("-")[2], str(os.getppid()))
    running.mkdir()
    write_text_atomically(tmp_path / "a.txt", "new")
    assert {place.name for place in tmp_path.iterdir()} == {"a.txt", running.name}
