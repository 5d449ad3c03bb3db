"""The two halves of the preparation make what it makes in one go; and when a place is another."""

import numpy as np
import panoramas
import pytest

MAPS = ("residual", "irradiance", "gloss", "sky", "sun_residual", "sun_quiet")


@pytest.fixture
def room(fresh_blend, tmp_path, monkeypatch):
    """room() opens the same file anew: a glossy floor and a lamp, partly under the sky."""
    from expanded_panoramas.cycles_integration import preparation

    monkeypatch.setattr(preparation, "IRRADIANCE_WIDTH", 32)
    image = np.full((64, 128, 3), 0.3, np.float32)
    image[10:13, 30:36] = (90, 60, 30)
    panoramas.room_place(fresh_blend, panoramas.write_panorama(tmp_path / "lamp.exr", image))
    fresh_blend.data.objects["floor"].panorama_reflectivity = 0.2
    fresh_blend.data.objects.remove(fresh_blend.data.objects["table"])
    fresh_blend.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"))

    def opened():
        fresh_blend.ops.wm.open_mainfile(filepath=str(tmp_path / "room.blend"))
        return fresh_blend.context.scene

    return opened


def summary(scene):
    """Images, and what is made of the lamps, as numbers and names."""
    from expanded_panoramas.cycles_integration import blender_images
    from expanded_panoramas.cycles_integration.view_layers import layer_collection

    here = scene.panorama_place
    images = {name: getattr(here, name) for name in MAPS}
    images = {name: image and blender_images.array_from_image(image).copy() for name, image in images.items()}
    lamps = [[vertex.co[:] for vertex in thing.data.vertices] for thing in here.lights.objects]
    strengths = [
        node.inputs["Strength"].default_value
        for thing in here.lights.objects
        for node in thing.data.materials[0].node_tree.nodes
        if node.bl_idname == "ShaderNodeEmission"
    ]
    worn = {o.name: [m.name for m in o.data.materials] for o in here.surfaces.all_objects}
    suns = [(thing.data.energy, thing.rotation_quaternion[:]) for thing in here.suns.objects]
    shown = layer_collection(scene.view_layers[0], here.suns).exclude
    world = (scene.world.name, scene.world.cycles.sampling_method, len(scene.world.node_tree.nodes))
    return images, (lamps, strengths, worn, suns, shown, world)


def test_applied_to_another_copy_it_is_the_same(room):
    from expanded_panoramas.cycles_integration import preparation

    scene = room()
    spent = preparation.prepare(scene)
    images, made = summary(scene)
    assert spent.at_depth.count > 0
    assert images["gloss"] is not None
    measured = preparation.measure(room())
    scene = room()
    applied = preparation.apply(scene, measured)
    images_applied, made_applied = summary(scene)
    assert made_applied == made
    for name in MAPS:
        assert (images_applied[name] is None) == (images[name] is None), name
        if images[name] is not None:
            assert np.array_equal(images_applied[name], images[name]), name
    assert (applied.at_depth, applied.coverage) == (spent.at_depth, spent.coverage)
    assert set(applied.seconds) == set(spent.seconds) == {"depth", "lights", "irradiance"}


@pytest.mark.parametrize(
    ("change", "is_another"),
    [
        (lambda bpy, scene: setattr(bpy.data.objects["floor"], "panorama_role", "ENVIRONMENT"), True),
        (lambda bpy, scene: setattr(bpy.data.objects["floor"].location, "z", 0.1), True),
        (lambda bpy, scene: setattr(bpy.data.objects["floor"].data.vertices[0].co, "z", 0.1), True),
        (lambda bpy, scene: setattr(scene.panorama_place.origin.location, "z", 2), True),
        (lambda bpy, scene: bpy.data.objects.remove(bpy.data.objects["walls"]), True),
        (lambda bpy, scene: bpy.ops.mesh.primitive_cube_add(), False),
        (lambda bpy, scene: setattr(scene.panorama_set.job, "samples", 9), False),
    ],
)
def test_what_makes_a_place_another(fresh_blend, room, change, is_another):
    from expanded_panoramas.cycles_integration.place_digest import digest_of_place

    scene = room()
    before = digest_of_place(scene)
    change(fresh_blend, scene)
    fresh_blend.context.view_layer.update()
    assert (digest_of_place(scene) != before) == is_another
