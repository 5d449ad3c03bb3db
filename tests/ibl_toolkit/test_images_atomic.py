"""A target is the old file or the new one, and nothing lies beside it."""

import pytest

from expanded_panoramas.ibl_toolkit.images import replacing
from expanded_panoramas.ibl_toolkit.images.atomic import discard_unfinished, new_folder, refuse_unwritable


@pytest.fixture
def target(tmp_path):
    path = tmp_path / "target.exr"
    path.write_text("old")
    return path


def test_success_replaces(target):
    with replacing(target) as temporary:
        assert temporary.parent == target.parent
        assert temporary.suffix == target.suffix
        temporary.write_text("new")
        assert target.read_text() == "old"
    assert target.read_text() == "new"
    assert list(target.parent.iterdir()) == [target]


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_failure_leaves_the_old_file(target, error):
    def write_half():
        with replacing(target) as temporary:
            temporary.write_text("half")
            raise error

    with pytest.raises(error):
        write_half()
    assert target.read_text() == "old"
    assert list(target.parent.iterdir()) == [target]


def test_a_block_that_writes_nothing_is_an_error(target):
    with pytest.raises(FileNotFoundError), replacing(target):
        pass
    assert target.read_text() == "old"


def test_two_writers_do_not_meet(target):
    with replacing(target) as first, replacing(target) as second:
        assert first != second
        first.write_text("first")
        second.write_text("second")
    assert target.read_text() == "first"


def test_where_no_file_can_be_written(tmp_path):
    refuse_unwritable(tmp_path / "new.exr")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "file").touch()
    for target in (tmp_path / "file" / "new.exr", tmp_path / "gone" / "new.exr"):
        with pytest.raises(OSError, match=target.parent.name):
            refuse_unwritable(target)


def test_a_new_folder_is_there_whole_or_not_at_all(tmp_path):
    with new_folder(tmp_path / "layers") as folder:
        (folder / "a.exr").write_text("a")
        assert not (tmp_path / "layers").exists()
    assert [path.name for path in (tmp_path / "layers").iterdir()] == ["a.exr"]

    def fail():
        with new_folder(tmp_path / "other") as folder:
            (folder / "a.exr").write_text("a")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    assert [path.name for path in tmp_path.iterdir()] == ["layers"]


def test_an_unfinished_folder_can_be_discarded(tmp_path):
    def leave():
        with new_folder(tmp_path / "layers") as folder:
            (folder / "a.exr").write_text("a")
            discard_unfinished()
            assert not list(tmp_path.iterdir())

    with pytest.raises(FileNotFoundError):
        leave()
