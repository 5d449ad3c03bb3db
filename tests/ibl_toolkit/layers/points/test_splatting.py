"""Both methods of views by samples, against a room whose views are known."""

import cv2
import numpy as np
import pytest
from box_layers import BOTH, directions
from card_room import CARD_X, CARD_Y, CARD_Z, card_layer, cast, panorama_of, pattern, room_layer, true_view

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer
from expanded_panoramas.ibl_toolkit.layers.points import point_canvas
from expanded_panoramas.ibl_toolkit.layers.points.adaptive_splatting import adaptive_view
from expanded_panoramas.ibl_toolkit.layers.points.splatting import splat_view
from expanded_panoramas.ibl_toolkit.layers.views.pinhole import Pinhole

METHODS = (splat_view, adaptive_view)
WIDTHS = {"equirectangular": 384, "cube map": 288}
EYES = {
    "centre": (0.0, 0.0, 0.0),
    "left": (-0.3, 0.4, 0.1),
    "below": (0.2, -0.1, -0.5),
    "near": (0.8, -0.3, -0.1),  # 0.2 m from the card, whose pixels are 19 px wide there
}

CREASE = 0.08
"""How far colours may be off where two walls meet within a pixel of the map, which has one colour."""

both_methods = pytest.mark.parametrize("method", METHODS, ids=["splat", "adaptive"])
both_mappings = pytest.mark.parametrize("mapping", BOTH)


@pytest.fixture(scope="module")
def rooms():
    return {m: panorama_of(room_layer(m, WIDTHS[m]), card_layer(m, WIDTHS[m])) for m in BOTH}


def looking(eye, look_at=(1.0, -0.1, 0.0), fov_deg=70.0, size=(180, 120)):
    return Pinhole.looking_at(eye, look_at, fov_deg, *size)


def away_from_edges(on_card, pixels):
    """Pixels (H, W) that lie further than that from the card's outline."""
    kernel = np.ones((2 * pixels + 1, 2 * pixels + 1), np.uint8)
    card = on_card.astype(np.uint8)
    return cv2.erode(card, kernel) == cv2.dilate(card, kernel)


@both_methods
@both_mappings
@pytest.mark.parametrize("eye", EYES.values(), ids=EYES)
def test_a_room_and_a_card_as_they_are_seen(rooms, method, mapping, eye):
    """No holes; nothing of the room shows through the card; colours and depths are the true ones."""
    camera = looking(eye, (eye[0] + 1, eye[1] * 0.5, 0.05))
    view = method(rooms[mapping], camera)
    colours, distance, on_card = true_view(camera)
    assert view.radiance.dtype == view.depth.dtype == np.float32
    assert not view.holes.any()
    # A pixel of the map is up to 5 px of the picture, 19 px of it where the eye is near the card.
    edge = 14 if eye == EYES["near"] else 4
    sure = away_from_edges(on_card, edge)
    assert sure.mean() > 0.5
    assert np.abs(view.radiance - colours)[sure].max() < CREASE
    np.testing.assert_allclose(view.depth[sure], distance[sure], rtol=0.02)
    assert np.sqrt(((view.radiance - colours) ** 2).mean()) < 0.12


@both_methods
@both_mappings
@pytest.mark.parametrize("look_at", [(-2, 0.05, 0.1), (0.02, 0.01, 1.5), (-0.01, 0.02, -1.5), (-1.5, 2, 1.2)])
def test_seam_poles_and_edges_do_not_show(rooms, method, mapping, look_at):
    camera = looking((0.1, 0.2, -0.1), look_at)
    view = method(rooms[mapping], camera)
    colours, distance, _ = true_view(camera)
    assert np.abs(view.radiance - colours).max() < CREASE / 2
    np.testing.assert_allclose(view.depth, distance, rtol=0.015)


@both_methods
def test_layers_may_differ_in_mapping_and_resolution(method):
    panorama = panorama_of(card_layer("cube map", 192), room_layer("equirectangular", 256))
    camera = looking(EYES["left"])
    view = method(panorama, camera)
    colours, _, on_card = true_view(camera)
    assert not view.holes.any()
    assert np.abs(view.radiance - colours)[away_from_edges(on_card, 8)].max() < CREASE


@both_methods
def test_the_panorama_may_stand_anywhere_and_be_turned(rooms, method):
    turned = cv2.Rodrigues(np.array([0.3, -0.5, 1.0]))[0]
    origin = np.array([3.0, -2.0, 1.15])
    panorama = panorama_of(*rooms["cube map"].layers, world_from_panorama=turned, origin=origin)
    own = looking(EYES["left"])
    camera = Pinhole(turned @ own.eye + origin, own.axes @ turned.T, own.fov_deg, own.width, own.height)
    np.testing.assert_allclose(
        method(panorama, camera).radiance, method(rooms["cube map"], own).radiance, atol=2e-3
    )


@both_methods
@both_mappings
def test_a_hole_in_a_domain_is_a_hole_in_the_view(method, mapping):
    room = room_layer(mapping, WIDTHS[mapping])
    gap = directions(mapping, WIDTHS[mapping]) @ (0.8, 0.6, 0) > np.cos(0.3)
    with_gap = Layer("room", mapping, {**room.attributes, "mask": ~gap})
    camera = looking((0.2, 0.1, 0.1), (1, 0.75, 0))
    view = method(panorama_of(with_gap), camera)
    points = camera.eye + cast(camera.eye, camera.directions())[0][..., None] * camera.directions()
    seen_at = np.arccos(points @ (0.8, 0.6, 0) / np.linalg.norm(points, axis=2))
    pixel = 0.02  # of the map, and a pixel of the view [rad]
    assert view.holes[seen_at < 0.3 - pixel].all()
    assert not view.holes[seen_at > 0.3 + pixel].any()
    assert not view.radiance[view.holes].any()


@both_methods
def test_a_layer_of_one_pixel(method):
    """It is a card as large as the pixel, before the room."""
    attributes = {
        name: values.copy() for name, values in room_layer("equirectangular", 64).attributes.items()
    }
    inside = np.zeros((32, 64), dtype=bool)
    inside[16, 32] = True
    attributes["depth"][:] = np.nan
    attributes["depth"][inside], attributes["radiance"][inside] = 1.0, 5.0
    panorama = panorama_of(room_layer("equirectangular", 64), Layer("dot", "equirectangular", attributes))
    view = method(panorama, looking((0, 0, 0), (1, 0, 0), 60, (240, 160)))
    dot = view.radiance[..., 0] > 3
    side = np.radians(360 / 64) * looking((0, 0, 0), (1, 0, 0), 60, (240, 160)).focal
    assert np.count_nonzero(dot) == pytest.approx(side**2, rel=0.15)
    np.testing.assert_allclose(view.depth[cv2.erode(dot.astype(np.uint8), np.ones((3, 3))) > 0], 1, rtol=0.02)


@both_methods
def test_what_lies_at_infinity_is_behind_all_and_does_not_move(method):
    rays = directions("equirectangular", 256)
    sky = Layer(
        "sky",
        "equirectangular",
        {"depth": np.full(rays.shape[:2], np.inf, np.float32), "radiance": (rays + 2).astype(np.float32)},
    )
    camera = looking(EYES["left"])
    view = method(panorama_of(sky, card_layer("equirectangular", 512)), camera)
    _, distance, on_card = true_view(camera)
    sure = away_from_edges(on_card, 4)
    assert np.isposinf(view.depth[sure & ~on_card]).all()
    np.testing.assert_allclose(
        view.radiance[sure & ~on_card], camera.directions()[sure & ~on_card] + 2, atol=3e-3
    )
    np.testing.assert_allclose(view.depth[sure & on_card], distance[sure & on_card], rtol=0.02)


@both_methods
def test_from_the_side_one_sees_past_a_jump_within_a_layer(method):
    """Surfaces that a jump in depth parts aren't joined: what was hidden behind the card is a hole."""
    room, card = (make("equirectangular", 512) for make in (room_layer, card_layer))
    in_front = ~np.isnan(card.depth)
    merged = {"depth": np.where(in_front, card.depth, room.depth)}
    merged["radiance"] = np.where(in_front[..., None], card.radiance, room.radiance)
    camera = looking(EYES["left"])
    view = method(panorama_of(Layer("all", "equirectangular", merged)), camera)
    colours, distance, on_card = true_view(camera)
    points = camera.eye + distance[..., None] * camera.directions()
    behind = CARD_X / points[..., :1] * points
    hidden = ~on_card & (points[..., 0] > CARD_X)
    for axis, (low, high) in ((1, CARD_Y), (2, CARD_Z)):
        hidden &= (behind[..., axis] > low) & (behind[..., axis] < high)
    core = cv2.erode(hidden.astype(np.uint8), np.ones((9, 9))) > 0
    clear = away_from_edges(on_card | hidden, 4) & away_from_edges(on_card, 4) & ~hidden
    assert core.any()
    assert view.holes[core].all()
    assert not view.holes[clear].any()
    assert np.abs(view.radiance - colours)[clear].max() < 0.05


@both_methods
def test_a_floor_has_no_gaps_up_to_its_horizon(method):
    """Neighbouring rows there are more than JUMP apart, and yet one surface."""
    rays = equirectangular.pixel_directions(256, 128).astype(float)
    below = rays[..., 2] < 0
    depth = np.where(below, -1.5 / np.where(below, rays[..., 2], -1), np.nan).astype(np.float32)
    colours = np.ones((*depth.shape, 3), np.float32)
    camera = looking((0.2, 0.1, -0.5), (3, 0, -0.5))
    view = method(
        panorama_of(Layer("floor", "equirectangular", {"depth": depth, "radiance": colours})), camera
    )
    truth = -1.0 / np.minimum(camera.directions()[..., 2], -1e-9)
    seen = truth < 100
    assert not view.holes[seen].any()
    near = truth < 10
    np.testing.assert_allclose(view.depth[near], truth[near], rtol=0.03)


@both_methods
@both_mappings
@pytest.mark.parametrize(
    ("eye", "look_at"),
    [
        ((1.5, 0.1, 0), (0, 0, 0)),
        ((1.0, 0, 0), (2, 0.1, 0)),
        ((2.0, 0.5, 0.5), (0, 0, 0.1)),
        ((4, 1, 1), (0, 0, 0)),
    ],
    ids=["behind the card", "in the card", "in a wall", "outside"],
)
def test_from_where_no_camera_should_be(rooms, method, mapping, eye, look_at):
    """Surfaces have two sides, and where the eye cuts them the rest is still right."""
    camera = looking(eye, look_at, size=(120, 80))
    view = method(rooms[mapping], camera)
    assert np.isfinite(view.radiance).all()
    assert not view.holes.any()
    assert (view.depth > 0).all()
    if eye == (1.5, 0.1, 0):
        colours, _, on_card = true_view(camera)
        assert np.abs(view.radiance - colours)[away_from_edges(on_card, 4)].max() < 0.05


@both_methods
def test_where_no_layer_is_there_are_only_holes(rooms, method):
    view = method(rooms["cube map"], looking((4, 0, 0), (8, 0, 0), size=(30, 20)))
    assert view.holes.all()
    assert not view.radiance.any()


@both_methods
def test_bands_do_not_show(rooms, method, monkeypatch):
    camera = looking(EYES["left"])
    whole = method(rooms["equirectangular"], camera)
    monkeypatch.setattr(point_canvas, "_PIXELS", 60 * camera.width)
    in_bands = method(rooms["equirectangular"], camera)
    np.testing.assert_allclose(in_bands.radiance, whole.radiance, atol=1e-4)
    np.testing.assert_allclose(in_bands.depth, whole.depth, rtol=1e-5)


@both_methods
def test_what_cannot_be_seen_is_refused(method):
    blind = Layer("blind", "cube map", {"depth": np.ones((4, 6), np.float32)})
    with pytest.raises(ValueError, match="layer 'blind' has no radiance"):
        method(panorama_of(blind), looking((0, 0, 0)))


def test_the_pattern_tells_card_from_room():
    assert np.abs(pattern(np.full(3, 0.3)) - pattern(np.full(3, 0.3), card=True)).max() > 0.1
