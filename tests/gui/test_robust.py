"""What comes between: other windows, scenes and files; the add-on is switched off and on."""

import pytest

JOBS = "jobs_robust.py"


def test_a_second_window_works(notes):
    found = notes["two_windows"]
    assert (found["windows"], found["solved"]) == (2, True)


def test_each_scene_has_its_own_place(notes):
    assert notes["several_scenes"]["heights"] == pytest.approx([1.32, 2.0])


def test_switched_off_it_leaves_nothing(notes):
    found = notes["switched_off_and_on"]
    assert found["during"]["callbacks"] > 0
    assert found["during"]["handlers"] > 0
    assert found["during"]["panorama"]
    assert set(found["left"].values()) == {0}, found["left"]
    assert found["solved_again"]
