"""The sidebar in light and dark themes and in all sizes of the interface; people look at the pictures."""

JOBS = "jobs_looks.py"


def test_themes(notes):
    assert notes["themes"]["seconds"] > 0


def test_the_sidebar_grows_with_the_interface(notes):
    small, plain, large = notes["scales"]["widths"].values()
    assert small < plain < large


def test_number_pad_7_shows_a_plan(notes):
    assert notes["seeing"]["is_plan"]
