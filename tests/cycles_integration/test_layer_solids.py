"""Solids in layers: no inside, far sides of their own, and which things are solids."""

import numpy as np
import pytest

pytest.importorskip("bpy")

import small_scenes as small
from boxed_scene import (
    BOX,
    DIRECTIONS,
    EMISSION,
    LEVEL,
    METRES,
    ORIGIN,
    ROOM,
    WIDTH,
    add_box,
    room_depth,
    surfaces,
)
from mathutils import Vector

from expanded_panoramas.cycles_integration.layer_capture import capture_surfaces
from expanded_panoramas.cycles_integration.layer_render import LayerCapture
from expanded_panoramas.cycles_integration.solids import closed_solids
from expanded_panoramas.ibl_toolkit import equirectangular


def test_a_solid_has_no_inside_and_what_it_stands_on_goes_on_beneath(hollow_room):
    foot = ROOM[0, 2]
    add_box(hollow_room, np.array([[1, -0.5, foot], [1.6, 0.7, 0.3]]), small.material(EMISSION))
    layers = surfaces(hollow_room, LEVEL, 1.0, LayerCapture(WIDTH, samples=1, most=5))
    assert len(layers) == 2
    seen = layers[1].mask
    np.testing.assert_allclose(layers[1].depth[seen], room_depth(DIRECTIONS)[seen], atol=METRES)


def test_the_far_side_of_a_solid_that_a_view_sees_is_in_a_layer_as_it_is_lit_outside(hollow_room):
    centre, size, width, radius = np.array([2.0, 0, 0]), 0.8, 128, 0.5
    ball = small.add_ball(hollow_room, small.material(small.DIFFUSE), size, Vector(ORIGIN) + Vector(centre))
    options = LayerCapture(width, samples=4)
    layers = {layer.name: layer for layer in capture_surfaces(hollow_room, LEVEL, radius, options).layers}
    back = layers["back of surface 1"]
    directions = equirectangular.pixel_directions(width, width // 2).astype(float)
    along = directions @ centre
    half = np.sqrt(np.maximum(along**2 - centre @ centre + size**2, 0))
    far_side = np.where((half > 0) & (along > 0), along + half, np.nan)
    normal = (far_side[..., None] * directions - centre) / size
    to_plane = np.abs(np.einsum("ijk,ijk->ij", far_side[..., None] * directions, normal))
    assert back.mask[to_plane < radius].mean() > 0.98
    assert not back.mask[~(to_plane < 1.4 * radius)].any()
    np.testing.assert_allclose(back.depth[back.mask], far_side[back.mask], rtol=0.01)
    assert np.median(back.radiance[back.mask]) > 0.15  # the walls light it; its inside is dark
    assert ball.visible_camera


def test_solids_are_closed_face_outwards_and_do_not_hold_the_origin(furnished_room):
    open_box = add_box(furnished_room, BOX, None)
    faces = [tuple(face.vertices) for face in open_box.data.polygons][:5]
    places = [tuple(vertex.co) for vertex in open_box.data.vertices]
    open_box.data.clear_geometry()
    open_box.data.from_pydata(places, [], faces)
    split = add_box(furnished_room, BOX, None)
    apart = [places[k] for face in split.data.polygons for k in face.vertices]
    split.data.clear_geometry()
    split.data.from_pydata(apart, [], np.arange(24).reshape(6, 4).tolist())
    add_box(furnished_room, BOX, None, inward=True)
    add_box(furnished_room, ROOM, None)
    found = closed_solids(furnished_room.view_layers[0], Vector(ORIGIN))
    assert found == {furnished_room.objects["box"], split}
