"""The edges of a scene's built shapes as the panorama sees them, for an overlay on the flat image."""

import numpy as np

from ...cycles_integration.pieces import built_pieces
from ...ibl_toolkit.stand import Stand
from ..canvas import calibration_of

MOST_UPRIGHTS = 8
"""Of a round shape's upright edges, so many are drawn."""
UPRIGHT = 1e-4
"""Largest horizontal extent of an upright edge, in a shape's own size."""


def built_lines(scene) -> dict[str, np.ndarray]:
    """Edges (n, 2, 3) of the built shapes in the panorama frame [m], by role."""
    stand = Stand(*calibration_of(scene))
    found = {}
    for thing in built_pieces(scene.panorama_place):
        if thing.visible_get():
            found.setdefault(thing.panorama_role, []).append(stand.from_origin(_edges(thing)))
    return {role: np.concatenate(edges) for role, edges in found.items()}


def _edges(thing):
    """An object's edges (n, 2, 3) in the world [m]."""
    mesh = thing.data
    vertices, pairs = np.empty(3 * len(mesh.vertices)), np.empty(2 * len(mesh.edges), np.int32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.edges.foreach_get("vertices", pairs)
    ends = vertices.reshape(-1, 3)[pairs.reshape(-1, 2)]
    upright = np.abs(np.diff(ends[..., :2], axis=1)).max(axis=(1, 2), initial=0) < UPRIGHT
    uprights = ends[upright]
    every = max(len(uprights) // MOST_UPRIGHTS, 1) if len(uprights) > 3 * MOST_UPRIGHTS else 1
    kept = np.concatenate([ends[~upright], uprights[::every]])
    matrix = np.array(thing.matrix_world)
    return kept @ matrix[:3, :3].T + matrix[:3, 3]
