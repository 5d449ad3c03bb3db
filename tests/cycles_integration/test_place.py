"""A place follows its calibration; its pieces keep their identity."""

import numpy as np
import panoramas
import pytest
from mathutils import Vector

from expanded_panoramas.ibl_toolkit import equirectangular


@pytest.fixture
def place(fresh_blend, tmp_path):
    return panoramas.room_place(fresh_blend, panoramas.smooth_panorama(tmp_path / "smooth.exr"))


def test_pieces_have_roles_and_stand_where_they_were_picked(fresh_blend, place):
    _, here = place
    things = {thing.name: thing for thing in here.surfaces.all_objects}
    assert {name: thing.panorama_role for name, thing in things.items()} == {
        "floor": "SUPPORT", "walls": "ENVIRONMENT", "table": "SUPPORT",
        "cabinet": "ENVIRONMENT", "column": "ENVIRONMENT",
    }  # fmt: skip
    assert np.allclose(things["table"].dimensions, (0.9, 0.7, 0.55), atol=1e-5)


def test_rebuilding_keeps_objects_and_removes_what_is_gone(fresh_blend, place):
    from expanded_panoramas.cycles_integration.pieces import update_pieces
    from expanded_panoramas.ibl_toolkit.calibration import calibrate
    from expanded_panoramas.ibl_toolkit.reconstruction import reconstruct
    from expanded_panoramas.sample_scenes.closed_room_set import closed_room_set

    _, here = place
    table = fresh_blend.data.objects["table"]
    table.modifiers.new("Bevel", "BEVEL")
    panorama_set = closed_room_set(here.image.filepath)
    calibration = calibrate(panorama_set.calibration, (4096, 2048))
    pieces = [piece for piece in reconstruct(panorama_set, calibration) if piece.name != "column"]
    update_pieces(here, pieces)
    assert fresh_blend.data.objects["table"] == table
    assert [modifier.name for modifier in table.modifiers] == ["Bevel"]
    assert "column" not in fresh_blend.data.objects


def test_the_origin_turns_directions_as_the_calibration_does(fresh_blend, tmp_path):
    tilt = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    image = panoramas.smooth_panorama(tmp_path / "smooth.exr")
    _, here = panoramas.room_place(fresh_blend, image, panorama_from_world=tilt)
    seen = equirectangular.uv_from_direction(tilt @ (np.array([1.0, 0.5, 0.0]) - (0, 0, 1.5)))
    in_panorama = here.origin.matrix_world.inverted() @ Vector((1.0, 0.5, 0.0))
    assert np.allclose(equirectangular.uv_from_direction(np.array(in_panorama)), seen, atol=1e-5)


def test_new_objects_and_real_meshes_are_sorted_apart(fresh_blend, place):
    from expanded_panoramas.cycles_integration.place import sort_objects

    scene, here = place
    new = fresh_blend.data.objects.new("new", fresh_blend.data.meshes.new("new"))
    scanned = fresh_blend.data.objects.new("scanned", fresh_blend.data.meshes.new("scanned"))
    scanned.panorama_role = "SUPPORT"
    for thing in (new, scanned):
        scene.collection.objects.link(thing)
    sort_objects(scene, here)
    assert scanned.users_collection == (here.support,)
    assert here.collection not in new.users_collection
    assert scene.collection not in new.users_collection


def test_a_new_object_stays_in_its_own_collection_and_leaves_the_root(fresh_blend, place):
    """In the root it would be in every view layer, the empty place's too."""
    from expanded_panoramas.cycles_integration.place import sort_objects

    scene, here = place
    own = fresh_blend.data.collections.new("own")
    scene.collection.children.link(own)
    new = fresh_blend.data.objects.new("new", fresh_blend.data.meshes.new("new"))
    for collection in (own, scene.collection, here.support):
        collection.objects.link(new)
    sort_objects(scene, here)
    assert new.users_collection == (own,)


def test_sorting_leaves_other_scenes_alone(fresh_blend, place):
    from expanded_panoramas.cycles_integration.place import sort_objects

    scene, here = place
    other = fresh_blend.data.scenes.new("other")
    things = [fresh_blend.data.objects.new(n, fresh_blend.data.meshes.new(n)) for n in ("new", "scanned")]
    things[1].panorama_role = "SUPPORT"
    for thing in things:
        scene.collection.objects.link(thing)
        other.collection.objects.link(thing)
    sort_objects(scene, here)
    assert set(other.collection.objects) == set(things)
    assert not set(scene.collection.objects) & set(things)
    assert here.support in things[1].users_collection


def test_a_scene_without_a_panorama_is_refused(fresh_blend):
    from expanded_panoramas.cycles_integration.place import place_of

    with pytest.raises(ValueError, match="has no panorama"):
        place_of(fresh_blend.context.scene)


def test_two_scenes_have_a_place_each(fresh_blend, place, tmp_path):
    """What the second one makes leaves the first one's materials, maps and World alone."""
    from expanded_panoramas.cycles_integration import lookup, materials, world

    scene, here = place
    made = []
    for current in (scene, fresh_blend.data.scenes.new("other")):
        if current != scene:
            fresh_blend.context.window.scene = current
            _, here = panoramas.room_place(fresh_blend, panoramas.constant_panorama(tmp_path / "c.exr", 1))
        tree = lookup.build_lookup(here)
        materials.assign(current, here)
        images = {node.image for node in tree.nodes if node.bl_idname == "ShaderNodeTexEnvironment"}
        made.append({tree, world.build_world(current, here), here.origin, *images})
        made[-1] |= {slot.material for o in here.surfaces.all_objects for slot in o.material_slots}
    assert len(made[0]) == len(made[1]) == 6
    assert not made[0] & made[1]
