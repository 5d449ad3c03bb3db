"""What lies within reach, clicked: objects sent to the floor, suns of lamps, presets of quality."""

from datetime import UTC, datetime, timedelta, timezone

import pytest

from expanded_panoramas.ibl_toolkit.mobile.sun_position import sun_position

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


def test_the_dialog_of_the_sun_proposes_now(notes):
    """At 0° N, 0° E, where its fields begin, at the time that the clock said."""
    found = notes["sun_of_today"]
    kept = found["kept"]
    zone = timezone(timedelta(hours=kept["utc_offset"]))
    time = datetime(*(kept[name] for name in ("year", "month", "day", "hour", "minute")), tzinfo=zone)
    assert timedelta() <= datetime.now(UTC) - time < timedelta(hours=1)
    assert found["direction"] == pytest.approx(sun_position(time, 0, 0).direction, abs=1e-4)
    assert found["undone"]


def test_a_preset_is_chosen_by_a_click(notes):
    found = notes["preset_by_click"]
    assert found["before"] == ["catcher", 64, False]
    assert found["after"] == ["catcher", 16, True]
