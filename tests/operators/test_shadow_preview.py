"""Operators of the shadow preview: materials wear it, it follows the scene, and it can be taken off again."""

import bpy
import numpy as np
import pytest
import shadow_pictures
from mathutils import Vector

from expanded_panoramas.cycles_integration import shadow_preview
from expanded_panoramas.operators import shadow_watch


@pytest.fixture
def scene(fresh_blend):
    """A floor that is selected, a box and a ball of its material, and a sun."""
    shadow_pictures.still_life()
    shadow_pictures.add_light("SUN")
    scene = fresh_blend.context.scene
    scene.panorama_shadow_preview.resolution = 64
    select(fresh_blend, "plane")
    return scene


def select(bpy, *names):
    bpy.ops.object.select_all(action="DESELECT")
    for name in names:
        bpy.data.objects[name].select_set(True)


def texels(scene):
    (image,) = shadow_preview.images_of(scene.panorama_shadow_preview.group)
    values = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(values)
    return values


def counts():
    return len(bpy.data.node_groups), len(bpy.data.images), len(bpy.data.materials)


def links(material):
    return {(one.from_node.name, one.to_socket.name) for one in material.node_tree.links}


def test_materials_wear_the_preview_and_give_it_back(scene):
    (material,) = bpy.data.materials
    before, blocks = links(material), counts()
    assert bpy.ops.panorama.preview_shadows() == {"FINISHED"}
    preview = scene.panorama_shadow_preview
    (node,) = shadow_preview.nodes_of(material, preview.group)
    (row,) = preview.lights
    assert row.light.name == "SUN"
    assert not row.light.data.use_shadow
    assert bpy.ops.panorama.preview_shadows() == {"FINISHED"}
    assert len(shadow_preview.nodes_of(material, preview.group)) == 1
    preview.darkness = 0.4
    assert node.inputs["Darkness"].default_value == pytest.approx(0.4)
    assert bpy.ops.panorama.remove_shadow_preview() == {"FINISHED"}
    assert (links(material), counts()) == (before, blocks)
    assert preview.lights[0].light.data.use_shadow
    assert preview.group is None


def test_what_is_rendered_is_darkened_where_numpy_says(scene):
    """A surface that shines evenly, so that the picture is 1 − Darkness · (1 − visibility)."""
    (material,) = bpy.data.materials
    output = next(n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL")
    glow = material.node_tree.nodes.new("ShaderNodeEmission")
    material.node_tree.links.new(glow.outputs[0], output.inputs["Surface"])
    scene.panorama_shadow_preview.darkness = 0.6
    bpy.ops.panorama.preview_shadows()
    shown, points, normals = shadow_pictures.rendered(48)
    (made,), _ = shadow_pictures.maps(scene)
    off = shadow_pictures.differences(made, 1 - (1 - shown) / 0.6, points, normals)
    assert np.sort(off)[-3] <= 1 / 255


@pytest.mark.parametrize("storage", ["float32", "8+8", "16+16"])
def test_the_compositor_darkens_the_picture_likewise(scene, storage):
    (material,) = bpy.data.materials
    output = next(n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL")
    glow = material.node_tree.nodes.new("ShaderNodeEmission")
    material.node_tree.links.new(glow.outputs[0], output.inputs["Surface"])
    preview = scene.panorama_shadow_preview
    preview.storage, preview.darkness = storage, 0.6
    scene.camera.data.ortho_scale = 7  # beyond the floor there is the world, which stays as it is
    scene.world = bpy.data.worlds.new("grey")
    _, points, normals = shadow_pictures.rendered(48)
    before = shadow_pictures.composited(48)
    assert bpy.ops.panorama.composite_shadows() == {"FINISHED"}
    bpy.ops.panorama.composite_shadows()
    bpy.data.objects["ball"].location.x -= 0.1
    bpy.context.view_layer.update()
    bpy.data.objects["ball"].location.x += 0.1
    bpy.context.view_layer.update()
    shown = shadow_pictures.composited(48)
    (made,), _ = shadow_pictures.maps(scene)
    there = np.linalg.norm(normals, axis=1) > 0.5
    assert 0.1 < there.mean() < 0.9
    off = shadow_pictures.differences(made, 1 - (1 - shown) / 0.6, points, normals)
    assert np.sort(off[there])[-3] <= 1 / 255
    assert np.array_equal(shown[~there], before[~there])
    bpy.ops.panorama.remove_shadow_preview()
    assert np.array_equal(shadow_pictures.composited(48), before)
    blocks = (*bpy.data.node_groups, *bpy.data.images)
    assert not [block for block in blocks if block.name.startswith("Shadow Map")]


def test_groups_of_others_are_left_alone(scene):
    """Even such as have lost their tree, while there is no preview in materials."""
    (material,) = bpy.data.materials
    lost = material.node_tree.nodes.new("ShaderNodeGroup")
    bpy.ops.panorama.composite_shadows()
    preview = scene.panorama_shadow_preview
    preview.darkness = 0.3
    (node,) = shadow_preview.composite_nodes(scene, preview.composite_group)
    assert node.inputs["Darkness"].default_value == pytest.approx(0.3)
    bpy.ops.panorama.remove_shadow_preview()
    assert lost.name in material.node_tree.nodes


def test_objects_without_a_material_get_one_and_undo_takes_it(scene):
    bpy.data.objects["plane"].data.materials.clear()
    bpy.ops.ed.undo_push()
    assert bpy.ops.panorama.preview_shadows() == {"FINISHED"}
    assert [m.name for m in bpy.data.objects["plane"].data.materials] == ["Shadow Receiver"]
    bpy.ops.ed.undo_push()
    bpy.ops.ed.undo()
    materials = bpy.data.objects["plane"].data.materials
    assert not materials
    assert bpy.context.scene.panorama_shadow_preview.group is None
    for _ in range(2):
        materials.append(None)
    bpy.ops.panorama.preview_shadows()
    assert [one.name for one in materials] == ["Shadow Receiver"] * 2


def test_the_map_follows_light_objects_and_settings(scene):
    bpy.ops.panorama.preview_shadows()
    seen = [texels(scene)]
    for change in (
        lambda: setattr(bpy.data.objects["SUN"], "rotation_euler", (0.3, 0.1, 0)),
        lambda: setattr(bpy.data.objects["ball"], "location", (0.2, 0.6, 0.9)),
        lambda: setattr(scene.panorama_shadow_preview, "window", 6),
    ):
        change()
        bpy.context.view_layer.update()
        shadow_watch.work_off()
        seen.append(texels(scene))
        assert not np.array_equal(seen[-1], seen[-2])
    assert scene.panorama_shadow_preview.window == 7
    scene.panorama_shadow_preview.keep_current = False
    bpy.data.objects["ball"].location.x -= 0.3
    bpy.context.view_layer.update()
    shadow_watch.work_off()
    assert np.array_equal(texels(scene), seen[-1])
    bpy.ops.panorama.renew_shadow_preview()
    assert not np.array_equal(texels(scene), seen[-1])


def test_a_map_is_not_made_because_one_was_made(scene):
    bpy.ops.panorama.preview_shadows()
    bpy.context.view_layer.update()
    shadow_watch.work_off()
    bpy.context.view_layer.update()
    assert not shadow_watch.is_waiting()


def test_each_frame_has_its_own_map(scene):
    bpy.ops.panorama.preview_shadows()
    ball = bpy.data.objects["ball"]
    for frame, x in ((1, 0.5), (5, -0.5)):
        ball.location.x = x
        ball.keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    first = texels(scene)
    scene.frame_set(5)
    assert not np.array_equal(texels(scene), first)
    scene.frame_set(1)
    assert np.array_equal(texels(scene), first)


def test_another_size_and_storage_keep_one_image(scene):
    bpy.ops.panorama.preview_shadows()
    preview = scene.panorama_shadow_preview
    blocks = counts()
    for storage, resolution in (("float32", 32), ("8+8", 48), ("16+16", 64)):
        preview.storage, preview.resolution = storage, resolution
        shadow_watch.work_off()
        (image,) = shadow_preview.images_of(preview.group)
        assert tuple(image.size) == (resolution, resolution)
        assert image.is_float == (storage == "float32")
        assert counts() == blocks
    assert image.name == "Shadow Map"


def test_the_saved_file_has_the_map(scene, tmp_path):
    bpy.ops.panorama.preview_shadows()
    before = texels(scene)
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert np.array_equal(texels(bpy.context.scene), before)


def test_what_is_refused_says_why_and_changes_nothing(scene):
    preview = scene.panorama_shadow_preview
    preview.method, preview.window = "pcf", 11
    blocks = counts()
    with pytest.raises(RuntimeError, match="window 11 of PCF must not exceed 9"):
        bpy.ops.panorama.preview_shadows()
    preview.window = 3
    for thing in scene.objects:
        thing.visible_shadow = False
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="nothing throws a shadow"):
        bpy.ops.panorama.preview_shadows()
    assert counts() == blocks
    assert not preview.lights
    select(bpy, "SUN")
    assert not bpy.ops.panorama.preview_shadows.poll()
    bpy.data.objects.remove(bpy.data.objects["SUN"])
    select(bpy, "plane")
    assert not bpy.ops.panorama.preview_shadows.poll()


def test_a_map_that_cannot_be_renewed_stays_and_says_so(scene):
    bpy.ops.panorama.preview_shadows()
    before = texels(scene)
    preview = scene.panorama_shadow_preview
    preview.method, preview.window = "pcf", 13
    shadow_watch.work_off()
    assert "must not exceed 9" in preview.problem
    assert np.array_equal(texels(scene), before)
    preview.method = "vsm"
    shadow_watch.work_off()
    assert preview.problem == ""


def test_linked_materials_are_left_alone(scene, tmp_path):
    path = str(tmp_path / "library.blend")
    bpy.data.materials[0].name = "theirs"
    bpy.data.libraries.write(path, {bpy.data.materials["theirs"]})
    with bpy.data.libraries.load(path, link=True) as (_, to):
        to.materials = ["theirs"]
    (theirs,) = to.materials
    for thing in ("plane", "ball"):
        bpy.data.objects[thing].data.materials[0] = theirs
    with pytest.raises(RuntimeError, match="'theirs': linked from another file"):
        bpy.ops.panorama.preview_shadows()
    select(bpy, "plane", "Cube")
    assert bpy.ops.panorama.preview_shadows() == {"FINISHED"}
    assert not shadow_preview.nodes_of(theirs, scene.panorama_shadow_preview.group)


def test_real_things_throw_no_shadow_and_instances_do(scene):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    whole = len(shadow_preview.casters_of(depsgraph)[1])
    bpy.data.objects["plane"].panorama_role = "SUPPORT"
    assert len(shadow_preview.casters_of(bpy.context.evaluated_depsgraph_get())[1]) == whole - 2
    box = bpy.data.objects["Cube"]
    collection = bpy.data.collections.new("boxes")
    collection.objects.link(box)
    several = bpy.data.objects.new("boxes", None)
    several.instance_type, several.instance_collection, several.location = "COLLECTION", collection, (0, 0, 3)
    scene.collection.objects.link(several)
    points, triangles = shadow_preview.casters_of(bpy.context.evaluated_depsgraph_get())
    assert len(triangles) == whole - 2 + 12
    assert points[:, 2].max() == pytest.approx(3.6)


def test_a_sun_shines_along_its_axis_and_a_lamp_from_its_place(scene):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    settings = shadow_preview.settings_of(scene.panorama_shadow_preview)
    (sun,) = shadow_preview.shadow_maps_of([bpy.data.objects["SUN"]], depsgraph, settings)
    np.testing.assert_allclose(-sun.camera.axes[2], Vector(shadow_pictures.SUN).normalized(), atol=1e-6)
    lamp = shadow_pictures.add_light("AREA")
    lamp.scale = (2, 3, 4)
    bpy.context.view_layer.update()
    (made,) = shadow_preview.shadow_maps_of([lamp], bpy.context.evaluated_depsgraph_get(), settings)
    np.testing.assert_allclose(made.camera.eye, shadow_pictures.LAMP, atol=1e-6)
    assert made.camera.perspective


def test_no_handler_is_left(fresh_blend):
    import expanded_panoramas

    lists = [getattr(bpy.app.handlers, name) for name, _ in shadow_watch.HANDLERS]
    there = [len(one) for one in lists]
    expanded_panoramas.unregister()
    assert [len(one) for one in lists] == [count - 1 for count in there]
    expanded_panoramas.register()


def at_rest():
    for _ in range(3):
        bpy.context.view_layer.update()
        shadow_watch.work_off()
    bpy.context.view_layer.update()
    assert not shadow_watch.is_waiting()


def test_one_scenes_preview_leaves_the_lights_of_another_alone(scene):
    bpy.ops.panorama.preview_shadows()
    first = scene.panorama_shadow_preview.lights[0].light.data
    other = scene.copy()
    for thing in list(other.collection.objects):
        other.collection.objects.unlink(thing)
    bpy.context.window.scene = other
    preview = other.panorama_shadow_preview
    preview.lights.clear()
    preview.switched_off.clear()
    preview.group = None
    shadow_pictures.still_life()
    second = shadow_pictures.add_light("SUN").data
    bpy.ops.panorama.composite_shadows()
    assert not first.use_shadow
    assert not second.use_shadow
    preview.darkness = 0.5
    bpy.ops.panorama.remove_shadow_preview()
    assert not first.use_shadow
    assert second.use_shadow


def test_what_copies_of_a_scene_share_gives_all_their_shadows_back(scene):
    bpy.ops.panorama.preview_shadows()
    bpy.ops.scene.new(type="FULL_COPY")
    preview = bpy.context.scene.panorama_shadow_preview
    assert preview.group == scene.panorama_shadow_preview.group
    assert not any(light.use_shadow for light in bpy.data.lights)
    bpy.ops.panorama.remove_shadow_preview()
    assert [light.use_shadow for light in bpy.data.lights] == [True, True]


def test_a_group_deleted_by_hand_gives_the_light_its_shadow_back(scene):
    bpy.ops.panorama.preview_shadows()
    bpy.data.node_groups.remove(scene.panorama_shadow_preview.group)
    bpy.context.view_layer.update()
    assert bpy.data.lights["SUN"].use_shadow


def test_what_was_removed_is_not_made_anew(scene):
    bpy.ops.panorama.preview_shadows()
    bpy.data.objects["ball"].location.x += 0.1
    bpy.context.view_layer.update()
    assert shadow_watch.is_waiting()
    bpy.ops.panorama.remove_shadow_preview()
    bpy.data.objects.remove(bpy.data.objects["SUN"])
    shadow_watch.work_off()
    assert not shadow_watch.is_waiting()
    assert scene.panorama_shadow_preview.problem == ""


def test_darkness_makes_no_new_map(scene):
    bpy.ops.panorama.preview_shadows()
    at_rest()
    scene.panorama_shadow_preview.darkness = 0.5
    bpy.context.view_layer.update()
    assert not shadow_watch.is_waiting()


def test_a_deleted_light_is_gone(scene):
    bpy.ops.panorama.preview_shadows()
    select(bpy, "SUN")
    bpy.ops.object.delete()
    bpy.context.view_layer.update()
    shadow_watch.work_off()
    assert "light is gone" in scene.panorama_shadow_preview.problem
    assert not bpy.ops.panorama.renew_shadow_preview.poll()


@pytest.mark.parametrize(("name", "value"), [("visible_shadow", False), ("panorama_role", "SUPPORT")])
def test_what_ceases_to_throw_a_shadow_is_noticed(scene, name, value):
    bpy.ops.panorama.preview_shadows()
    at_rest()
    before = texels(scene)
    setattr(bpy.data.objects["ball"], name, value)
    bpy.context.view_layer.update()
    shadow_watch.work_off()
    assert not np.array_equal(texels(scene), before)


def test_a_floor_that_renders_cease_to_show_is_noticed(scene):
    floor = bpy.data.objects["plane"]
    floor.panorama_role = "SUPPORT"
    bpy.ops.panorama.preview_shadows()
    at_rest()
    before = texels(scene)
    floor.hide_render = True
    bpy.context.view_layer.update()
    shadow_watch.work_off()
    assert not np.array_equal(texels(scene), before)


def test_the_timer_ends_while_what_is_marked_is_not_shown(scene):
    bpy.ops.panorama.preview_shadows()
    at_rest()
    bpy.context.window.scene = bpy.data.scenes.new("shown")
    scene.panorama_shadow_preview.window = 5
    assert shadow_watch.is_waiting()
    assert shadow_watch._at_rest() is None
    assert shadow_watch.is_waiting()


def test_collections_that_renders_leave_out_throw_no_shadow(scene):
    whole = len(shadow_preview.casters_of(bpy.context.evaluated_depsgraph_get())[1])
    box, collection = bpy.data.objects["Cube"], bpy.data.collections.new("views")
    scene.collection.children.link(collection)
    collection.objects.link(box)
    scene.collection.objects.unlink(box)
    collection.hide_render = True
    assert len(shadow_preview.casters_of(bpy.context.evaluated_depsgraph_get())[1]) == whole - 12


def test_parts_of_instances_that_renders_leave_out_throw_no_shadow(scene):
    """A sub-collection of an instanced collection, however deep; and the instance as a whole."""
    box, outer, inner = bpy.data.objects["Cube"], *(bpy.data.collections.new(name) for name in "ab")
    outer.children.link(inner)
    inner.objects.link(box)
    instances = []
    for name, collection in (("first", outer), ("second", bpy.data.collections.new("c"))):
        instances.append(bpy.data.objects.new(name, None))
        instances[-1].instance_type, instances[-1].instance_collection = "COLLECTION", collection
    instances[1].instance_collection.objects.link(instances[0])
    for one in instances:
        scene.collection.objects.link(one)

    def count():
        bpy.context.view_layer.update()
        return len(shadow_preview.casters_of(bpy.context.evaluated_depsgraph_get())[1]) // 12

    whole = count()
    instances[1].hide_render = True
    assert count() == whole - 1
    inner.hide_render = True
    assert count() == whole - 2
    instances[1].hide_render = False
    assert count() == whole - 2
    outer.objects.link(box)
    assert count() == whole


def test_settings_by_themselves_are_those_that_were_measured(scene):
    preview = scene.panorama_shadow_preview
    for method, storage, expected in (("vsm", "8+8", 0.3), ("evsm", "16+16", 0.05), ("evsm", "8+8", 0.15)):
        preview.method, preview.storage = method, storage
        settings = shadow_preview.settings_of(preview)
        assert settings.bleeding_reduction == expected
        assert settings.exponent == (20 if storage == "8+8" else 40)
    preview.offset_by_itself, preview.exponent = False, 7
    assert shadow_preview.settings_of(preview).exponent == 7
