"""What ends a tool or long work in the middle leaves the scene whole, and nothing running."""

JOBS = "jobs_interrupted.py"


def test_esc_restores_exactly(notes):
    found = notes["escape"]
    assert found["ran"] == ["Pick Points", "Draw Shape"]
    assert (found["after"], found["still"]) == (found["before"], "")


def test_another_file_ends_the_tool(notes):
    found = notes["another_file"]
    assert (found["ran"], found["after_loading"], found["again"]) == ("Pick Points", "", "Pick Points")


def test_another_scene_does_not_break_it(notes):
    assert (notes["another_scene"]["ran"], notes["another_scene"]["still"]) == ("Draw Shape", "")


def test_the_add_on_goes_with_all_it_has(notes):
    found = notes["add_on_switched_off"]
    assert (found["ran"], found["is_working"]) == ("Pick Points", True)
    assert found["during"]["callbacks"] > 0
    assert set(found["left"].values()) == {0}, found["left"]
    assert found["keeps_picks"] == 11


def test_esc_ends_long_work(notes):
    found = notes["long_work_cancelled"]
    assert found["ran"]
    assert found["after"] == found["before"]


def test_blender_quits(notes):
    """With a crash, or an error in a console, there would be no notes."""
    assert notes["quit_in_the_middle"]["is_working"]
    assert notes["quit_in_the_middle"]["ran"] == "Pick Points"
