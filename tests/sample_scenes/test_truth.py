"""The whole way on the closed room, small: captured, calibrated, rebuilt, filled, and held against the truth.

`tests/benchmarks/methods.py` does it in full size; these bounds are what the small size allows.
"""

import pytest

from expanded_panoramas.ibl_toolkit import metrics
from expanded_panoramas.sample_scenes.closed_room import LARGE_LAMPS, SMALL_LAMPS

WIDTH, HEIGHT, SAMPLES = 128, 72, 64
UNCHANGED_DB = 45.0
MIRRORED_LAMPS = 6
"""At most so many pixels of the mirror ball show a lamp, smaller than a pixel, that the truth missed."""


@pytest.mark.parametrize(
    ("lamps", "changed_db", "above_directional_db"), [(LARGE_LAMPS, 31.0, 11.0), (SMALL_LAMPS, 26.0, 5.0)]
)
def test_the_default_method_comes_near_the_truth(
    fresh_blend, tmp_path, monkeypatch, lamps, changed_db, above_directional_db
):
    from expanded_panoramas.cycles_integration import preparation
    from expanded_panoramas.cycles_integration.rendering import Picture
    from expanded_panoramas.sample_scenes import closed_room_truth as room

    monkeypatch.setattr(preparation, "IRRADIANCE_WIDTH", 192)
    panorama = tmp_path / "room.exr"
    room.capture_panorama(lamps, panorama, 768, 8)
    truth = room.render_truth(lamps, WIDTH, HEIGHT, 96)
    scene, prepared = room.mixed_scene(panorama)
    assert prepared.at_depth.count >= 3

    def picture(**settings):
        return room.render_mixed(scene, tmp_path / "picture.exr", Picture(WIDTH, HEIGHT, seed=1, **settings))

    composite = picture(samples=SAMPLES)
    directional = picture(samples=SAMPLES, method="directional")
    room.hide_objects(scene)
    photograph = picture(samples=1)

    changed = metrics.changed_pixels(truth.with_objects, truth.without)
    error = metrics.psnr(composite, truth.with_objects, changed)
    assert error > changed_db
    assert error > metrics.psnr(directional, truth.with_objects, changed) + above_directional_db
    unchanged = metrics.unchanged_pixels(truth.with_objects, truth.without)
    assert metrics.psnr(composite, photograph, unchanged) > UNCHANGED_DB
    dots = metrics.new_white_dots(composite, truth.with_objects)
    assert not dots[unchanged].any()
    assert dots.sum() <= MIRRORED_LAMPS
