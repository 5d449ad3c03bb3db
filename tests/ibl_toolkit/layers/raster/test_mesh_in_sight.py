import numpy as np
import pytest
from box_layers import BOTH, box_depth

from expanded_panoramas.ibl_toolkit.layers.meshes.layer_mesh import uniform_mesh, uniform_triangles
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer
from expanded_panoramas.ibl_toolkit.layers.raster.mesh_in_sight import pixels_in_sight
from expanded_panoramas.ibl_toolkit.layers.raster.rasterizer import rasterize
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole


def blocks_at_random(mapping, width, seed):
    """Depths that jump from 0.5 to 6 m, and a domain with holes, in blocks of a few pixels."""
    random = np.random.default_rng(seed)
    shape = box_depth(mapping, width).shape
    coarse = random.uniform(0.5, 6.0, (shape[0] // 4, shape[1] // 4)).astype(np.float32)
    known = random.uniform(size=(shape[0] // 8, shape[1] // 8)) < 0.7
    depth = np.where(np.kron(known, np.ones((8, 8))) > 0, np.kron(coarse, np.ones((4, 4))), np.nan)
    return Layer("blocks", mapping, {"depth": depth.astype(np.float32)})


@pytest.mark.parametrize("mapping", BOTH)
@pytest.mark.parametrize("seed", range(4))
def test_what_is_left_out_is_not_seen(mapping, seed):
    layer = blocks_at_random(mapping, 384, seed)
    whole = uniform_mesh(layer)
    random = np.random.default_rng(100 + seed)
    for _ in range(4):
        camera = Pinhole.looking_at(random.uniform(-1, 1, 3), random.normal(size=3), 50, 96, 64)
        pixels = pixels_in_sight(layer, camera)
        part = uniform_mesh(layer, pixels)
        assert len(part.triangles) < len(whole.triangles)
        seen, expected = (rasterize(mesh.points, mesh.triangles, camera) for mesh in (part, whole))
        np.testing.assert_array_equal(seen.distance, expected.distance)


@pytest.mark.parametrize("mapping", BOTH)
def test_little_is_left_of_a_room(mapping):
    layer = Layer("room", mapping, {"depth": box_depth(mapping, 1536)})
    camera = Pinhole.looking_at((0.3, -0.4, 0.2), (2.0, -0.5, 0.1), 40, 96, 64)
    assert pixels_in_sight(layer, camera).mean() < 0.25


@pytest.mark.parametrize("mapping", BOTH)
def test_triangles_are_counted_without_making_them(mapping):
    layer = blocks_at_random(mapping, 96, 5)
    assert uniform_triangles(layer) == len(uniform_mesh(layer).triangles)
