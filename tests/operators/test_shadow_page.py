"""Export Shadow Page: what it writes, of which lights and kinds, and why it cannot."""

import json
import struct

import bpy
import pytest
import shadow_pictures

from expanded_panoramas.cycles_integration.shadow_page import page_scene
from expanded_panoramas.operators.shadow_page import kinds_of

NAME = "export_shadow_page"


@pytest.fixture
def scene(fresh_blend):
    """A floor that is real, a box and a ball, a sun, a perspective camera."""
    shadow_pictures.still_life()
    shadow_pictures.add_light("SUN")
    scene = fresh_blend.context.scene
    bpy.data.objects["plane"].panorama_role = "SUPPORT"
    scene.camera.data.type = "PERSP"
    scene.panorama_shadow_preview.resolution = 64
    return scene


def extras(path):
    """Of the .glb's scene."""
    data = path.read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + size])["scenes"][0]["extras"]


def reason():
    with pytest.raises(RuntimeError) as refusal:
        getattr(bpy.ops.panorama, NAME)()
    return str(refusal.value)


def test_page_and_glb_have_the_previews_kind_and_the_visible_lights(scene, tmp_path):
    shadow_pictures.add_light("POINT")
    assert bpy.ops.panorama.export_shadow_page(filepath=str(tmp_path / "a")) == {"FINISHED"}
    assert "<title>a</title>" in (tmp_path / "a.html").read_text(encoding="utf-8")
    bpy.ops.panorama.export_shadow_page(filepath=str(tmp_path / "a.glb"), file_format=".glb")
    found = extras(tmp_path / "a.glb")
    assert [kind["label"] for kind in found["shadow_settings"]] == ["EVSM, 64 × 64, 16+16, window 3, 16 KiB"]
    assert {light["perspective"] for light in found["lights"]} == {True, False}
    options = {"file_format": ".glb", "compare": True, "most": 1, "light_from": "scene"}
    bpy.ops.panorama.export_shadow_page(filepath=str(tmp_path / "b.glb"), **options)
    found = extras(tmp_path / "b.glb")
    assert [kind["method"] for kind in found["shadow_settings"]] == ["evsm", "hard", "pcf", "vsm"]
    assert len(found["lights"]) == 1
    scene.panorama_shadow_preview.method, scene.panorama_shadow_preview.window = "pcf", 15
    bpy.ops.panorama.export_shadow_page(filepath=str(tmp_path / "c.glb"), file_format=".glb")
    assert extras(tmp_path / "c.glb")["shadow_settings"][0]["window"] == 15  # more than nodes can have


def test_a_preview_that_stands_for_a_light_leaves_it_its_shadow_on_the_page(scene, tmp_path):
    bpy.data.objects["plane"].select_set(True)
    bpy.ops.panorama.preview_shadows()
    assert not bpy.data.lights["SUN"].use_shadow
    kinds = kinds_of(scene.panorama_shadow_preview, False)
    found = page_scene(scene, bpy.context.evaluated_depsgraph_get(), kinds)
    assert found.light_names == ("SUN",)
    assert {mesh.albedo for mesh in found.scene.meshes[1:]} == {(1, 1, 1)}  # through the preview's group
    assert not any("base colour" in text for text in found.warnings)
    bpy.ops.panorama.remove_shadow_preview()
    bpy.data.lights["SUN"].use_shadow = False
    with pytest.raises(RuntimeError, match="no light shines on what throws shadows"):
        bpy.ops.panorama.export_shadow_page(filepath=str(tmp_path / "b.glb"), file_format=".glb")


def test_what_is_missing_is_said(scene, tmp_path):
    with pytest.raises(RuntimeError, match="No such file or directory"):
        bpy.ops.panorama.export_shadow_page(filepath=str(tmp_path / "none" / "a.html"))
    bpy.data.objects.remove(bpy.data.objects["SUN"])
    assert "Add a light first" in reason()
    rig = bpy.data.objects.new("rig", None)
    rig.instance_type = "COLLECTION"  # may have lights
    scene.collection.objects.link(rig)
    assert bpy.ops.panorama.export_shadow_page.poll()
    bpy.data.objects.remove(scene.camera)
    assert "Add a camera: the page looks from there" in reason()
    for thing in list(scene.objects):
        bpy.data.objects.remove(thing)
    assert "Add an object of the role Synthetic" in reason()
    assert not list(tmp_path.iterdir())
