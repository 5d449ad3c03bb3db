"""Surfaces along each ray, against boxes and balls whose distances are known."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

import small_scenes as small  # noqa: E402
from mathutils import Matrix, Vector  # noqa: E402

from expanded_panoramas.cycles_integration.layer_capture import capture_surfaces  # noqa: E402
from expanded_panoramas.cycles_integration.layer_render import LayerCapture  # noqa: E402
from expanded_panoramas.cycles_integration.solids import closed_solids  # noqa: E402
from expanded_panoramas.ibl_toolkit import equirectangular  # noqa: E402

EMISSION = "ShaderNodeEmission"
WIDTH = 64
TINY = LayerCapture(WIDTH, samples=1)
ROOM = np.array([[-3.0, -2.5, -1.2], [3.0, 2.5, 1.6]])
BOX = np.array([[1.0, -0.5, -0.7], [1.6, 0.7, 0.3]])
"""Hangs in the air."""
ORIGIN = (0.3, -0.2, 1.2)
RADIUS = 0.4
LEVEL = Matrix.Translation(ORIGIN)
WALL, SIDE = (0.2, 0.5, 0.8), (0.9, 0.3, 0.1)
METRES = 2e-3
DIRECTIONS = equirectangular.pixel_directions(WIDTH, WIDTH // 2).astype(np.float64)


def surfaces(*arguments):
    """The layers of `capture_surfaces` but for the backs of solids."""
    return [layer for layer in capture_surfaces(*arguments).layers if "back" not in layer.name]


def add_box(scene, corners, material, *, inward=False):
    """A closed box of two corners (2, 3) as seen from ORIGIN."""
    low, high = corners + ORIGIN
    places = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new("box")
    mesh.from_pydata(places, [], [face[::-1] for face in faces] if inward else faces)
    mesh.materials.append(material)
    thing = bpy.data.objects.new("box", mesh)
    scene.collection.objects.link(thing)
    return thing


def crossings(corners, eye, directions):
    """Distances at which rays go in and out of a box; in > out where they miss it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        first, last = ((corner - eye) / directions for corner in corners)
    return np.minimum(first, last).max(axis=-1), np.maximum(first, last).min(axis=-1)


def box_depth(directions, eye=(0, 0, 0)):
    near, far = crossings(BOX, eye, directions)
    return np.where((near < far) & (far > 0), near, np.inf)


def room_depth(directions, eye=(0, 0, 0)):
    return crossings(ROOM, eye, directions)[1]


@pytest.fixture
def scene(fresh_blend):
    made = fresh_blend.context.scene
    add_box(made, ROOM, small.material(EMISSION, Color=(*WALL, 1)), inward=True).name = "room"
    return made


@pytest.fixture
def furnished(scene):
    add_box(scene, BOX, small.material(EMISSION, Color=(*SIDE, 1)))
    return scene


def test_the_second_surface_is_the_wall_behind_with_its_own_colour(furnished):
    panorama = capture_surfaces(furnished, LEVEL, RADIUS, TINY)
    first, _, second = panorama.layers
    front = np.minimum(box_depth(DIRECTIONS), room_depth(DIRECTIONS))
    assert first.mask.all()
    np.testing.assert_allclose(first.depth, front, atol=METRES)
    assert second.mask.any()
    assert not (second.mask & ~np.isfinite(box_depth(DIRECTIONS))).any()
    np.testing.assert_allclose(second.depth[second.mask], room_depth(DIRECTIONS)[second.mask], atol=METRES)
    np.testing.assert_allclose(
        second.radiance[second.mask], np.broadcast_to(WALL, (second.mask.sum(), 3)), rtol=1e-3
    )
    np.testing.assert_allclose(panorama.origin, ORIGIN, atol=1e-6)


def test_all_that_a_view_in_the_radius_sees_is_in_a_layer_and_not_much_else(furnished):
    width = 256
    _, second = surfaces(furnished, LEVEL, RADIUS, LayerCapture(width, samples=1))
    uncovered = np.zeros((width // 2, width), bool)
    rng = np.random.default_rng(5)
    for _ in range(100):
        eye = rng.normal(size=3)
        eye *= RADIUS / np.linalg.norm(eye)
        rays = rng.normal(size=(20000, 3))
        seen = room_depth(rays, eye) < box_depth(rays, eye)
        points = eye + rays[seen] * room_depth(rays[seen], eye)[:, None]
        uv = equirectangular.uv_from_direction(points)
        column, row = np.floor(uv * (width, width // 2)).astype(int).T
        uncovered[row, column] = True
    is_hidden = np.isfinite(box_depth(equirectangular.pixel_directions(width, width // 2).astype(float)))
    uncovered &= is_hidden
    assert 250 < uncovered.sum() < 0.8 * is_hidden.sum()
    assert second.mask[uncovered].all()
    assert second.mask.sum() < 1.3 * uncovered.sum()


def test_a_solid_has_no_inside_and_what_it_stands_on_goes_on_beneath(scene):
    foot = ROOM[0, 2]
    add_box(scene, np.array([[1, -0.5, foot], [1.6, 0.7, 0.3]]), small.material(EMISSION))
    layers = surfaces(scene, LEVEL, 1.0, LayerCapture(WIDTH, samples=1, most=5))
    assert len(layers) == 2
    seen = layers[1].mask
    np.testing.assert_allclose(layers[1].depth[seen], room_depth(DIRECTIONS)[seen], atol=METRES)


def test_the_far_side_of_a_solid_that_a_view_sees_is_in_a_layer_as_it_is_lit_outside(scene):
    centre, size, width, radius = np.array([2.0, 0, 0]), 0.8, 128, 0.5
    ball = small.add_ball(scene, small.material(small.DIFFUSE), size, Vector(ORIGIN) + Vector(centre))
    options = LayerCapture(width, samples=4)
    layers = {layer.name: layer for layer in capture_surfaces(scene, LEVEL, radius, options).layers}
    back = layers["back of surface 1"]
    directions = equirectangular.pixel_directions(width, width // 2).astype(float)
    along = directions @ centre
    half = np.sqrt(np.maximum(along**2 - centre @ centre + size**2, 0))
    far_side = np.where((half > 0) & (along > 0), along + half, np.nan)
    normal = (far_side[..., None] * directions - centre) / size
    to_plane = np.abs(np.einsum("ijk,ijk->ij", far_side[..., None] * directions, normal))
    assert back.mask[to_plane < radius].mean() > 0.98
    assert not back.mask[~(to_plane < 1.4 * radius)].any()
    np.testing.assert_allclose(back.depth[back.mask], far_side[back.mask], rtol=0.01)
    assert np.median(back.radiance[back.mask]) > 0.15  # the walls light it; its inside is dark
    assert ball.visible_camera


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"use_persistent_data": True},
        {"film_exposure": 4.0},
        {"film_exposure": 0.25},
        {"sample_clamp_direct": 0.1, "sample_clamp_indirect": 0.1},
    ],
)
def test_settings_of_the_artist_s_renders_leave_geometry_and_light_as_they_are(fresh_blend, settings):
    scene = fresh_blend.context.scene
    scene.render.engine = "CYCLES"
    glow = small.material(EMISSION, Color=(0.05, 0.05, 0.05, 1))
    add_box(scene, np.array([[-4.0] * 3, [4.0] * 3]), glow, inward=True)
    small.add_ball(scene, glow, 0.8, Vector(ORIGIN) + Vector((2, 0, 0)))
    for name, value in settings.items():
        setattr(scene.render if hasattr(scene.render, name) else scene.cycles, name, value)
    options = LayerCapture(WIDTH, samples=1, most=3)
    layers = {layer.name: layer for layer in capture_surfaces(scene, LEVEL, 0.5, options).layers}
    assert {name: np.count_nonzero(layer.mask) for name, layer in layers.items()} == {
        "surface 1": WIDTH * WIDTH // 2,
        "back of surface 1": 8,
        "surface 2": 52,
    }
    wall = crossings(np.array([[-4.0] * 3, [4.0] * 3]), 0, DIRECTIONS)[1]
    behind = layers["surface 2"]
    np.testing.assert_allclose(behind.depth[behind.mask], wall[behind.mask], atol=METRES)
    for layer in layers.values():
        np.testing.assert_allclose(layer.radiance[layer.mask], 0.05, rtol=1e-3)


def test_open_surfaces_are_seen_from_behind(scene):
    for distance in (1.0, 2.0):
        place = Vector(ORIGIN) + Vector((distance, 0, 0))
        small.add_plane(scene, small.material(EMISSION), 0.5, place, normal=(1, 0, 0))
    layers = surfaces(scene, LEVEL, 0.9, TINY)
    assert [round(float(np.nanmin(layer.depth)), 1) for layer in layers[1:]] == [2.0, 3.0]


def test_a_hidden_surface_lies_in_the_shadow_of_what_hides_it(fresh_blend):
    scene = fresh_blend.context.scene
    small.add_plane(scene, small.material(small.DIFFUSE), 20)
    small.add_ball(scene, small.material(small.DIFFUSE), 0.5, (2, 0, 0.6))
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "POINT"))
    lamp.data.energy, lamp.data.shadow_soft_size = 100, 0
    lamp.location = (0, 0, 1.5)  # where the panorama is: all it cannot see is dark
    scene.collection.objects.link(lamp)
    first, second = surfaces(scene, Matrix.Translation((0, 0, 1.5)), 0.5, TINY)
    hidden = second.mask & np.isfinite(second.depth)
    assert hidden.sum() > 12
    assert first.radiance[-8:].min() > 0.1  # the floor below
    assert second.radiance[hidden].max() < 1e-3


def test_sky_lies_at_infinity_before_and_behind(fresh_blend):
    scene = fresh_blend.context.scene
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.4, 1)
    small.add_ball(scene, small.material(EMISSION), 0.4, (2, 0, 0))
    first, second = surfaces(scene, Matrix(), 0.3, TINY)
    assert first.mask.all()
    assert np.isinf(first.depth[:, 0]).all()
    assert np.isinf(second.depth[second.mask]).all()
    np.testing.assert_allclose(second.radiance[second.mask].mean(axis=0), (0.1, 0.2, 0.4), rtol=1e-3)


def test_colours_of_edges_are_not_mixed(furnished):
    fine = LayerCapture(WIDTH, samples=9)
    for layer in capture_surfaces(furnished, LEVEL, RADIUS, fine).layers:
        is_box = np.isclose(layer.depth, box_depth(DIRECTIONS), atol=METRES) | ("back" in layer.name)
        for pixels, colour in ((layer.mask & is_box, SIDE), (layer.mask & ~is_box, WALL)):
            np.testing.assert_allclose(
                layer.radiance[pixels], np.broadcast_to(colour, (pixels.sum(), 3)), rtol=1e-3
            )


def state(scene):
    """Names of all data-blocks but Blender's own picture of the last render; settings that are lent."""
    blocks = {str(block) for block in bpy.data.user_map() if getattr(block, "type", "") != "RENDER_RESULT"}
    flags = [(thing.name, thing.pass_index, thing.visible_camera) for thing in scene.objects]
    render, layer = scene.render, scene.view_layers[0]
    sizes = render.resolution_x, render.filepath, render.engine, scene.cycles.samples, scene.camera
    return blocks, flags, sizes, layer.material_override, layer.name


def test_the_scene_is_as_it_was_also_after_an_error(furnished):
    before = state(furnished)
    capture_surfaces(furnished, LEVEL, RADIUS, TINY)
    assert state(furnished) == before

    def stop(step):
        if step == "surface 2":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        capture_surfaces(furnished, LEVEL, RADIUS, TINY, stop)
    assert state(furnished) == before


def test_linked_and_instanced_objects_are_peeled_like_others(fresh_blend, tmp_path):
    scene = fresh_blend.context.scene
    thing = add_box(scene, BOX, small.material(EMISSION, Color=(*SIDE, 1)))
    kept = bpy.data.collections.new("box")
    kept.objects.link(thing)
    bpy.data.libraries.write(str(tmp_path / "box.blend"), {kept})
    fresh_blend.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    add_box(scene, ROOM, small.material(EMISSION, Color=(*WALL, 1)), inward=True)
    with bpy.data.libraries.load(str(tmp_path / "box.blend"), link=True) as (_, ours):
        ours.collections = ["box"]
    instance = bpy.data.objects.new("instance", None)
    instance.instance_type, instance.instance_collection = "COLLECTION", ours.collections[0]
    scene.collection.objects.link(instance)
    first, second = surfaces(scene, LEVEL, RADIUS, TINY)
    is_box = np.isfinite(box_depth(DIRECTIONS))
    np.testing.assert_allclose(first.depth[is_box], box_depth(DIRECTIONS)[is_box], atol=METRES)
    np.testing.assert_allclose(second.depth[second.mask], room_depth(DIRECTIONS)[second.mask], atol=METRES)
    linked = ours.collections[0].objects[0]
    assert (linked.pass_index, linked.visible_camera) == (0, True)


def test_solids_are_closed_face_outwards_and_do_not_hold_the_origin(furnished):
    open_box = add_box(furnished, BOX, None)
    faces = [tuple(face.vertices) for face in open_box.data.polygons][:5]
    places = [tuple(vertex.co) for vertex in open_box.data.vertices]
    open_box.data.clear_geometry()
    open_box.data.from_pydata(places, [], faces)
    split = add_box(furnished, BOX, None)
    apart = [places[k] for face in split.data.polygons for k in face.vertices]
    split.data.clear_geometry()
    split.data.from_pydata(apart, [], np.arange(24).reshape(6, 4).tolist())
    add_box(furnished, BOX, None, inward=True)
    add_box(furnished, ROOM, None)
    found = closed_solids(furnished.view_layers[0], Vector(ORIGIN))
    assert found == {furnished.objects["box"], split}


def test_other_options_and_radii_are_refused(furnished):
    with pytest.raises(ValueError, match="radius -1 m: must be finite and above 0"):
        capture_surfaces(furnished, LEVEL, -1, TINY)
    with pytest.raises(ValueError, match="0 layers of width 64 px"):
        LayerCapture(64, most=0)
