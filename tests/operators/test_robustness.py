"""Files as artists have them: several scenes, linked and overridden objects, folders closed to writing, the
extension switched off and on in the midst of it."""

import os
import pathlib

import numpy as np
import pytest
from room_job import built, calibrated, select, write_room

import expanded_panoramas


@pytest.fixture
def quick(monkeypatch):
    from expanded_panoramas.cycles_integration import preparation

    monkeypatch.setattr(preparation, "IRRADIANCE_WIDTH", 32)
    monkeypatch.setattr(preparation, "IRRADIANCE_SAMPLES", 1)


def add_plane(bpy, name, height=0.5, role="SYNTHETIC"):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(-1, -1, height), (1, -1, height), (1, 1, height), (-1, 1, height)], [], [(0, 1, 2, 3)])
    mesh.materials.append(bpy.data.materials.new(f"{name} paint"))
    thing = bpy.data.objects.new(name, mesh)
    thing.panorama_role = role
    bpy.context.scene.collection.objects.link(thing)
    return thing


@pytest.fixture
def library(fresh_blend, tmp_path):
    """A file with a synthetic object, a support and a collection of both."""
    bpy = fresh_blend
    collection = bpy.data.collections.new("set")
    for name, role in (("vase", "SYNTHETIC"), ("shelf", "SUPPORT")):
        thing = add_plane(bpy, name, role=role)
        bpy.context.scene.collection.objects.unlink(thing)
        collection.objects.link(thing)
    bpy.context.scene.collection.children.link(collection)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return tmp_path / "library.blend"


def link(bpy, path, *names):
    """Link objects straight into the scene."""
    with bpy.data.libraries.load(str(path), link=True) as (_, ours):
        ours.objects = list(names)
    for thing in ours.objects:
        bpy.context.scene.collection.objects.link(thing)
    bpy.context.view_layer.update()
    return ours.objects


def state_of(thing):
    """What must not change of linked data."""
    return (
        tuple(map(tuple, thing.matrix_world)),
        thing.panorama_role,
        [material.name for material in thing.data.materials],
        len(thing.data.vertices),
    )


# --- several scenes -----------------------------------------------------------------------------------------


def test_two_panoramas_in_one_file_do_not_touch_each_other(fresh_blend, tmp_path, quick):
    bpy = fresh_blend
    first = bpy.context.scene
    built(bpy, tmp_path)
    bpy.ops.panorama.prepare()
    kept = {name: getattr(first.panorama_place, name) for name in ("irradiance", "image", "origin")}
    group = bpy.data.node_groups[f"Panorama Lookup ({first.name})"]
    second = bpy.data.scenes.new("second")
    bpy.context.window.scene = second
    (tmp_path / "other").mkdir()
    bpy.ops.panorama.import_set(filepath=str(write_room(tmp_path / "other", "den")))
    second.panorama_set.camera_height = 2
    bpy.ops.panorama.calibrate()
    bpy.ops.panorama.build()
    bpy.ops.panorama.prepare()
    assert second.panorama_place.origin.location.z == pytest.approx(2)
    assert {name: getattr(first.panorama_place, name) for name in kept} == kept
    assert kept["origin"].location.z == pytest.approx(1.5)
    images = {node.image for node in group.nodes if node.type == "TEX_ENVIRONMENT"}
    assert second.panorama_place.image not in images
    assert not {thing.name for thing in first.objects} & {thing.name for thing in second.objects}


def test_a_scene_may_be_renamed_between_light_and_picture(fresh_blend, tmp_path, quick):
    bpy = fresh_blend
    built(bpy, tmp_path)
    bpy.ops.panorama.add_camera()
    bpy.ops.panorama.prepare()
    bpy.context.scene.name = "Shot 010"
    assert bpy.ops.panorama.set_up_picture() == {"FINISHED"}


@pytest.mark.parametrize("kind", ["LINK_COPY", "FULL_COPY"])
def test_a_copy_of_a_scene_leaves_the_first_one_its_light(fresh_blend, tmp_path, quick, kind):
    """Whatever the copy shares, the first scene can still be rendered, and its maps are there."""
    bpy = fresh_blend
    first = bpy.context.scene
    built(bpy, tmp_path)
    bpy.ops.panorama.add_camera()
    bpy.ops.panorama.prepare()
    bpy.ops.scene.new(type=kind)
    copy = bpy.context.scene
    assert copy != first
    bpy.ops.panorama.prepare()
    bpy.context.window.scene = first
    assert first.panorama_place.irradiance is not None
    assert first.panorama_place.irradiance.size[0] > 0
    assert bpy.ops.panorama.set_up_picture() == {"FINISHED"}


@pytest.mark.parametrize("part", ["suns", "catchers", "lights", "support", "surfaces"])
def test_collections_that_were_deleted_come_back(fresh_blend, tmp_path, quick, part):
    bpy = fresh_blend
    built(bpy, tmp_path)
    place = bpy.context.scene.panorama_place
    bpy.data.collections.remove(getattr(place, part))
    bpy.ops.panorama.build()
    bpy.ops.panorama.prepare()
    bpy.ops.panorama.add_camera()
    assert bpy.ops.panorama.set_up_picture() == {"FINISHED"}
    assert len({thing["panorama_piece"] for thing in place.surfaces.all_objects}) == 5


def test_an_origin_that_was_deleted_comes_back(fresh_blend, tmp_path):
    bpy = fresh_blend
    built(bpy, tmp_path)
    place = bpy.context.scene.panorama_place
    select(bpy, "Panorama Origin")
    bpy.ops.object.delete()
    bpy.ops.panorama.calibrate()
    assert place.origin.name in bpy.context.scene.objects
    assert place.origin.location.z == pytest.approx(1.5)
    bpy.data.objects.remove(place.origin)
    with pytest.raises(RuntimeError, match="Calibrate first"):
        bpy.ops.panorama.add_camera()
    bpy.ops.panorama.calibrate()
    assert len([thing for thing in bpy.data.objects if thing.name.startswith("Panorama Origin")]) == 1
    assert len(place.surfaces.all_objects) == 5


# --- linked and overridden objects --------------------------------------------------------------------------


def test_linked_new_objects_do_no_harm(fresh_blend, library, tmp_path, quick):
    bpy = fresh_blend
    built(bpy, tmp_path)
    (vase,) = link(bpy, library, "vase")
    before = state_of(vase)
    bpy.ops.panorama.prepare()
    bpy.ops.panorama.add_camera()
    bpy.ops.panorama.set_up_picture()
    assert state_of(vase) == before


def test_linked_real_surfaces_are_refused_by_name(fresh_blend, library, tmp_path, quick):
    bpy = fresh_blend
    built(bpy, tmp_path)
    (shelf,) = link(bpy, library, "shelf")
    before = state_of(shelf)
    with pytest.raises(RuntimeError, match="'shelf'.*linked"):
        bpy.ops.panorama.prepare()
    assert state_of(shelf) == before
    assert bpy.context.scene.panorama_place.irradiance is None


def test_roles_of_linked_objects_stay(fresh_blend, library, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    (vase,) = link(bpy, library, "vase")
    own = add_plane(bpy, "own")
    before = state_of(vase)
    select(bpy, "vase")
    with pytest.raises(RuntimeError, match="'vase'.*linked"):
        bpy.ops.panorama.set_role(role="SUPPORT")
    select(bpy, "vase", "own")
    bpy.ops.panorama.set_role(role="SUPPORT")  # with a warning
    assert own.panorama_role == "SUPPORT"
    assert state_of(vase) == before
    with pytest.raises(RuntimeError, match="'vase'"):
        bpy.ops.panorama.store_coordinates()


def test_linked_objects_are_not_sent(fresh_blend, library, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    (vase,) = link(bpy, library, "vase")
    own = add_plane(bpy, "own")
    before = state_of(vase)
    select(bpy, "vase")
    with pytest.raises(RuntimeError, match="'vase': linked"):
        bpy.ops.panorama.send_to_place(location=(2, 0, 0))
    select(bpy, "vase", "own")
    bpy.ops.panorama.send_to_place(location=(2, 0, 0))
    assert own.location.x == pytest.approx(2)
    assert state_of(vase) == before


def test_overridden_objects_are_sent_and_keep_role_and_place_when_saved(fresh_blend, library, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    with bpy.data.libraries.load(str(library), link=True) as (_, ours):
        ours.collections = ["set"]
    bpy.context.scene.collection.children.link(ours.collections[0])
    bpy.context.view_layer.update()
    made = ours.collections[0].override_hierarchy_create(
        bpy.context.scene, bpy.context.view_layer, do_fully_editable=True
    )
    shelf = next(thing for thing in made.all_objects if thing.name == "shelf")
    assert shelf.override_library is not None
    select(bpy, "shelf")
    bpy.context.view_layer.objects.active = shelf
    bpy.ops.panorama.send_to_place(location=(2, 0, 0))
    assert shelf.panorama_role == "SYNTHETIC"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    shelf = next(o for o in bpy.context.scene.objects if o.name == "shelf" and o.override_library)
    assert shelf.matrix_world.translation.x == pytest.approx(2)
    assert shelf.panorama_role == "SYNTHETIC"


def test_a_support_in_a_collection_of_another_file_is_refused(fresh_blend, library, tmp_path, quick):
    bpy = fresh_blend
    built(bpy, tmp_path)
    with bpy.data.libraries.load(str(library), link=True) as (_, ours):
        ours.collections = ["set"]
    made = ours.collections[0].override_hierarchy_create(
        bpy.context.scene, bpy.context.view_layer, do_fully_editable=True
    )
    shelf = next(thing for thing in made.all_objects if thing.name == "shelf")
    shelf.data = shelf.data.copy()  # a mesh of its own
    with pytest.raises(RuntimeError, match="'shelf' lies in the collection 'set' of another file"):
        bpy.ops.panorama.prepare()
    assert made in shelf.users_collection


def test_an_overridden_support_on_a_linked_mesh_is_refused(fresh_blend, library, tmp_path, quick):
    bpy = fresh_blend
    built(bpy, tmp_path)
    (linked,) = link(bpy, library, "shelf")
    linked.override_create(remap_local_usages=True)
    shelf = bpy.context.scene.objects["shelf"]
    before = state_of(shelf)
    with pytest.raises(RuntimeError, match="'shelf'.*linked"):
        bpy.ops.panorama.prepare()
    assert state_of(shelf) == before


def test_a_scene_with_the_settings_of_another_gets_a_place_of_its_own(fresh_blend, tmp_path):
    """New Scene > Copy Settings takes picks and shapes along, but none of the objects."""
    bpy = fresh_blend
    first = bpy.context.scene
    built(bpy, tmp_path)
    bpy.ops.scene.new(type="EMPTY")
    copy = bpy.context.scene
    with pytest.raises(RuntimeError, match="Calibrate first"):
        bpy.ops.panorama.prepare()
    copy.panorama_set.camera_height = 2.5
    bpy.ops.panorama.build()
    assert first.panorama_place.origin.location.z == pytest.approx(1.5)
    assert copy.panorama_place.origin.location.z == pytest.approx(2.5)
    assert len(copy.panorama_place.surfaces.all_objects) == 5
    assert not set(first.objects) & set(copy.objects)
    bpy.ops.scene.new(type="NEW")
    assert bpy.context.scene.panorama_set.image_path == ""


def test_a_new_scene_with_an_old_name_has_its_own_lookup(fresh_blend, tmp_path):
    """Blender names a new scene "Scene", as the first one was before it was renamed."""
    bpy = fresh_blend
    first = bpy.context.scene
    built(bpy, tmp_path)
    group = lookup_of(bpy)
    old_name, first.name = first.name, "Shot 010"
    bpy.context.window.scene = bpy.data.scenes.new(old_name)
    (tmp_path / "other").mkdir()
    bpy.ops.panorama.import_set(filepath=str(write_room(tmp_path / "other", "den")))
    bpy.ops.panorama.calibrate()
    other = lookup_of(bpy)
    assert other != group
    bpy.context.window.scene = first
    assert lookup_of(bpy) == group


def lookup_of(bpy):
    from expanded_panoramas.cycles_integration.lookup import build_lookup

    return build_lookup(bpy.context.scene.panorama_place)


def test_a_linked_scene_is_left_alone(fresh_blend, tmp_path):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    name = bpy.context.scene.name
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(tmp_path / "scene.blend"), link=True) as (_, ours):
        ours.scenes = [name]
    bpy.context.window.scene = ours.scenes[0]
    with pytest.raises(RuntimeError, match="is linked from .*scene.blend"):
        bpy.ops.panorama.build()
    with pytest.raises(RuntimeError, match="is linked from .*scene.blend"):
        bpy.ops.panorama.load_sample()
    assert len(ours.scenes[0].panorama_set.shapes) == 5


# --- folders that cannot be written to ----------------------------------------------------------------------


@pytest.fixture(params=["no folder", "read only"])
def closed_folder(request, tmp_path):
    """A path where nothing can be written."""
    if request.param == "no folder":
        (tmp_path / "file").touch()
        return tmp_path / "file"
    if os.geteuid() == 0:
        pytest.skip("root may write everywhere")
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o555)
    return folder


def test_writing_to_a_closed_folder(fresh_blend, tmp_path, closed_folder):
    bpy = fresh_blend
    state = built(bpy, tmp_path)
    before = state.image_path, state.image, [o.name for o in bpy.context.scene.objects]
    target = str(closed_folder / "out.exr")
    calls = (
        lambda: bpy.ops.panorama.restore_light(filepath=target, known="IRRADIANCE", value=1e4),
        lambda: bpy.ops.panorama.export_set(filepath=str(closed_folder / "out.json")),
        lambda: bpy.ops.panorama.export_depth(filepath=target, width=16),
    )
    clip(bpy)
    for call in calls:
        with pytest.raises(RuntimeError, match=closed_folder.name):
            call()
    assert (state.image_path, state.image, [o.name for o in bpy.context.scene.objects]) == before


def clip(bpy):
    """Paint a clipped lamp into the loaded picture."""
    image = bpy.context.scene.panorama_place.image
    pixels = np.array(image.pixels).reshape(image.size[1], image.size[0], 4)
    pixels[90:96, 60:72, :3] = 16
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())


# --- saved early, switched off and on -----------------------------------------------------------------------


def test_a_file_saved_before_any_panorama(fresh_blend, tmp_path):
    bpy = fresh_blend
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "early.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "early.blend"))
    state = built(bpy, tmp_path)
    assert state.result.is_solved
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "early.blend"))
    state = bpy.context.scene.panorama_set
    assert (len(state.shapes), state.result.is_solved, state.shapes[0].is_built) == (5, True, True)
    bpy.ops.panorama.build()


def test_a_file_saved_without_the_extension_keeps_the_work(fresh_blend, tmp_path):
    """Opened and saved by someone who has not installed it, and opened again by someone who has."""
    bpy = fresh_blend
    built(bpy, tmp_path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    expanded_panoramas.unregister()
    try:
        bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
        bpy.ops.wm.save_mainfile()
    finally:
        expanded_panoramas.register()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    state = bpy.context.scene.panorama_set
    assert (len(state.shapes), state.result.is_solved) == (5, True)
    assert bpy.data.objects["floor"].panorama_role == "SUPPORT"
    bpy.ops.panorama.build()


def test_switched_off_and_on_in_the_midst_of_the_work(fresh_blend, tmp_path):
    bpy = fresh_blend
    before = counted(bpy)
    built(bpy, tmp_path)
    for _ in range(3):
        expanded_panoramas.unregister()
        assert not hasattr(bpy.context.scene, "panorama_set")
        assert not dir(bpy.ops.panorama)
        expanded_panoramas.register()
    assert counted(bpy) == before
    state = bpy.context.scene.panorama_set
    assert (len(state.shapes), state.result.is_solved) == (5, True)
    assert bpy.data.objects["table"].panorama_role == "SUPPORT"
    bpy.ops.panorama.build()


def counted(bpy):
    """Handlers of the application, menu entries and preset folders."""
    handlers = {
        name: len(found)
        for name in dir(bpy.app.handlers)
        if isinstance(found := getattr(bpy.app.handlers, name), list)
    }
    entries = {name: len(getattr(getattr(bpy.types, name).draw, "_draw_funcs", ())) for name in MENUS}
    folders = bpy.utils.preset_paths("expanded_panoramas/render")
    return handlers, entries, [pathlib.Path(folder).name for folder in folders]


MENUS = ("VIEW3D_MT_add", "VIEW3D_MT_object_context_menu", "VIEW3D_HT_header")
