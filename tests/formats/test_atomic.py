"""Outputs are complete or absent."""

import errno
import os

import pytest

from viewgauge.exceptions import InputError
from viewgauge.formats.files.atomic import atomic_path, write_text_atomically


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
