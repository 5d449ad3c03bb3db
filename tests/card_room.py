"""Layers of a box room with a card in it, whose views from anywhere are known: both wear a smooth pattern."""

import numpy as np
from box_layers import HALF, directions

from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama

CARD_X, CARD_Y, CARD_Z = 1.0, (-0.6, 0.35), (-0.5, 0.4)
"""The card stands upright before the origin, which sees all of its front [m]."""


def pattern(points, card=False):
    """Colours (..., 3), the card's the complement of the room's."""
    colours = 0.5 + 0.45 * np.sin(3 * points + np.arange(3)) * np.cos(2 * points[..., [1, 2, 0]])
    return (1 - colours if card else colours).astype(np.float32)


def cast(eye, rays):
    """Distances [m] from an eye in the room along unit rays (..., 3) to walls and to the card, or inf."""
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.min((np.sign(rays) * HALF - eye) / rays, axis=-1)
        card = (CARD_X - eye[0]) / rays[..., 0]
        y, z = (eye[k] + card * rays[..., k] for k in (1, 2))
        on_card = (card > 0) & (y > CARD_Y[0]) & (y < CARD_Y[1]) & (z > CARD_Z[0]) & (z < CARD_Z[1])
    return room, np.where(on_card, card, np.inf)


def room_layer(mapping, width):
    rays = directions(mapping, width)
    depth, _ = cast(np.zeros(3), rays)
    return Layer(
        "room", mapping, {"depth": depth.astype(np.float32), "radiance": pattern(depth[..., None] * rays)}
    )


def card_layer(mapping, width):
    rays = directions(mapping, width)
    _, depth = cast(np.zeros(3), rays)
    depth = np.where(np.isfinite(depth), depth, np.nan)
    colours = pattern(np.nan_to_num(depth)[..., None] * rays, card=True)
    return Layer("card", mapping, {"depth": depth.astype(np.float32), "radiance": colours})


def panorama_of(*layers, world_from_panorama=None, origin=(0, 0, 0)):
    turned = np.eye(3) if world_from_panorama is None else world_from_panorama
    return LayeredPanorama(layers, turned, np.array(origin, dtype=float), 0.5)


def true_view(camera):
    """Colours (H, W, 3) at the pixels' centres, distances (H, W) [m], and where (H, W) the card is seen."""
    rays = camera.directions()
    room, card = cast(camera.eye, rays)
    distance = np.minimum(room, card)
    points = camera.eye + distance[..., None] * rays
    on_card = card < room
    return np.where(on_card[..., None], pattern(points, card=True), pattern(points)), distance, on_card
