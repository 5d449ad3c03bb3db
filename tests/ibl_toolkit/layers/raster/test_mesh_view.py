from types import SimpleNamespace

import numpy as np
import pytest
from box_layers import BOTH, HALF, box_depth, directions

from expanded_panoramas.ibl_toolkit.layers.meshes.bounded_mesh import bounded_mesh
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama
from expanded_panoramas.ibl_toolkit.layers.raster.mesh_view import grid_view, mesh_view, quadtree_view
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole

CARD_DISTANCE, CARD_HALF = 1.2, (0.5, 0.35)
"""A red card that stands in the room, across the x axis [m]."""
EYE = (-0.5, 0.4, 0.2)


def bounded_view(panorama, camera):
    return mesh_view(panorama, camera, (bounded_mesh(layer, 1.0) for layer in panorama.layers))


METHODS = (grid_view, quadtree_view, bounded_view)


def colour(points):
    """Of the walls at points (..., 3)."""
    return (0.6 + 0.3 * np.sin(2 * points + (0.0, 1.0, 2.0))).astype(np.float32)


def room_layer(mapping, width, inside=None, name="room"):
    depth = box_depth(mapping, width)
    radiance = colour(directions(mapping, width) * depth[..., None])
    attributes = {"depth": depth, "radiance": radiance}
    if inside is not None:
        attributes["mask"] = inside
        attributes["radiance"] = np.where(inside[..., None], radiance, np.float32(np.nan))
    return Layer(name, mapping, attributes)


def on_card(eye, rays):
    """Distance (...) along rays (..., 3) from an eye to the card, +inf where it isn't hit."""
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (CARD_DISTANCE - eye[0]) / rays[..., 0]
        place = np.asarray(eye) + rays * depth[..., None]
    hit = (depth > 0) & (abs(place[..., 1]) < CARD_HALF[0]) & (abs(place[..., 2]) < CARD_HALF[1])
    return np.where(hit, depth, np.inf)


def card_layer(mapping, width):
    depth = on_card(np.zeros(3), directions(mapping, width))
    red = np.broadcast_to(np.float32([0.9, 0.1, 0.1]), (*depth.shape, 3))
    depth = np.where(np.isfinite(depth), depth, np.nan)
    return Layer("card", mapping, {"depth": depth.astype(np.float32), "radiance": red})


def panorama_of(*layers):
    return LayeredPanorama(layers, np.eye(3), np.zeros(3), 1.0)


def camera_at(eye, sight=(1.0, -0.3, -0.1), fov_deg=70):
    return Pinhole.looking_at(eye, np.add(eye, sight), fov_deg, 96, 64)


def truth(camera):
    rays = camera.directions()
    depth = np.min((np.where(rays > 0, HALF, -HALF) - camera.eye) / rays, axis=2)
    radiance = colour(camera.eye + rays * depth[..., None])
    card = on_card(camera.eye, rays)
    radiance[card < depth] = 0.9, 0.1, 0.1
    return SimpleNamespace(radiance=radiance, depth=np.minimum(card, depth), card=card < depth)


@pytest.mark.parametrize("view_of", METHODS)
@pytest.mark.parametrize("mapping", BOTH)
def test_the_room_is_seen_from_beside_as_rays_see_it(mapping, view_of):
    """To the errors of depth and colour between pixels; a pixel beside an edge may show its other side."""
    panorama = panorama_of(room_layer(mapping, 384), card_layer(mapping, 768))
    camera = camera_at(EYE)
    view, expected = view_of(panorama, camera), truth(camera)
    assert not view.holes.any()
    with_card = view.radiance[..., 0] > 4 * view.radiance[..., 1]
    same = with_card == expected.card
    assert same.mean() > 0.99
    np.testing.assert_allclose(view.depth[same], expected.depth[same], rtol=0.02)
    assert np.abs(view.depth[same] / expected.depth[same] - 1).mean() < 5e-4
    assert np.abs(view.radiance[same] - expected.radiance[same]).mean() < 2e-3


def test_colours_do_not_depend_on_the_mesh():
    """Projected from the origin, they are the same on triangles of pixels and on those of whole walls."""
    panorama = panorama_of(room_layer("cube map", 384))
    few, many = (view_of(panorama, camera_at(EYE)) for view_of in (bounded_view, grid_view))
    assert few.triangles < many.triangles / 500
    assert np.abs(few.radiance - many.radiance).max() < 0.01


@pytest.mark.parametrize("sight", [(1.0, 0.2, 0.9), (-1.0, 0.01, 0.05), (0.2, -0.1, -1.0), (0.5, 1.0, 0.3)])
@pytest.mark.parametrize("mapping", BOTH)
def test_seam_poles_and_edges_of_the_cube_leave_no_crack(mapping, sight):
    panorama = panorama_of(room_layer(mapping, 96))
    for view_of in METHODS:
        assert not view_of(panorama, camera_at(EYE, sight, 120)).holes.any()


def test_the_panoramas_own_place_counts():
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    origin = np.array([5.0, -2, 1])
    layer = room_layer("equirectangular", 192)
    moved = LayeredPanorama((layer,), quarter, origin, 1.0)
    sight = np.array([1.0, -0.3, -0.1])
    camera = camera_at(origin + quarter @ EYE, quarter @ sight)
    expected = grid_view(panorama_of(layer), camera_at(EYE, sight))
    np.testing.assert_allclose(grid_view(moved, camera).radiance, expected.radiance, atol=1e-5)


@pytest.mark.parametrize("view_of", METHODS)
@pytest.mark.parametrize("mapping", BOTH)
def test_layers_that_share_a_surface_show_no_cracks(mapping, view_of):
    """Each wall is a layer, which ends at the sides of its pixels: slits between them are closed."""
    width = 96
    rays = directions(mapping, width)
    axis = np.argmin(HALF / np.abs(rays), axis=2)
    wall = 2 * axis + (np.take_along_axis(rays, axis[..., None], 2)[..., 0] > 0)
    panorama = panorama_of(*(room_layer(mapping, width, wall == k, str(k)) for k in range(6)))
    for eye in ((0, 0, 0), (1.0, -0.9, -0.4)):
        view, expected = view_of(panorama, camera_at(eye)), truth(camera_at(eye))
        assert not view.holes.any()
        assert np.abs(view.radiance - expected.radiance)[~expected.card].mean() < 0.01


@pytest.mark.parametrize("view_of", METHODS)
def test_a_coarse_layer_elsewhere_closes_no_holes(view_of):
    """Of a wall seen ahead a patch is missing; behind the eye is one pixel of a layer of 16 × 8."""
    rays = directions("equirectangular", 512)
    known = ~((rays[..., 0] > 0.9) & (np.abs(rays[..., 1:]) < 0.12).all(axis=2))
    room = room_layer("equirectangular", 512, known)
    behind = np.zeros((8, 16), bool)
    behind[4, 0] = True
    coarse = room_layer("equirectangular", 16, behind, "coarse")
    camera = camera_at((0, 0, 0), (1.0, 0.0, 0.0))
    alone = view_of(panorama_of(room), camera).holes
    assert alone.sum() > 100
    np.testing.assert_array_equal(view_of(panorama_of(room, coarse), camera).holes, alone)


@pytest.mark.parametrize("view_of", METHODS)
def test_what_was_never_seen_stays_a_hole(view_of):
    """Behind the card the room is not known: from beside a strip of it is a hole, and nothing else."""
    rays = directions("equirectangular", 512)
    room = room_layer("equirectangular", 512, np.isinf(on_card(np.zeros(3), rays)))
    panorama = panorama_of(room, card_layer("equirectangular", 512))
    camera = camera_at(EYE)
    view, expected = view_of(panorama, camera), truth(camera)
    points = camera.eye + camera.directions() * expected.depth[..., None]
    unseen = np.isfinite(on_card(np.zeros(3), points)) & ~expected.card
    assert unseen.mean() > 0.02
    assert (view.holes != unseen).mean() < 0.02
    assert not view.radiance[view.holes].any()


def test_what_is_cut_off_hides_nothing():
    """A layer right of the origin, its mesh two planes all across; behind them the plane of another layer."""
    right = room_layer("equirectangular", 192, directions("equirectangular", 192)[..., 1] < 0)
    planes = [np.array([[x, -90, -90], [x, 90, -90], [x, 0, 300]]) for x in (1.0, 1.5, 2.0)]
    near = SimpleNamespace(points=np.concatenate(planes[:2]), triangles=np.array([[0, 1, 2], [3, 4, 5]]))
    far = SimpleNamespace(points=planes[2], triangles=near.triangles[:1])
    camera = camera_at((0, 0.2, 0), (1.0, 0.0, 0.0))
    view = mesh_view(panorama_of(right, room_layer("equirectangular", 192, name="all")), camera, [near, far])
    rays = camera.directions()
    slope = rays[..., 1] / rays[..., 0]  # a plane is right of the origin where 0.2 + slope x < 0
    expected = np.where(slope < -0.2 / 1.0, 1.0, np.where(slope < -0.2 / 1.5, 1.5, 2.0))
    sure = np.min(np.abs(slope[..., None] + (0.2 / 1.0, 0.2 / 1.5)), axis=2) > 0.005
    np.testing.assert_allclose((view.depth * rays[..., 0])[sure], expected[sure], rtol=1e-5)


@pytest.mark.parametrize("view_of", METHODS)
def test_infinity_is_behind_all(view_of):
    """A layer of which a part is at infinity, and one that is nowhere else and has no triangles."""
    up = directions("equirectangular", 256)[..., 2] > 0
    ground = room_layer("equirectangular", 256)
    attributes = ground.attributes | {"depth": np.where(up, np.float32(np.inf), ground.depth)}
    sky = Layer(
        "sky", "equirectangular", {"depth": np.full_like(ground.depth, np.inf), "radiance": ground.radiance}
    )
    camera = camera_at((0, 0, 0))
    view = view_of(panorama_of(Layer("all", "equirectangular", attributes)), camera)
    assert not view.holes.any()
    above = camera.directions()[..., 2] > 0.02
    assert np.isposinf(view.depth[above]).all()
    assert np.isfinite(view.depth[camera.directions()[..., 2] < -0.02]).all()
    alone = view_of(panorama_of(sky), camera_at(EYE))
    assert alone.triangles == 0
    assert np.isposinf(alone.depth).all()


@pytest.mark.parametrize("mapping", BOTH)
@pytest.mark.parametrize("view_of", METHODS)
def test_domains_of_single_pixels(mapping, view_of):
    """At a pole, at the seam, and before the eye, each as large as its pixel or less."""
    width = 48
    depth = np.full_like(box_depth(mapping, width), 2.0)
    inside = np.zeros(depth.shape, dtype=bool)
    row, column = np.unravel_index(np.argmax(directions(mapping, width)[..., 0]), depth.shape)
    inside[0, 3] = inside[depth.shape[0] // 2, 0] = inside[-1, -1] = inside[row, column] = True
    layer = Layer(
        "dots", mapping, {"depth": depth, "radiance": np.ones((*depth.shape, 3), np.float32), "mask": inside}
    )
    ray = directions(mapping, width)[row, column]
    view = view_of(panorama_of(layer), camera_at((0.0, 0.0, 0.0), ray, 40))
    shown = np.count_nonzero(~view.holes)
    side = (np.pi / 2 / (width / 3) if mapping == "cube map" else 2 * np.pi / width) * camera_at(
        EYE, fov_deg=40
    ).focal
    assert 0.5 * side**2 < shown < 1.6 * side**2
    tilt = 0.2 if view_of is bounded_view else 0.02  # a plane through one point may have any slope
    np.testing.assert_allclose(view.depth[~view.holes], 2.0, rtol=tilt)


@pytest.mark.parametrize("view_of", METHODS)
@pytest.mark.parametrize(
    ("eye", "sight", "least", "most"),
    [
        (
            (-8.0, 0.3, 0.2),
            (1.0, 0.02, 0.03),
            0.3,
            0.9,
        ),  # outside, towards the room: its back, and nothing around
        ((-8.0, 0.3, 0.2), (-1.0, 0.02, 0.03), 1.0, 1.0),  # away from it
        ((1.3, 0.1, 0.05), (-1.0, 0.02, 0.03), 0.0, 0.0),  # behind the card: its back, and the room
        ((CARD_DISTANCE, 0.1, 0.05), (0.1, 1.0, 0.03), 0.0, 0.0),  # in it
        ((0.0, 0.0, 0.0), (1.0, 0.02, 0.03), 0.0, 0.0),
    ],
)
def test_eyes_where_none_should_be(view_of, eye, sight, least, most):
    panorama = panorama_of(room_layer("equirectangular", 128), card_layer("equirectangular", 128))
    view = view_of(panorama, camera_at(eye, sight, 60))
    assert least <= view.holes.mean() <= most
    assert np.isfinite(view.radiance).all()


def test_layers_without_colours_are_refused():
    layer = Layer("bare", "equirectangular", {"depth": box_depth("equirectangular", 8)})
    with pytest.raises(ValueError, match="layer 'bare' has no radiance"):
        grid_view(panorama_of(layer), camera_at(EYE))


@pytest.mark.parametrize(("count", "message"), [(0, "0 meshes for 1 layers"), (2, "more meshes than layers")])
def test_each_layer_has_one_mesh(count, message):
    layer = room_layer("equirectangular", 8)
    with pytest.raises(ValueError, match=message):
        mesh_view(panorama_of(layer), camera_at(EYE), [bounded_mesh(layer, 1.0)] * count)
