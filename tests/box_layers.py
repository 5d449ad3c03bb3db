"""Layers of a box room, whose surface is known, and what a sound mesh is."""

import numpy as np

from expanded_panoramas.ibl_toolkit import cube_map, equirectangular
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer

HALF = np.array([2.0, 3.0, 1.5])
"""From the origin to the walls [m]."""
BOTH = ("equirectangular", "cube map")


def directions(mapping, width):
    if mapping == "cube map":
        return cube_map.pixel_directions(width // 3).astype(float)
    return equirectangular.pixel_directions(width, width // 2).astype(float)


def box_depth(mapping, width):
    with np.errstate(divide="ignore"):
        return np.min(HALF / np.abs(directions(mapping, width)), axis=2).astype(np.float32)


def layer_of(mapping, depth, inside=None):
    """A layer of a depth map (H, W), its domain the whole map or ``inside`` (H, W)."""
    return Layer("room", mapping, {"depth": depth} if inside is None else {"depth": depth, "mask": inside})


def box_layer(mapping, width, inside=None):
    return layer_of(mapping, box_depth(mapping, width), inside)


def off_the_walls(points):
    """How far (n,) points are off the room's walls along their rays, in units of their depth."""
    return np.abs(np.max(np.abs(points) / HALF, axis=1) - 1)


def edge_counts(triangles):
    """Edges (n, 2), lower corner first, and how many triangles run along them forwards and backwards."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    forwards = edges[:, 0] < edges[:, 1]
    unique, which = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    which = which.reshape(-1)
    counts = [np.bincount(which[way], minlength=len(unique)) for way in (forwards, ~forwards)]
    return unique, *counts


def is_closed(mesh):
    """Each edge has two triangles, which run along it in opposite ways: so there is no T-junction either."""
    _, forwards, backwards = edge_counts(mesh.triangles)
    return (forwards == 1).all() and (backwards == 1).all()


def faces_the_origin(mesh):
    a, b, c = mesh.points[mesh.triangles.T]
    return (np.einsum("nk,nk->n", np.cross(b - a, c - a), a + b + c) < 0).all()


def rim(mesh):
    """Edges of one triangle only, as (n, 2) corner numbers."""
    edges, forwards, backwards = edge_counts(mesh.triangles)
    return np.sort(mesh.vertices[edges[forwards + backwards == 1]], axis=1)


def rim_of_pixels(corners, inside):
    """Sides of pixels between the domain and the rest, as (n, 2) corner numbers; ``inside`` in sheets."""
    numbers = corners.known_as(np.arange(np.prod(corners.shape))).reshape(corners.shape)
    a, b, c, d = numbers[:, :-1, :-1], numbers[:, 1:, :-1], numbers[:, 1:, 1:], numbers[:, :-1, 1:]
    sides = [np.stack([one[inside], two[inside]], axis=1) for one, two in ((a, b), (b, c), (c, d), (d, a))]
    sides = np.sort(np.concatenate(sides), axis=1)
    sides, counts = np.unique(sides[sides[:, 0] != sides[:, 1]], axis=0, return_counts=True)
    return sides[counts == 1]
