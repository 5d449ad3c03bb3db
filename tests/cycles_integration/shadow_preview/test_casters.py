"""What throws shadows: points that a map has to cover, what renders leave out or repeat, broken meshes."""

import bpy
import numpy as np
import pytest
import shadow_pictures
import small_scenes

from expanded_panoramas.cycles_integration.node_trees import add, new_group, output_group
from expanded_panoramas.cycles_integration.shadow_preview import casters_of
from expanded_panoramas.cycles_integration.shadow_preview.casters import ground_of


@pytest.fixture
def ball(fresh_blend):
    """A ball of 0.3 m, 0.5 m beside the origin."""
    scene = fresh_blend.context.scene
    return small_scenes.add_ball(scene, small_scenes.material(small_scenes.DIFFUSE), 0.3, (0.5, 0, 0))


@pytest.fixture
def scene(fresh_blend):
    """A floor, a box and a ball."""
    shadow_pictures.still_life()
    return fresh_blend.context.scene


def add_thing(name, data):
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def found():
    bpy.context.view_layer.update()
    return casters_of(bpy.context.evaluated_depsgraph_get())


def test_points_of_no_triangle_widen_no_map(ball):
    """The path that a camera follows, and a vertex that an artist forgot."""
    path = bpy.data.curves.new("path", "CURVE")
    line = path.splines.new("POLY")
    line.points.add(1)
    line.points[1].co = (50, 0, 0, 1)
    add_thing("path", path)
    loose = bpy.data.meshes.new("loose")
    loose.from_pydata([(9, 9, 9), (0, 0, 0.1), (0.1, 0, 0), (0, 0.1, 0)], [], [(1, 2, 3)])
    add_thing("loose", loose)
    points, triangles = found()
    assert np.abs(points).max() < 1
    expected = [(0, 0, 0.1), (0.1, 0, 0), (0, 0.1, 0)]
    np.testing.assert_allclose(points[triangles[-1]], expected, atol=1e-7)


def test_geometry_nodes_repeat_what_renders_leave_out(ball):
    """As Cycles does; vertex instances of it are left out."""
    one = len(found()[1])
    tree = new_group("repeat", "GeometryNodeTree", {"Geometry": "NodeSocketGeometry"})
    whole = add(tree, "GeometryNodeObjectInfo", {"Object": ball, "As Instance": True})
    output_group(tree, Geometry=whole.outputs["Geometry"])
    field = add_thing("field", bpy.data.meshes.new("field"))
    field.modifiers.new("repeat", "NODES").node_group = tree
    assert len(found()[1]) == 2 * one
    ball.hide_render = True
    assert len(found()[1]) == one
    field.modifiers.clear()
    field.data.from_pydata([(0, 0, 0), (1, 0, 0)], [], [])
    ball.parent, field.instance_type = field, "VERTS"
    assert len(found()[1]) == 0


def test_a_mesh_with_places_that_are_no_numbers_is_named(ball):
    ball.data.vertices[7].co.z = float("nan")
    with pytest.raises(ValueError, match="'ball' has vertices whose places are not finite numbers"):
        found()


def test_real_things_throw_no_shadow_and_instances_do(scene):
    whole = len(found()[1])
    bpy.data.objects["plane"].panorama_role = "SUPPORT"
    assert len(found()[1]) == whole - 2
    box = bpy.data.objects["Cube"]
    collection = bpy.data.collections.new("boxes")
    collection.objects.link(box)
    several = bpy.data.objects.new("boxes", None)
    several.instance_type, several.instance_collection, several.location = "COLLECTION", collection, (0, 0, 3)
    scene.collection.objects.link(several)
    points, triangles = found()
    assert len(triangles) == whole - 2 + 12
    assert points[:, 2].max() == pytest.approx(3.6)


def test_collections_that_renders_leave_out_throw_no_shadow(scene):
    whole = len(found()[1])
    box, collection = bpy.data.objects["Cube"], bpy.data.collections.new("views")
    scene.collection.children.link(collection)
    collection.objects.link(box)
    scene.collection.objects.unlink(box)
    collection.hide_render = True
    assert len(found()[1]) == whole - 12


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
        return len(found()[1]) // 12

    whole = count()
    instances[1].hide_render = True
    assert count() == whole - 1
    inner.hide_render = True
    assert count() == whole - 2
    instances[1].hide_render = False
    assert count() == whole - 2
    outer.objects.link(box)
    assert count() == whole


@pytest.mark.parametrize(("role", "triangles"), [("SUPPORT", 2), ("ENVIRONMENT", 0), ("SYNTHETIC", 0)])
def test_ground_is_what_is_meant_to_receive_shadows(scene, role, triangles):
    bpy.data.objects["plane"].panorama_role = role
    bpy.context.view_layer.update()
    assert len(ground_of(bpy.context.evaluated_depsgraph_get())[1]) == triangles
