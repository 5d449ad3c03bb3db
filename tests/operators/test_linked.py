"""Linked and overridden objects, collections and scenes: left as they are, or refused by name."""

import pytest
from room_job import built, calibrated, select


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
