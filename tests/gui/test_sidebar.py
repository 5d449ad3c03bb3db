"""The sidebar's buttons, clicked: each step changes the scene as it says, and undoes and redoes."""

import pytest

JOBS = "jobs_sidebar.py"


@pytest.fixture(scope="module")
def flow(notes):
    return notes["by_buttons_and_back"]


def test_each_button_does_its_step(flow):
    imported, calibrated, built, ball = flow["stages"]
    assert (imported["picks"], imported["solved"]) == (11, False)
    assert calibrated["solved"]
    assert (built["built"], built["surfaces"]) == (6, 6)
    assert ball["balls"] == 1


def test_undo_goes_back_step_by_step(flow):
    assert flow["back"][:3] == flow["stages"][-2::-1]
    assert flow["back"][3]["picks"] == 0


def test_redo_comes_again(flow):
    assert flow["again"] == flow["stages"]
