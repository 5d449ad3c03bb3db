"""The tools with mouse and keys: the flat image, undo within, areas that change, typed lengths."""

import numpy as np
import pytest

JOBS = "jobs_tools.py"
FLOOR_RECTANGLE = ((0.56163, 0.72955), (0.10792, 0.74079), (0.93641, 0.66562), (0.72567, 0.66207))


def test_clicks_on_the_flat_image_are_exact(notes):
    found = notes["on_the_flat_image"]
    off = np.abs(np.array(found["clicked"]) - FLOOR_RECTANGLE) * (found["width"], found["width"] / 2)
    assert off.max() < 0.6  # of a pixel of the screen: the mouse has whole ones
    assert (found["solved"], found["still"]) == (True, "")


def test_verticals_come_one_after_the_other(notes):
    found = notes["two_verticals"]
    assert (found["ran"], found["still"]) == ("Pick Points", "")
    assert found["new"] == ["VERTICAL", "VERTICAL"]
    assert found["tilt_deg"] == pytest.approx(0.06, abs=0.1)


def test_undo_within_a_tool_takes_its_clicks_only(notes):
    found = notes["undo_within"]
    assert found["counts"] == [3, 2, 1, 2]
    assert found["after"] == found["before"]


def test_an_area_may_change_while_a_tool_runs(notes):
    assert (notes["area_fills_the_window"]["ran"], notes["area_fills_the_window"]["points"]) == (
        "Pick Points",
        2,
    )


def test_lengths_can_be_typed(notes):
    found = notes["typed_box"]
    assert (found["ran"], found["still"]) == ("Draw Shape", "")
    (size,) = found["sizes"].values()
    assert size == pytest.approx([1.5, 0.8, 0.75], abs=1e-3)
