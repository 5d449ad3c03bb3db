"""An RGB-D file comes back as a light map whose light has a position."""

import numpy as np
import panoramas
import pytest

from expanded_panoramas.ibl_toolkit.images import RGBD, ImageError, read_panorama, write_rgbd

WIDTH = 128
DEPTH_MEDIAN, DEPTH_95 = 2e-3, 0.02  # relative; the mesh is flat between pixels of the map


@pytest.fixture
def rgbd_file(fresh_blend, tmp_path):
    """The closed room's own depth with a smooth picture; and the depth itself."""
    from expanded_panoramas.cycles_integration import maps

    image = panoramas.smooth_panorama(tmp_path / "smooth.exr", WIDTH)
    scene, here = panoramas.room_place(fresh_blend, image)
    depth = maps.render_depth(scene, here, WIDTH).depth
    path = tmp_path / "map.exr"
    write_rgbd(path, RGBD(read_panorama(image), depth, np.eye(3), 1.5))
    return path, depth


def test_its_surface_has_the_depth_of_the_file(fresh_blend, rgbd_file):
    from expanded_panoramas.cycles_integration import maps
    from expanded_panoramas.cycles_integration.rgbd_place import load_rgbd

    path, depth = rgbd_file
    scene = fresh_blend.data.scenes.new("loaded")
    loaded = load_rgbd(scene, path)
    found = maps.render_depth(scene, loaded.place, WIDTH).depth
    errors = np.abs(found / depth - 1)
    assert np.median(errors) < DEPTH_MEDIAN
    assert np.percentile(errors, 95) < DEPTH_95
    assert np.isfinite(found).mean() > 0.999  # a ray through a vertex itself may slip between the faces


def test_it_renders_as_the_photograph_from_its_centre(fresh_blend, rgbd_file, tmp_path):
    from expanded_panoramas.cycles_integration import preparation, rendering
    from expanded_panoramas.cycles_integration.rgbd_place import load_rgbd
    from expanded_panoramas.sample_scenes.closed_room_truth import add_objects, read_picture

    path, _ = rgbd_file
    scene = fresh_blend.data.scenes.new("loaded")
    load_rgbd(scene, path)
    add_objects(scene)
    preparation.prepare(scene)
    with rendering.panorama_camera(scene) as camera:
        size = rendering.Picture(WIDTH, WIDTH // 2, samples=4)
        rendering.render_picture(scene, camera, size, tmp_path / "whole.exr")
    picture, image = read_picture(tmp_path / "whole.exr"), read_panorama(path)
    changed = np.abs(picture - image).max(axis=2) > 0.02
    assert 0.005 < changed.mean() < 0.2
    assert np.array_equal(picture[: WIDTH // 8], image[: WIDTH // 8])


def test_a_panorama_without_depth_is_refused(fresh_blend, tmp_path):
    from expanded_panoramas.cycles_integration.rgbd_place import load_rgbd

    image = panoramas.smooth_panorama(tmp_path / "smooth.exr")
    with pytest.raises(ImageError, match="channel Z"):
        load_rgbd(fresh_blend.context.scene, image)
