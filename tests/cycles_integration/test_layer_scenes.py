"""Scenes of which layers are made: left as they were, with libraries and instances."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

import small_scenes as small  # noqa: E402
from boxed_scene import (  # noqa: E402
    BOX,
    DIRECTIONS,
    EMISSION,
    LEVEL,
    METRES,
    RADIUS,
    ROOM,
    SIDE,
    TINY,
    WALL,
    add_box,
    box_depth,
    room_depth,
    surfaces,
)

from expanded_panoramas.cycles_integration.layer_capture import capture_surfaces  # noqa: E402


def state(scene):
    """Names of all data-blocks but Blender's own picture of the last render; settings that are lent."""
    blocks = {str(block) for block in bpy.data.user_map() if getattr(block, "type", "") != "RENDER_RESULT"}
    flags = [(thing.name, thing.pass_index, thing.visible_camera) for thing in scene.objects]
    render, layer = scene.render, scene.view_layers[0]
    sizes = render.resolution_x, render.filepath, render.engine, scene.cycles.samples, scene.camera
    return blocks, flags, sizes, layer.material_override, layer.name


def test_the_scene_is_as_it_was_also_after_an_error(furnished_room):
    before = state(furnished_room)
    capture_surfaces(furnished_room, LEVEL, RADIUS, TINY)
    assert state(furnished_room) == before

    def stop(step):
        if step == "surface 2":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        capture_surfaces(furnished_room, LEVEL, RADIUS, TINY, stop)
    assert state(furnished_room) == before


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
