"""Pieces that keep their picture, and the UV layer, against the look-up that Cycles renders."""

import numpy as np
import pytest
from room_job import SIZE, built, picture

from expanded_panoramas.ibl_toolkit import equirectangular

SHOWN = 0.01  # between a rendered pixel and the picture looked up in numpy; a pixel is 1/256
SAME = 1e-4  # between two renders of the same look-up


@pytest.fixture
def place(fresh_blend, tmp_path):
    from expanded_panoramas.cycles_integration import lookup

    built(fresh_blend, tmp_path)
    place = fresh_blend.context.scene.panorama_place
    lookup.build_lookup(place)
    return place


def tile(bpy, name="tile", location=(1.5, 0.6, 0.4)):
    """An upright square of 0.4 m that faces the camera of `render`, off the picture's seam."""
    mesh = bpy.data.meshes.new(name)
    corners = [(0, -0.2, -0.2), (0, 0.2, -0.2), (0, 0.2, 0.2), (0, -0.2, 0.2)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    thing = bpy.data.objects.new(name, mesh)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.view_layer.update()
    return thing


def render(bpy, place, thing, tmp_path, width=8):
    """(width, width, 3): the tile, seen alone and flat-on, its left edge at −y, through the look-up."""
    from expanded_panoramas.cycles_integration import capture, materials

    scene = bpy.data.scenes.new("Look")
    data = bpy.data.cameras.new("Look")
    data.type, data.ortho_scale = "ORTHO", 0.4
    camera = bpy.data.objects.new("Look", data)
    local_from_camera = np.array([[0, 0, 1, 1], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)
    camera.matrix_world = (np.array(thing.matrix_world) @ local_from_camera).T
    for other in (thing, camera):
        scene.collection.objects.link(other)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = width
    scene.cycles.samples = 1
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    capture.sample_pixel_centres(scene)
    scene.view_layers[0].material_override = materials.backplate_material(place)
    try:
        return capture.render_passes(scene)["Combined"][..., :3]
    finally:
        bpy.data.scenes.remove(scene)


def expected(place, thing, width=8):
    """What numpy looks up in the picture for the same pixels."""
    across = (np.arange(width) + 0.5) / width - 0.5
    z, y = np.meshgrid(-across, across, indexing="ij")
    local = np.stack([np.zeros_like(y), 0.4 * y, 0.4 * z, np.ones_like(y)], axis=-1)
    panorama_from_local = np.array(place.origin.matrix_world.inverted() @ thing.matrix_world)
    return equirectangular.sample(picture(), (local @ panorama_from_local.T)[..., :3])


def store(place, *things):
    from expanded_panoramas.cycles_integration import picture_coordinates

    picture_coordinates.store_positions(place, list(things))


def clear(*things):
    from expanded_panoramas.cycles_integration import picture_coordinates

    return picture_coordinates.clear_positions(list(things))


def test_moved_bent_and_cleared(fresh_blend, place, tmp_path):
    bpy = fresh_blend
    thing = tile(bpy)
    before = render(bpy, place, thing, tmp_path)
    assert np.abs(before - expected(place, thing)).max() < SHOWN
    store(place, thing)
    assert np.abs(render(bpy, place, thing, tmp_path) - before).max() < SAME
    thing.location, thing.rotation_euler, thing.scale = (-1.2, 0.9, 1.3), (0.3, 0.2, 2), (1, 1, 1)
    bpy.context.view_layer.update()
    assert np.abs(render(bpy, place, thing, tmp_path) - before).max() < SAME
    place.origin.location.z += 0.5  # a later calibration does not change what was kept either
    bpy.context.view_layer.update()
    assert np.abs(render(bpy, place, thing, tmp_path) - before).max() < SAME
    assert clear(thing) == 1
    live = render(bpy, place, thing, tmp_path)
    assert np.abs(live - expected(place, thing)).max() < SHOWN
    assert np.abs(live - before).max() > 10 * SHOWN


def test_a_duplicate_keeps_its_picture_and_stores_another(fresh_blend, place, tmp_path):
    bpy = fresh_blend
    first = tile(bpy)
    before = render(bpy, place, first, tmp_path)
    store(place, first)
    second = first.copy()  # shares the mesh
    second.location = (-1.0, 1.0, 1.0)
    bpy.context.scene.collection.objects.link(second)
    bpy.context.view_layer.update()
    assert np.abs(render(bpy, place, second, tmp_path) - before).max() < SAME
    store(place, second)  # … which cannot show two parts of the picture at once
    assert first.data != second.data
    assert np.abs(render(bpy, place, first, tmp_path) - before).max() < SAME
    assert np.abs(render(bpy, place, second, tmp_path) - expected(place, second)).max() < SHOWN


def test_modifiers_carry_it_along(fresh_blend, place, tmp_path):
    bpy = fresh_blend
    thing = tile(bpy)
    before = render(bpy, place, thing, tmp_path)
    store(place, thing)
    modifier = thing.modifiers.new("Divide", "SUBSURF")
    modifier.subdivision_type, modifier.levels, modifier.render_levels = "SIMPLE", 2, 2
    thing.location.x += 0.7
    bpy.context.view_layer.update()
    assert np.abs(render(bpy, place, thing, tmp_path) - before).max() < SAME


def test_refused_before_anything_is_stored(fresh_blend, place):
    from expanded_panoramas.cycles_integration.picture_coordinates import has_stored_positions

    bpy = fresh_blend
    good, at_origin = tile(bpy), tile(bpy, "centre", location=place.origin.location)
    at_origin.data.vertices[0].co = (0, 0, 0)
    with pytest.raises(ValueError, match="'centre' has a vertex at the panorama's origin"):
        store(place, good, at_origin)
    with pytest.raises(ValueError, match="is a empty, must be a mesh"):
        store(place, good, place.origin)
    assert not has_stored_positions(good)


def uv_error_px(place, thing):
    """Largest distance [px] between the layer and the look-up at the corners and middles of all faces."""
    from expanded_panoramas.cycles_integration.picture_coordinates import UV_LAYER, panorama_from_local

    mesh, matrix = thing.data, panorama_from_local(place, thing)
    layer = mesh.uv_layers[UV_LAYER]
    worst = 0.0
    for face in mesh.polygons:
        uv = np.array([layer.uv[loop].vector for loop in face.loop_indices])
        local = np.array([mesh.vertices[vertex].co for vertex in face.vertices])
        right = (local @ matrix[:3, :3].T + matrix[:3, 3]).mean(axis=0)
        u, v = uv.mean(axis=0)
        shown = equirectangular.direction_from_uv(np.array([u % 1, 1 - v]))
        angle = np.arccos(np.clip(shown @ right / np.linalg.norm(right), -1, 1))
        worst = max(worst, angle * SIZE[0] / (2 * np.pi))
    return worst


def test_uv_layer_of_seam_and_poles(fresh_blend, place):
    from expanded_panoramas.cycles_integration import picture_coordinates

    bpy = fresh_blend
    floor, walls = bpy.data.objects["floor"], bpy.data.objects["walls"]
    before = {thing: [tuple(v.co) for v in thing.data.vertices] for thing in (floor, walls)}
    error = picture_coordinates.write_uv(place, [floor, walls], max_error_px=1.0)
    assert error <= 1.0
    for thing in (floor, walls):
        assert uv_error_px(place, thing) <= 1.05
        found = np.array([v.co for v in thing.data.vertices])
        assert found[: len(before[thing])] == pytest.approx(np.array(before[thing]), abs=1e-5)
    faces = len(floor.data.polygons)
    picture_coordinates.write_uv(place, [floor, walls], max_error_px=1.0)
    assert len(floor.data.polygons) == faces  # it is fine as it is


def test_uv_layer_is_of_the_picture_that_a_piece_keeps(fresh_blend, place):
    from expanded_panoramas.cycles_integration import picture_coordinates

    thing = tile(fresh_blend)
    store(place, thing)
    thing.location.x += 1
    fresh_blend.context.view_layer.update()
    picture_coordinates.write_uv(place, [thing], max_error_px=None)
    thing.location.x -= 1
    fresh_blend.context.view_layer.update()
    assert uv_error_px(place, thing) < 1
    with pytest.raises(ValueError, match="release the picture first"):
        picture_coordinates.write_uv(place, [thing], max_error_px=1e-3)
