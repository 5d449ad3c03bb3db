"""Every method shows the photograph where nothing is new, though lamps were taken out of its light."""

import numpy as np
import panoramas
import pytest
import small_scenes
from box_room import prepare

from expanded_panoramas.ibl_toolkit.metrics import psnr
from expanded_panoramas.sample_scenes import closed_room_truth

EXACT = 2e-5  # of the brightest radiance
SINGLE_MEAN = 0.02  # relative: `single` is a noisy render
FAR, FAR_SINGLE = 40, 25  # [dB], against the photograph


@pytest.fixture
def furnished(fresh_blend, tmp_path):
    """The closed room, a lamp in its smooth photograph; a camera, and one that sees the lamp."""
    image = panoramas.smooth_panorama(tmp_path / "smooth.exr", 256)
    from expanded_panoramas.ibl_toolkit.images import read_panorama

    picture = read_panorama(image)
    picture[12:24, 60:76] = (90, 70, 50)
    scene, here = panoramas.room_place(fresh_blend, panoramas.write_panorama(tmp_path / "lit.exr", picture))
    camera = closed_room_truth.add_camera(scene)
    up = small_scenes.add_camera(scene, (0.2, 0, 1.5), (0.2, 1, 2.6), field_of_view=1.2)
    prepared = prepare(scene, 8)
    assert prepared.at_depth.count
    assert prepared.at_infinity.count
    return scene, here, (camera, up)


def picture(scene, camera, path, **settings):
    from expanded_panoramas.cycles_integration.rendering import Picture, render_picture

    render_picture(scene, camera, Picture(48, 27, seed=1, **settings), path)
    return closed_room_truth.read_picture(path)


@pytest.mark.parametrize("method", ["catcher", "difference", "directional"])
def test_without_objects_the_picture_is_the_photograph(furnished, tmp_path, method):
    """Where the lamp is seen, too."""
    scene, _, cameras = furnished
    found = [picture(scene, camera, tmp_path / "p.exr", method=method, samples=4) for camera in cameras]
    assert found[1].max() > 50
    prepare(scene, 0)
    for camera, shown in zip(cameras, found, strict=True):
        plain = picture(scene, camera, tmp_path / "plain.exr", method="catcher", samples=1)
        assert np.abs(shown - plain).max() < EXACT * plain.max()


def test_single_shows_the_photograph_on_average(furnished, tmp_path):
    scene, _, cameras = furnished
    for camera in cameras:
        shown = picture(scene, camera, tmp_path / "p.exr", method="single", samples=64)
        plain = picture(scene, camera, tmp_path / "plain.exr", method="catcher", samples=1)
        assert shown.mean() == pytest.approx(plain.mean(), rel=SINGLE_MEAN)


@pytest.mark.parametrize("method", ["catcher", "single", "difference", "directional"])
def test_objects_appear_and_nothing_else_changes(furnished, tmp_path, method):
    """The lamp's shadow falls on the floor; pixels far from the objects stay the photograph's."""
    scene, _, (camera, _) = furnished
    plain = picture(scene, camera, tmp_path / "plain.exr", method="catcher", samples=1)
    closed_room_truth.add_objects(scene)
    shown = picture(scene, camera, tmp_path / "p.exr", method=method, samples=32)
    assert np.isfinite(shown).all()
    change = (shown - plain).mean(axis=2)
    assert (np.abs(change) > 0.1).mean() > 0.02
    assert change[12:20, 20:32].min() < -0.05
    far = np.zeros(change.shape, bool)
    far[:6, :12] = far[:6, -12:] = True
    assert psnr(shown, plain, far) > (FAR_SINGLE if method == "single" else FAR)
