"""What lies within reach, clicked: objects sent to the floor, suns of lamps, presets of quality."""

import pytest

JOBS = "jobs_reach.py"
CLICK = 0.02
"""A click is so exact [m]: a pixel of the window is a few millimetres there."""


def test_an_object_comes_to_stand_where_was_clicked(notes):
    found = notes["send_by_click"]
    assert found["sent"][:2] == pytest.approx(found["spot"][:2], abs=CLICK)
    assert found["sent"][2] == pytest.approx(0, abs=1e-3)


def test_a_click_into_the_sky_moves_nothing_and_undo_goes_back(notes):
    found = notes["send_by_click"]
    assert found["after_sky"] == found["sent"]
    assert found["undone"] == pytest.approx(found["before"])


def test_a_lamp_becomes_a_sun_by_a_click(notes):
    found = notes["sun_by_click"]
    assert found["off_deg"] < found["across_deg"] / 2
    assert 1 < found["across_deg"] < 40


def test_a_preset_is_chosen_by_a_click(notes):
    found = notes["preset_by_click"]
    assert found["before"] == ["catcher", 64, False]
    assert found["after"] == ["catcher", 16, True]
