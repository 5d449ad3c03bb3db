"""Several scenes in one file, their copies and new names, and parts of a place that were deleted."""

import pytest
from room_job import built, select, write_room


@pytest.fixture
def quick(monkeypatch):
    from expanded_panoramas.cycles_integration import preparation

    monkeypatch.setattr(preparation, "IRRADIANCE_WIDTH", 32)
    monkeypatch.setattr(preparation, "IRRADIANCE_SAMPLES", 1)


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
