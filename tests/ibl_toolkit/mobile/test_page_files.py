"""The page's scene and picture as files: what is written is what was given."""

import struct
from dataclasses import replace

import cv2
import numpy as np
import pytest
from web_pages import camera, photo, sky, still_life

from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.images.png import srgb_codes
from expanded_panoramas.ibl_toolkit.mobile.page_files import write_page_file
from expanded_panoramas.ibl_toolkit.mobile.page_picture import page_picture
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import suggested_settings

KINDS = [suggested_settings(4.0, 64, "float32", 0.0, method) for method in ("hard", "vsm")]
SMALL = replace(camera(), width=60, height=30)


def test_pictures_are_what_the_page_shows(tmp_path):
    given = still_life(), KINDS, sky(), SMALL
    right = page_picture(given[0], KINDS[0], *given[2:]).radiance
    for name in ("a.png", "a.exr", "a.glb"):
        write_page_file(tmp_path / name, *given)
    np.testing.assert_allclose(read_panorama(tmp_path / "a.exr"), right, rtol=1e-6)
    codes = cv2.cvtColor(cv2.imread(str(tmp_path / "a.png")), cv2.COLOR_BGR2RGB)
    np.testing.assert_array_equal(codes, srgb_codes(right, sky().exposure))
    assert struct.unpack("<4s", (tmp_path / "a.glb").read_bytes()[:4]) == (b"glTF",)
    with pytest.raises(ValueError, match=r"must end in \.html, \.glb, \.png, \.exr"):
        write_page_file(tmp_path / "a.jpg", *given)


def test_a_real_thing_that_throws_none_leaves_no_shadow_and_still_receives(tmp_path):
    """Seen over white: each pixel is what shadows leave."""
    scene = still_life(("sun",), ("support",) * 3, 0.0)
    white = replace(sky(), image=np.ones((8, 16, 3), np.float32))
    floor, box, ball = scene.meshes

    def shown(*meshes):
        return page_picture(replace(scene, meshes=meshes), KINDS[0], white, SMALL)

    both = shown(floor, box, ball)
    one = shown(floor, box, replace(ball, throws=False))
    on_floor = (both.mesh == 0) & (one.mesh == 0)
    darker = (both.radiance < one.radiance).any(axis=2) & on_floor
    assert darker.sum() > 10
    assert (one.radiance[on_floor] < 1).any()  # that of the box is still there
    none = shown(*(replace(mesh, throws=False) for mesh in (floor, box)), ball)
    assert (none.radiance[(none.mesh == 0)] < 1).any()


def test_a_photo_must_be_of_the_pictures_size():
    with pytest.raises(ValueError, match="photo of 480 x 320 px must be as large"):
        page_picture(still_life(), KINDS[0], photo(camera()), SMALL)
