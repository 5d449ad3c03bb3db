"""The step of the sidebar for layers: a place's layers made, opened and written, by clicks in the window."""

import pytest

JOBS = "jobs_layers.py"


@pytest.fixture(scope="module")
def found(notes):
    return notes["make_open_and_write"]


def test_nothing_can_be_opened_before_there_is_something(found):
    assert found["can_before"] == [False, False, False]
    assert found["can_after"] == [False, True, True]


def test_layers_are_made(found):
    assert found["found"].startswith("surface 1")
    assert found["files"].count(".xml") == 1
    assert found["files"].count(".exr") >= 4


def test_they_are_opened_in_a_scene_of_their_own(found):
    assert "Layers Origin" in found["objects"]
    assert "surface 1" in found["objects"]


def test_they_are_written(found):
    assert found["bytes"] > 100_000


def test_opening_can_be_undone(found):
    assert found["scenes_after_undo"] == ["Scene"]
