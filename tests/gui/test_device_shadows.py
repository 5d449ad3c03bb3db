"""The step of device shadows: a ball's shadow on the photographed floor, by clicks in the window."""

import pytest

JOBS = "jobs_device_shadows.py"
DARKER, SAME = 0.8, 0.03
"""Share of the floor's brightness that is left in a shadow at most; difference of what stays [0 to 1]."""


@pytest.fixture(scope="module")
def found(notes):
    return notes["preview_follow_and_remove"]


def test_the_selected_light_is_chosen(found):
    assert found["lights"] == ["Sun from Panorama"]


def test_the_window_shows_the_shadow_and_leaves_the_photograph_beside_it(found):
    assert found["shown"]["here"] < DARKER * found["before"]["here"]
    for name in ("there", "floor"):
        assert abs(found["shown"][name] - found["before"][name]) < SAME


def test_the_shadow_follows_the_light(found):
    assert found["turned"]["there"] < DARKER * found["before"]["there"]
    assert abs(found["turned"]["here"] - found["before"]["here"]) < SAME


def test_removed_it_leaves_nothing(found):
    assert not found["left"]
    for name, value in found["before"].items():
        assert abs(found["removed"][name] - value) < SAME


def test_undo_brings_it_back(found):
    assert found["is_back"]
    assert found["undone"]["there"] < DARKER * found["before"]["there"]


def test_the_page_is_written(found):
    assert found["begins"].startswith("<!doctype html")
    assert found["bytes"] > 100_000
