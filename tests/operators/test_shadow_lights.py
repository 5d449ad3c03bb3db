"""Several lights in one preview: chosen, shown together, followed, and taken out again."""

import bpy
import numpy as np
import pytest
import shadow_pictures
from mathutils import Vector
from shadow_previews import select

from expanded_panoramas.cycles_integration import shadow_preview
from expanded_panoramas.cycles_integration.node_trees import add
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import remaining_light
from expanded_panoramas.operators import shadow_watch

EQUAL, TIES, WIDTH = 1 / 255, 4, 48


@pytest.fixture
def scene(fresh_blend):
    """A floor that shines evenly, a box and a ball on it; a sun and a lamp, which are selected with it."""
    shadow_pictures.still_life()
    (material,) = bpy.data.materials
    output = next(n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL")
    glow = add(material.node_tree, "ShaderNodeEmission")
    material.node_tree.links.new(glow.outputs[0], output.inputs["Surface"])
    light("SUN", 2.0, (1, 0.6, 0.2))
    light("POINT", 300.0, (0.3, 0.5, 1), (1.1, -1.3, 2.0))
    scene = fresh_blend.context.scene
    scene.panorama_shadow_preview.resolution = 64
    select("plane", "SUN", "POINT")
    return scene


def light(kind, energy, colour=(1, 1, 1), location=shadow_pictures.LAMP):
    made = shadow_pictures.add_light(kind)
    made.data.energy, made.data.color, made.location = energy, colour, location
    bpy.context.view_layer.update()
    return made


def names(scene):
    return [row.light.name for row in scene.panorama_shadow_preview.lights]


def casting(*names):
    return [bpy.data.objects[name].data.use_shadow for name in names]


def images(scene):
    return shadow_preview.images_of(scene.panorama_shadow_preview.group)


def follow():
    for _ in range(2):
        bpy.context.view_layer.update()
        shadow_watch.work_off()


def remaining(scene, points, normals):
    maps, strengths = shadow_pictures.maps(scene)
    return remaining_light(maps, strengths, points.astype(np.float64), normals.astype(np.float64))


def worst(off):
    return np.sort(off.ravel())[-1 - 3 * TIES]


def test_selected_lights_are_shown_together(scene):
    """The surface has the luminance of what numpy leaves of both."""
    scene.panorama_shadow_preview.darkness = 0.6
    assert bpy.ops.panorama.preview_shadows() == {"FINISHED"}
    assert names(scene) == ["POINT", "SUN"]  # the lamp is near
    assert casting("SUN", "POINT") == [False, False]
    assert len(images(scene)) == 2
    shown, points, normals = shadow_pictures.rendered(WIDTH)
    maps, strengths = shadow_pictures.maps(scene)
    grey = np.repeat(strengths @ [[0.2126], [0.7152], [0.0722]], 3, axis=1)
    left = remaining_light(maps, grey, points.astype(np.float64), normals.astype(np.float64))[:, 0]
    there = np.linalg.norm(normals, axis=1) > 0.5
    assert worst(np.abs(shown - 1 + 0.6 * (1 - left))[there]) <= EQUAL
    assert 0.03 < ((left > 0.2) & (left < 0.8)).mean() < 0.5


def test_the_compositor_shows_them_in_colour(scene):
    scene.camera.data.ortho_scale = 7  # beyond the floor there is the world, which stays as it is
    scene.world = bpy.data.worlds.new("grey")
    scene.panorama_shadow_preview.darkness = 0.6
    _, points, normals = shadow_pictures.rendered(WIDTH)
    before = shadow_pictures.composited(WIDTH, "RGB")
    assert bpy.ops.panorama.composite_shadows() == {"FINISHED"}
    shown = shadow_pictures.composited(WIDTH, "RGB")
    there = np.linalg.norm(normals, axis=1) > 0.5
    assert 0.1 < there.mean() < 0.9
    left = 1 - 0.6 * (1 - remaining(scene, points, normals))
    assert worst(np.abs(shown - before * left)[there]) <= EQUAL
    assert np.array_equal(shown[~there], before[~there])


def test_lights_come_and_go_and_leave_nothing(scene):
    bpy.ops.panorama.preview_shadows()
    bpy.ops.panorama.composite_shadows()
    preview = scene.panorama_shadow_preview
    preview.lights[0].light = light("SPOT", 50.0)
    follow()
    assert casting("SUN", "POINT", "SPOT") == [False, True, False]
    assert bpy.ops.panorama.remove_shadow_light(index=1) == {"FINISHED"}
    follow()
    assert names(scene) == ["SPOT"]
    assert casting("SUN", "POINT", "SPOT") == [True, True, False]
    assert len(images(scene)) == len(shadow_preview.images_of(preview.composite_group)) == 1
    preview.replaces_own = False
    assert casting("SPOT") == [True]
    bpy.ops.panorama.remove_shadow_light(index=0)
    follow()
    assert "choose another" in preview.problem
    assert len(images(scene)) == 1  # the last map stays
    bpy.ops.panorama.remove_shadow_preview()
    blocks = (*bpy.data.node_groups, *bpy.data.images)
    assert not [block for block in blocks if block.name.startswith("Shadow Map")]
    with pytest.raises(RuntimeError, match="there is no light 3: the list has 0"):
        bpy.ops.panorama.remove_shadow_light(index=3)


def test_all_visible_lights_strongest_first_and_no_more_than_four(scene):
    for name, energy in (("AREA", 0.0), ("SPOT", 5.0), ("POINT", 1000.0)):
        light(name, energy)
    bpy.data.objects["SPOT"].hide_set(True)
    assert bpy.ops.panorama.add_shadow_lights(which="VISIBLE") == {"FINISHED"}
    assert names(scene) == ["POINT.001", "POINT", "SUN", "AREA"]
    assert not bpy.ops.panorama.add_shadow_lights.poll()
    bpy.ops.panorama.remove_shadow_light(index=3)
    bpy.data.objects["SPOT"].hide_set(False)
    select("plane")
    with pytest.raises(RuntimeError, match="select the lights to add"):
        bpy.ops.panorama.add_shadow_lights(which="SELECTED")
    bpy.ops.panorama.add_shadow_lights(which="VISIBLE")
    assert names(scene)[3] == "SPOT"
    bpy.ops.panorama.preview_shadows()
    assert len(images(scene)) == 4
    scene.panorama_shadow_preview.lights.add().light = bpy.data.objects["AREA"]
    follow()
    assert len(images(scene)) == 4


def test_the_field_adds_a_light_once(scene):
    preview = scene.panorama_shadow_preview
    for name in ("SUN", "SUN", "POINT"):
        preview.another = bpy.data.objects[name]
        assert preview.another is None
    assert names(scene) == ["SUN", "POINT"]
    bpy.ops.panorama.preview_shadows()
    preview.lights[1].light = bpy.data.objects["SUN"]  # by hand it can be there twice
    follow()
    assert len(images(scene)) == 1


def test_a_deleted_light_leaves_the_others(scene):
    bpy.ops.panorama.preview_shadows()
    data = bpy.data.objects["SUN"].data
    select("SUN")
    bpy.ops.object.delete()
    follow()
    preview = scene.panorama_shadow_preview
    assert preview.problem == "'SUN' is gone from the scene"
    assert data.use_shadow
    assert len(images(scene)) == 1
    assert shadow_preview.lights_of(preview) == [bpy.data.objects["POINT"]]
    shown, points, normals = shadow_pictures.rendered(WIDTH)
    (made,), _ = shadow_pictures.maps(scene)
    assert worst(shadow_pictures.differences(made, shown, points, normals)) <= EQUAL


def test_lights_that_share_their_data_share_its_shadow(scene):
    other = bpy.data.objects["SUN"].copy()
    other.rotation_euler = Vector((0.5, -0.3, 0.8)).to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(other)
    bpy.context.view_layer.update()
    select("plane", "SUN", "SUN.001")
    bpy.ops.panorama.preview_shadows()
    assert len(images(scene)) == 2
    assert casting("SUN") == [False]
    bpy.ops.panorama.remove_shadow_light(index=0)
    assert casting("SUN") == [False]
    bpy.ops.panorama.remove_shadow_light(index=0)
    assert casting("SUN") == [True]


def test_a_light_without_shadow_is_not_touched(scene):
    """Neither switched on later, nor set again and again, which would have maps made for ever."""
    bpy.data.objects["SUN"].data.use_shadow = False
    bpy.ops.panorama.preview_shadows()
    follow()
    bpy.context.view_layer.update()
    assert not shadow_watch.is_waiting()
    bpy.ops.panorama.remove_shadow_preview()
    assert casting("SUN", "POINT") == [False, True]


def test_undo_and_the_file_have_every_light(scene, tmp_path):
    select("plane", "SUN")
    bpy.ops.ed.undo_push()
    bpy.ops.panorama.preview_shadows()
    bpy.ops.ed.undo_push()
    scene.panorama_shadow_preview.another = bpy.data.objects["POINT"]
    follow()
    assert casting("POINT") == [False]
    bpy.ops.ed.undo_push()
    bpy.ops.ed.undo()
    scene = bpy.context.scene
    follow()
    assert names(scene) == ["SUN"]
    assert casting("SUN", "POINT") == [False, True]
    bpy.ops.ed.redo()
    scene = bpy.context.scene
    follow()
    assert names(scene) == ["SUN", "POINT"]
    path = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    assert names(scene) == ["SUN", "POINT"]
    assert [image.size[0] for image in images(scene)] == [64, 64]
    shadow_watch.work_off()
    assert scene.panorama_shadow_preview.problem == ""


def test_what_cannot_be_made_changes_nothing_and_names_the_light(scene):
    select("plane", "SUN", "POINT")
    bpy.data.objects["POINT"].scale = bpy.data.objects["POINT"].location = (float("nan"),) * 3
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="'POINT': lamp"):
        bpy.ops.panorama.preview_shadows()
    assert names(scene) == []
    assert casting("SUN", "POINT") == [True, True]


def test_a_file_of_another_version_is_built_anew(scene):
    """Such as has a group, but no list of lights and a group of other sockets."""
    select("plane", "SUN")
    bpy.ops.panorama.preview_shadows()
    preview = scene.panorama_shadow_preview
    preview.lights.clear()
    preview.switched_off.clear()
    preview.group["panorama_shadow_map"] = "ShadowSettings()"
    preview.group.interface.remove(preview.group.interface.items_tree["Visibility"])
    shadow_watch.mark(scene)
    follow()
    assert "choose another" in preview.problem
    preview.darkness = 0.5
    assert not bpy.ops.panorama.renew_shadow_preview.poll()
    assert bpy.ops.panorama.preview_shadows() == {"FINISHED"}
    assert names(scene) == ["SUN"]
    (node,) = shadow_preview.nodes_of(bpy.data.materials[0], preview.group)
    assert node.inputs["Surface"].is_linked
    assert "Visibility" in node.outputs


def test_a_linked_light_of_the_same_name_is_another(scene, tmp_path):
    """Names tell apart only what is from one file."""
    sun = bpy.data.objects["SUN"]
    bpy.data.libraries.write(str(tmp_path / "rig.blend"), {sun})
    with bpy.data.libraries.load(str(tmp_path / "rig.blend"), link=True) as (_, to):
        to.objects = ["SUN"]
    (linked,) = to.objects
    scene.collection.objects.link(linked)
    preview = scene.panorama_shadow_preview
    for one in (sun, linked):
        preview.lights.add().light = one
    assert shadow_preview.lights_of(preview) == [sun, linked]
    scene.collection.objects.unlink(sun)
    assert shadow_preview.lights_of(preview) == [linked]
    preview.lights.remove(0)
    bpy.ops.panorama.preview_shadows()
    assert preview.problem == "'SUN': its own shadow is seen too, for the light is linked from another file"
    preview.replaces_own = False
    bpy.ops.panorama.renew_shadow_preview()
    assert preview.problem == ""
