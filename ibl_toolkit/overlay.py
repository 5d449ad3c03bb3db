"""Lines of the world drawn over its panorama: the rebuilt pieces, the horizon and the axes' planes (Fig.
5-3).

A straight line of the world is a curve of the panorama, so every segment is drawn in steps that are short as
seen from the origin; curves that cross the seam go on at the other side.
"""

from __future__ import annotations

import cv2
import numpy as np

from .equirectangular import pixel_from_uv, sample, uv_from_direction

STEP_DEG = 0.5
"""Longest step of a drawn curve, as seen from the panorama's origin."""
BEHIND = 1.02
"""A point this many times as far as the depth map says is hidden."""
SUBPIXEL_BITS = 4
ROLE_COLOURS = {"SUPPORT": (255, 176, 32), "ENVIRONMENT": (64, 200, 255)}
LAMP_COLOUR = (255, 60, 200)
HORIZON_COLOUR, XZ_COLOUR, YZ_COLOUR = (90, 130, 255), (255, 90, 90), (100, 220, 110)
"""Planes xy (the horizon), xz and yz, as in Fig. 5-3; sRGB."""


def draw_pieces(picture, pieces, world_from_panorama, camera_height, depth=None, thickness=2):
    """Draw the edges of rebuilt pieces, coloured by role, on an sRGB picture (H, W, 3) uint8, in place.

    ``depth`` (h, w) [m]: what lies behind it is left out.
    """
    for piece in pieces:
        points = (piece.mesh.world_vertices - (0, 0, camera_height)) @ world_from_panorama
        for first, second in sorted(_edges(piece.mesh.faces)):
            draw_segment(picture, points[first], points[second], ROLE_COLOURS[piece.role], thickness, depth)


def draw_lamps(picture, lamps, thickness=2):
    """Draw the outlines of `light.lamps.Lamp`s."""
    for lamp in lamps:
        for outline in lamp.outlines:
            for first, second in zip(outline, np.roll(outline, -1, axis=0), strict=True):
                draw_segment(picture, first, second, LAMP_COLOUR, thickness)


def draw_axis_planes(picture, world_from_panorama, thickness=1):
    """Draw where the planes xy (the horizon, blue), xz (red) and yz (green) cut the picture."""
    turns = np.linspace(0, 2 * np.pi, int(360 / STEP_DEG) + 1)[:, None]
    axes = np.eye(3)
    for (a, b), colour in (((1, 2), YZ_COLOUR), ((0, 2), XZ_COLOUR), ((0, 1), HORIZON_COLOUR)):
        circle = np.cos(turns) * axes[a] + np.sin(turns) * axes[b]
        draw_curve(picture, circle @ world_from_panorama, colour, thickness)


def draw_segment(picture, first, second, colour, thickness=2, depth=None):
    """Draw the straight line between two points (3,) of the panorama frame [m]; neither may be the origin."""
    for run in _visible_runs(segment_points(first, second), depth):
        draw_curve(picture, run, colour, thickness)


def draw_curve(picture, points, colour, thickness):
    """Draw a curve through points (n, 3) of the panorama frame that are close together in the picture."""
    height, width = picture.shape[:2]
    pixels = pixel_from_uv(unwrapped(uv_from_direction(points)), width, height)
    shifts = range(int(np.floor(pixels[:, 0].min() / width)), int(np.floor(pixels[:, 0].max() / width)) + 1)
    for shift in shifts:
        fixed = np.round((pixels - (shift * width, 0)) * 2**SUBPIXEL_BITS).astype(np.int32)
        cv2.polylines(picture, [fixed[:, None]], False, colour, thickness, cv2.LINE_AA, SUBPIXEL_BITS)


def unwrapped(uv):
    """Image points (n, 2) of a curve with u made continuous across the seam, so beyond [0, 1) where it
    crosses.

    >>> unwrapped(np.array([[0.9, 0.5], [0.99, 0.5], [0.05, 0.5]]))[:, 0].round(2).tolist()
    [0.9, 0.99, 1.05]
    """
    return np.column_stack([np.unwrap(uv[:, 0], period=1.0), uv[:, 1]])


def segment_points(first, second):
    """Points (n, 3) on a segment between two (3,), in even steps of at most STEP_DEG seen from the origin.

    Neither may be the origin.
    """
    first, second = np.asarray(first, float), np.asarray(second, float)
    near, far = np.linalg.norm(first), np.linalg.norm(second)
    angle = np.arccos(np.clip(first @ second / (near * far), -1, 1))
    steps = max(int(np.ceil(np.degrees(angle) / STEP_DEG)), 1)
    if np.sin(angle) < 1e-9:
        share = np.linspace(0, 1, steps + 1)
    else:
        part = np.linspace(0, angle, steps + 1)
        share = near * np.sin(part) / (near * np.sin(part) + far * np.sin(angle - part))
    return first + share[:, None] * (second - first)


def _visible_runs(points, depth):
    """The stretches of a line that nothing in the depth map hides."""
    if depth is None:
        return [points]
    visible = np.linalg.norm(points, axis=1) < BEHIND * _farthest_around(depth, points)
    breaks = np.flatnonzero(np.diff(visible.astype(int))) + 1
    return [
        run for run, seen in zip(np.split(points, breaks), np.split(visible, breaks), strict=True) if seen[0]
    ]


def _farthest_around(depth, points):
    """The depth at directions (n, 3), the farthest of 3 × 3 pixels: an edge is its visible face's."""
    padded = np.pad(depth, ((1, 1), (1, 1)), mode="wrap")
    farthest = cv2.dilate(padded, np.ones((3, 3), np.uint8))[1:-1, 1:-1]
    return sample(farthest, points)


def _edges(faces):
    """Each edge of polygons once, as a pair of vertex indices."""
    return {tuple(sorted(pair)) for face in faces for pair in zip(face, (*face[1:], face[0]), strict=True)}
