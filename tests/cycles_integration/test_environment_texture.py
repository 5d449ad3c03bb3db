"""Our look-up of an equirectangular image against Cycles' Environment Texture, at the same directions.

One face per direction, flat in an attribute, under an orthographic camera with one pixel per face: so
Cycles looks up exactly the direction that we do, wherever in the pixel its sample falls.

Both wrap round the seam and agree up to half a pixel from the poles.  Beyond that, they differ: Cycles
repeats the image upwards, so that the row above the top one is the bottom one; ours is the top one turned
by half a width, which is what is there.  The last test states Cycles' way, so that a change of it shows.
"""

import numpy as np
import OpenEXR
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular as er
from expanded_panoramas.ibl_toolkit.images import write_exr

pytestmark = pytest.mark.usefixtures("fresh_blend")

LOOK_UP = 5e-6  # of values up to 1: Cycles maps directions in single precision
AT_POLES = 5e-5  # where that precision turns more quickly round the pole
CENTRES = 1e-4  # of a panoramic camera, whose filter has a width of 0.01 px
WIDTH, HEIGHT = 16, 8
POLE = 0.5 / HEIGHT  # v within half a pixel of a pole


@pytest.fixture
def image():
    return np.random.default_rng(0).random((HEIGHT, WIDTH, 3)).astype(np.float32)


def test_anywhere_but_at_the_poles(fresh_blend, image, tmp_path):
    rng = np.random.default_rng(1)
    uv = np.stack([rng.random(2048), rng.uniform(POLE, 1 - POLE, 2048)], axis=-1)
    d = er.direction_from_uv(uv)
    np.testing.assert_allclose(
        cycles_look_up(fresh_blend, image, d, tmp_path), er.sample(image, d), atol=LOOK_UP
    )


def test_at_pixel_centres_and_across_the_seam(fresh_blend, image, tmp_path):
    i, j = np.meshgrid(np.arange(-1, WIDTH, 0.25), np.arange(HEIGHT))
    uv = er.uv_from_pixel(np.stack([i, j], axis=-1).reshape(-1, 2), WIDTH, HEIGHT)
    d = er.direction_from_uv(uv)
    np.testing.assert_allclose(
        cycles_look_up(fresh_blend, image, d, tmp_path), er.sample(image, d), atol=LOOK_UP
    )


def test_world_seen_by_a_panoramic_camera(fresh_blend, image, tmp_path):
    """The whole way of the conventions: a camera that looks along +x has the image's middle in its middle."""
    bpy = fresh_blend
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    background = with_environment_texture(bpy, scene.world, image, tmp_path)
    scene.world.node_tree.links.new(
        background.outputs["Color"], world_background(scene.world).inputs["Color"]
    )
    camera = add_camera(bpy, "PANO")
    camera.rotation_euler = (np.pi / 2, 0, -np.pi / 2)
    set_panorama_type(camera.data)
    got = render(bpy, (WIDTH, HEIGHT), tmp_path)
    np.testing.assert_allclose(got, image, atol=CENTRES)


def test_cycles_repeats_the_image_over_the_poles(fresh_blend, image, tmp_path):
    rng = np.random.default_rng(2)
    v = np.concatenate([rng.uniform(0.001, POLE, 256), rng.uniform(1 - POLE, 0.999, 256)])
    uv = np.stack([rng.random(512), v], axis=-1)
    got = cycles_look_up(fresh_blend, image, er.direction_from_uv(uv), tmp_path)
    repeated = np.vstack([image[-1:], image, image[:1]])
    x, y = (er.pixel_from_uv(uv, WIDTH, HEIGHT) + np.array([0, 1])).T
    a, b = (x % 1)[:, None], (y % 1)[:, None]
    i, j = np.floor(x).astype(int) % WIDTH, np.floor(y).astype(int)
    top = (1 - a) * repeated[j, i] + a * repeated[j, (i + 1) % WIDTH]
    bottom = (1 - a) * repeated[j + 1, i] + a * repeated[j + 1, (i + 1) % WIDTH]
    np.testing.assert_allclose(got, (1 - b) * top + b * bottom, atol=AT_POLES)
    assert np.abs(got - er.sample(image, er.direction_from_uv(uv))).max() > 0.1


def cycles_look_up(bpy, image, directions, folder):
    """Values (n, 3) that an Environment Texture node gives for directions (n, 3)."""
    columns = 64
    rows = max(4, -(-len(directions) // columns))  # Blender renders no fewer
    padded = np.resize(directions, (rows * columns, 3)).astype(np.float32)
    grid = add_grid(bpy, columns, rows)
    grid.data.attributes.new("direction", "FLOAT_VECTOR", "FACE").data.foreach_set("vector", padded.ravel())
    material = bpy.data.materials.new("look-up")
    grid.data.materials.append(material)
    material.use_nodes = True
    environment = with_environment_texture(bpy, material, image, folder)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    attribute = nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = "direction"
    emission = nodes.new("ShaderNodeEmission")
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    links.new(attribute.outputs["Vector"], environment.inputs["Vector"])
    links.new(environment.outputs["Color"], emission.inputs["Color"])
    links.new(emission.outputs["Emission"], output.inputs["Surface"])
    camera = add_camera(bpy, "ORTHO")
    camera.location = (columns / 2, rows / 2, 1)
    camera.data.ortho_scale = max(columns, rows)
    return render(bpy, (columns, rows), folder)[::-1].reshape(-1, 3)[: len(directions)]


def with_environment_texture(bpy, owner, image, folder):
    """An Environment Texture node of `image` in the owner's node tree."""
    path = folder / "panorama.exr"
    write_exr(path, {name: image[..., k] for k, name in enumerate("RGB")})
    owner.use_nodes = True
    node = owner.node_tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = bpy.data.images.load(str(path))
    node.image.colorspace_settings.name = "Non-Color"
    node.interpolation = "Linear"
    node.projection = "EQUIRECTANGULAR"
    return node


def world_background(world):
    return next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")


def add_grid(bpy, columns, rows):
    """Unit faces over (0, 0) .. (columns, rows); face k = row * columns + column."""
    x, y = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
    vertices = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=-1).tolist()
    stride = columns + 1
    first = (np.arange(rows)[:, None] * stride + np.arange(columns)).ravel()
    faces = np.stack([first, first + 1, first + stride + 1, first + stride], axis=-1).tolist()
    mesh = bpy.data.meshes.new("grid")
    mesh.from_pydata(vertices, [], faces)
    grid = bpy.data.objects.new("grid", mesh)
    bpy.context.scene.collection.objects.link(grid)
    return grid


def add_camera(bpy, kind):
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = kind
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    return camera


def set_panorama_type(camera):
    """Since Blender 5.0 a property of the camera, before of its Cycles settings."""
    owner = camera if hasattr(camera, "panorama_type") else camera.cycles
    owner.panorama_type = "EQUIRECTANGULAR"


def render(bpy, size, folder):
    """Render on the CPU, one sample a pixel; (H, W, 3), row 0 on top."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 1
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    scene.cycles.filter_width = 0.01
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode = "OPEN_EXR", "RGB"
    settings.color_depth, settings.exr_codec = "32", "ZIP"
    scene.render.filepath = str(folder / "render.exr")
    bpy.ops.render.render(write_still=True)
    return read_rendering(folder / "render.exr")


def read_rendering(path):
    """As it stands: `read_panorama` refuses what is not 2:1."""

    with OpenEXR.File(str(path)) as file:
        return np.array(file.channels()["RGB"].pixels)
