"""Scenes for measuring light."""

import numpy as np
import pytest

pytest.importorskip("bpy")

from expanded_panoramas.cycles_integration import capture
from expanded_panoramas.sample_scenes import light_scenes

SHADERS = {
    "diffuse": ["BSDF_DIFFUSE"] * 4,
    "glossy": ["BSDF_GLOSSY"] * 4,
    "mixed": ["BSDF_GLOSSY", "BSDF_GLOSSY", "BSDF_DIFFUSE", "BSDF_GLOSSY"],
}


@pytest.mark.parametrize("kind", light_scenes.KINDS)
def test_objects_are_of_their_kind_on_a_diffuse_floor(fresh_blend, kind):
    *objects, floor = light_scenes.add_objects(fresh_blend.context.scene, kind)
    assert [_shader(thing).type for thing in objects] == SHADERS[kind]
    assert _shader(floor).type == "BSDF_DIFFUSE"


def test_glossy_objects_are_rough_and_one_of_a_mixed_scene_is_a_mirror(fresh_blend):
    scene = fresh_blend.context.scene
    rough = light_scenes.add_objects(scene, light_scenes.GLOSSY)[1]
    mirror = light_scenes.add_objects(scene, light_scenes.MIXED)[1]
    roughness = [_shader(thing).inputs["Roughness"].default_value for thing in (rough, mirror)]
    assert roughness == [light_scenes.ROUGHNESS, 0]


def test_the_camera_sees_objects_and_nothing_but_them_and_the_floor(fresh_blend):
    scene = fresh_blend.context.scene
    objects = light_scenes.add_objects(scene, light_scenes.DIFFUSE)
    light_scenes.add_camera(scene)
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x, scene.render.resolution_y = 32, 18
    for number, thing in enumerate(objects):
        thing.pass_index = 1 + number
    scene.view_layers[0].use_pass_object_index = True
    seen = np.unique(capture.render_passes(scene)["Object Index"])
    assert set(range(1, 1 + len(objects))) <= set(seen.tolist())


def test_a_kind_that_does_not_exist_is_refused(fresh_blend):
    with pytest.raises(ValueError, match="kind is 'shiny'; expected one of diffuse, glossy, mixed"):
        light_scenes.add_objects(fresh_blend.context.scene, "shiny")


def _shader(thing):
    tree = thing.data.materials[0].node_tree
    return (
        next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
        .inputs["Surface"]
        .links[0]
        .from_node
    )
