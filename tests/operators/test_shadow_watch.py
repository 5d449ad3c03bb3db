"""The shadow preview follows its scene: when maps are made anew, when not, and when they cannot be."""

import bpy
import numpy as np
import pytest
import shadow_previews

from expanded_panoramas.cycles_integration import shadow_preview
from expanded_panoramas.operators import shadow_watch


@pytest.fixture
def scene(fresh_blend):
    """A floor that is selected, a box and a ball of its material, and a sun."""
    return shadow_previews.add_scene()


def test_the_map_follows_light_objects_and_settings(scene):
    bpy.ops.panorama.preview_shadows()
    seen = [shadow_previews.texels(scene)]
    for change in (
        lambda: setattr(bpy.data.objects["SUN"], "rotation_euler", (0.3, 0.1, 0)),
        lambda: setattr(bpy.data.objects["ball"], "location", (0.2, 0.6, 0.9)),
        lambda: setattr(scene.panorama_shadow_preview, "window", 6),
    ):
        change()
        bpy.context.view_layer.update()
        shadow_watch.work_off()
        seen.append(shadow_previews.texels(scene))
        assert not np.array_equal(seen[-1], seen[-2])
    assert scene.panorama_shadow_preview.window == 7
    scene.panorama_shadow_preview.keep_current = False
    bpy.data.objects["ball"].location.x -= 0.3
    bpy.context.view_layer.update()
    shadow_watch.work_off()
    assert np.array_equal(shadow_previews.texels(scene), seen[-1])
    bpy.ops.panorama.renew_shadow_preview()
    assert not np.array_equal(shadow_previews.texels(scene), seen[-1])


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
    first = shadow_previews.texels(scene)
    scene.frame_set(5)
    assert not np.array_equal(shadow_previews.texels(scene), first)
    scene.frame_set(1)
    assert np.array_equal(shadow_previews.texels(scene), first)


def test_another_size_and_storage_keep_one_image(scene):
    bpy.ops.panorama.preview_shadows()
    preview = scene.panorama_shadow_preview
    blocks = shadow_previews.counts()
    for storage, resolution in (("float32", 32), ("8+8", 48), ("16+16", 64)):
        preview.storage, preview.resolution = storage, resolution
        shadow_watch.work_off()
        (image,) = shadow_preview.images_of(preview.group)
        assert tuple(image.size) == (resolution, resolution)
        assert image.is_float == (storage == "float32")
        assert shadow_previews.counts() == blocks
    assert image.name == "Shadow Map"


def test_a_map_that_cannot_be_renewed_stays_and_says_so(scene):
    bpy.ops.panorama.preview_shadows()
    before = shadow_previews.texels(scene)
    preview = scene.panorama_shadow_preview
    preview.method, preview.window = "pcf", 13
    shadow_watch.work_off()
    assert "must not exceed 9" in preview.problem
    assert np.array_equal(shadow_previews.texels(scene), before)
    preview.method = "vsm"
    shadow_watch.work_off()
    assert preview.problem == ""


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
    shadow_previews.at_rest()
    scene.panorama_shadow_preview.darkness = 0.5
    bpy.context.view_layer.update()
    assert not shadow_watch.is_waiting()


def test_a_deleted_light_is_gone(scene):
    bpy.ops.panorama.preview_shadows()
    shadow_previews.select("SUN")
    bpy.ops.object.delete()
    bpy.context.view_layer.update()
    shadow_watch.work_off()
    assert "light is gone" in scene.panorama_shadow_preview.problem
    assert not bpy.ops.panorama.renew_shadow_preview.poll()


@pytest.mark.parametrize(("name", "value"), [("visible_shadow", False), ("panorama_role", "SUPPORT")])
def test_what_ceases_to_throw_a_shadow_is_noticed(scene, name, value):
    bpy.ops.panorama.preview_shadows()
    shadow_previews.at_rest()
    before = shadow_previews.texels(scene)
    setattr(bpy.data.objects["ball"], name, value)
    bpy.context.view_layer.update()
    shadow_watch.work_off()
    assert not np.array_equal(shadow_previews.texels(scene), before)


def test_a_floor_that_renders_cease_to_show_is_noticed(scene):
    floor = bpy.data.objects["plane"]
    floor.panorama_role = "SUPPORT"
    bpy.ops.panorama.preview_shadows()
    shadow_previews.at_rest()
    before = shadow_previews.texels(scene)
    floor.hide_render = True
    bpy.context.view_layer.update()
    shadow_watch.work_off()
    assert not np.array_equal(shadow_previews.texels(scene), before)


def test_the_timer_ends_while_what_is_marked_is_not_shown(scene):
    bpy.ops.panorama.preview_shadows()
    shadow_previews.at_rest()
    bpy.context.window.scene = bpy.data.scenes.new("shown")
    scene.panorama_shadow_preview.window = 5
    assert shadow_watch.is_waiting()
    assert shadow_watch._at_rest() is None
    assert shadow_watch.is_waiting()


def test_no_handler_is_left(fresh_blend):
    import expanded_panoramas

    lists = [getattr(bpy.app.handlers, name) for name, _ in shadow_watch.HANDLERS]
    there = [len(one) for one in lists]
    expanded_panoramas.unregister()
    assert [len(one) for one in lists] == [count - 1 for count in there]
    expanded_panoramas.register()
