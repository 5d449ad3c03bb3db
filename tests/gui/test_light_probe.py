"""Lights from a photograph, by clicks in the window."""

import numpy as np
import pytest

JOBS = "jobs_light_probe.py"
LAMPS = [(0.5, 0.3, 0.8), (-0.7, 0.1, 0.6)]


def test_the_photo_gives_its_lamps_in_one_step_of_undo(notes):
    found = notes["lights_by_button"]
    assert len(found["suns"]) == 2
    for (*direction, _), lamp in zip(found["suns"], LAMPS, strict=True):
        assert np.degrees(np.arccos(np.dot(direction, lamp) / np.linalg.norm(lamp))) < 1.5
    assert found["suns"][0][3] == pytest.approx(3)
    assert sorted(found["after_undo"]) == ["Camera", "Cube", "Light"]


def test_the_photo_gives_a_calibrated_panorama(notes):
    found = notes["panorama_by_button"]
    assert found["name"] == "probe_photo_panorama.exr"
    assert found["camera_height"] == pytest.approx(0.05)
