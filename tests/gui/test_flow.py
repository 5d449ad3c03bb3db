"""The five minutes from a file to a picture, with mouse and keys: each stage, back to the start and again."""

import pytest

JOBS = "jobs_flow.py"
TILT_DEG = 0.5
SHARE = 0.05


@pytest.fixture(scope="module")
def stages(notes):
    names = ("start", "dropped", "picked", "drawn", "ball", "sent", "prepared", "camera", "rendered")
    return dict(zip(names, notes["five_minutes"]["stages"], strict=True))


def test_the_sample_comes_with_a_button(notes):
    found = notes["sample"]
    assert (found["picks"], len(found["sizes"])) == (11, 6)
    assert found["camera_height"] == pytest.approx(1.32)


def test_a_dropped_panorama_is_there(stages):
    assert (stages["start"]["image"], stages["dropped"]["image"]) == (False, True)
    assert not stages["dropped"]["picks"]


def test_four_clicks_calibrate_as_the_sample_is(notes, stages):
    assert stages["picked"]["solved"]
    assert stages["picked"]["camera_height"] == pytest.approx(1.32)
    assert stages["picked"]["tilt_deg"] == pytest.approx(notes["sample"]["tilt_deg"], abs=TILT_DEG)


def test_the_room_has_its_size(notes, stages):
    height = notes["sample"]["sizes"]["walls"][2]
    assert stages["drawn"]["sizes"]["floor"][:2] == pytest.approx([4.24, 3.24], rel=SHARE)
    assert stages["drawn"]["sizes"]["walls"] == pytest.approx([4.24, 3.24, height], rel=SHARE)


def test_ball_light_and_camera_come(stages):
    assert stages["ball"]["ball"] == pytest.approx([0, 0, 0.15], abs=1e-3)
    assert stages["sent"]["ball"] == pytest.approx([0.71, -0.64, 0.15], abs=0.02)
    assert stages["prepared"]["is_prepared"]
    assert any("Lamp" in name for name in stages["prepared"]["objects"])
    assert stages["camera"]["has_camera"]
    assert stages["rendered"]["layers"] > 1


def test_undo_goes_back_to_the_start(notes):
    found = notes["five_minutes"]
    assert found["back"] == found["stages"][-2::-1]


def test_redo_comes_again(notes):
    found = notes["five_minutes"]
    assert found["again"] == found["stages"][1:]
