"""Operators of the shadow preview: materials and the compositor wear it, and it can be taken off again."""

import bpy
import numpy as np
import pytest
import shadow_pictures
import shadow_previews

from expanded_panoramas.cycles_integration import shadow_preview


@pytest.fixture
def scene(fresh_blend):
    """A floor that is selected, a box and a ball of its material, and a sun."""
    return shadow_previews.add_scene()


def links(material):
    return {(one.from_node.name, one.to_socket.name) for one in material.node_tree.links}


def test_materials_wear_the_preview_and_give_it_back(scene):
    (material,) = bpy.data.materials
    before, blocks = links(material), shadow_previews.counts()
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
    assert (links(material), shadow_previews.counts()) == (before, blocks)
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


def test_the_saved_file_has_the_map(scene, tmp_path):
    bpy.ops.panorama.preview_shadows()
    before = shadow_previews.texels(scene)
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert np.array_equal(shadow_previews.texels(bpy.context.scene), before)


def test_what_is_refused_says_why_and_changes_nothing(scene):
    preview = scene.panorama_shadow_preview
    preview.method, preview.window = "pcf", 11
    blocks = shadow_previews.counts()
    with pytest.raises(RuntimeError, match="window 11 of PCF must not exceed 9"):
        bpy.ops.panorama.preview_shadows()
    preview.window = 3
    for thing in scene.objects:
        thing.visible_shadow = False
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="nothing throws a shadow"):
        bpy.ops.panorama.preview_shadows()
    assert shadow_previews.counts() == blocks
    assert not preview.lights
    shadow_previews.select("SUN")
    assert not bpy.ops.panorama.preview_shadows.poll()
    bpy.data.objects.remove(bpy.data.objects["SUN"])
    shadow_previews.select("plane")
    assert not bpy.ops.panorama.preview_shadows.poll()


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
    shadow_previews.select("plane", "Cube")
    assert bpy.ops.panorama.preview_shadows() == {"FINISHED"}
    assert not shadow_preview.nodes_of(theirs, scene.panorama_shadow_preview.group)


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


def test_settings_by_themselves_are_those_that_were_measured(scene):
    preview = scene.panorama_shadow_preview
    for method, storage, expected in (("vsm", "8+8", 0.3), ("evsm", "16+16", 0.05), ("evsm", "8+8", 0.15)):
        preview.method, preview.storage = method, storage
        settings = shadow_preview.settings_of(preview)
        assert settings.bleeding_reduction == expected
        assert settings.exponent == (20 if storage == "8+8" else 40)
    preview.offset_by_itself, preview.exponent = False, 7
    assert shadow_preview.settings_of(preview).exponent == 7
