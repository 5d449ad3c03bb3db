"""The shadow preview on rebuilt surfaces: they show the photograph meanwhile, and are bare afterwards."""

import bpy
import numpy as np
import panoramas

from expanded_panoramas.cycles_integration import shadow_preview


def test_bare_pieces_show_the_photograph_until_it_is_removed(fresh_blend, tmp_path):
    image = panoramas.write_panorama(tmp_path / "room.exr", np.ones((32, 64, 3)))
    scene, _ = panoramas.room_place(fresh_blend, image)
    floor = bpy.data.objects["floor"]
    bpy.ops.mesh.primitive_cube_add(size=0.2, location=(0, 0, 0.3))
    bpy.ops.object.light_add(type="SUN")
    floor.select_set(True)
    bpy.data.objects["Cube"].select_set(True)
    scene.panorama_shadow_preview.resolution = 32
    assert bpy.ops.panorama.preview_shadows() == {"FINISHED"}
    (material,) = floor.data.materials
    group = scene.panorama_shadow_preview.group
    (node,) = shadow_preview.nodes_of(material, group)
    assert node.inputs["Surface"].links[0].from_node.type == "EMISSION"
    assert floor.display_type == "TEXTURED"
    assert shadow_preview.nodes_of(bpy.data.objects["Cube"].data.materials[0], group)
    assert bpy.ops.panorama.remove_shadow_preview() == {"FINISHED"}
    assert not floor.data.materials
    assert floor.display_type == "WIRE"
    assert not [one for one in bpy.data.materials if one.name.startswith("Panorama Photograph")]
