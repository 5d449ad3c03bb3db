"""The pictures on the walls, painted by formula: (H, W, 3) linear colours, top row first."""

from __future__ import annotations

import numpy as np

PIXELS_PER_METRE = 240
"""As fine as a panorama of 6k sees a wall 4 m away."""
PAPER = (0.80, 0.74, 0.62)


def canvas(size):
    """x from the left and y from below [m] of the pixels' centres, (H, W) each, for a picture (w, h) [m]."""
    width, height = (round(length * PIXELS_PER_METRE) for length in size)
    x = (np.arange(width) + 0.5) / width * size[0]
    y = (np.arange(height)[::-1] + 0.5) / height * size[1]
    return np.meshgrid(x.astype(np.float32), y.astype(np.float32))


def hills(size, start):
    """A third of a landscape: ridges in the mist under a sun; ``start`` is its left edge in the whole [m]."""
    x, y = canvas(size)
    x = x + start
    picture = _fade(y / size[1], (0.85, 0.46, 0.25), (0.62, 0.68, 0.70))
    _lay(picture, (0.86, 0.16, 0.05), _inside(0.17 - np.hypot(x - 0.93, y - 0.62)))
    shades = ((0.44, 0.40, 0.42), (0.26, 0.29, 0.34), (0.12, 0.19, 0.23), (0.03, 0.075, 0.09))
    for number, shade in enumerate(shades):
        ridge = 0.50 - 0.13 * number + 0.085 * np.sin(4.1 * x + 2.3 * number)
        ridge += 0.03 * np.sin(11.3 * x + number)
        _lay(picture, shade, _inside(ridge - y))
    return picture


def circle(size):
    """One stroke of a broad brush, round and not quite closed."""
    x, y = canvas(size)
    picture = _plain(x, PAPER)
    dx, dy = x - size[0] / 2, y - size[1] / 2
    angle = (np.arctan2(dy, dx) + 2.2) % (2 * np.pi) / (2 * np.pi)
    width = 0.055 * (1 - 0.72 * angle) + 0.006 * np.sin(37 * angle)
    stroke = _inside(width - np.abs(np.hypot(dx, dy) - 0.34 - 0.02 * angle))
    _lay(picture, (0.012, 0.011, 0.014), stroke * (angle < 0.955))
    _lay(picture, (0.55, 0.04, 0.025), _inside(0.035 - np.maximum(np.abs(dx - 0.38), np.abs(dy + 0.40))))
    return picture


def fields(size):
    """Fields of colour between black bars."""
    x, y = canvas(size)
    picture = _plain(x, (0.82, 0.79, 0.72))
    for left, right, low, high, shade in (
        (0.00, 0.33, 0.45, 1.00, (0.60, 0.045, 0.03)),
        (0.33, 0.72, 0.72, 1.00, (0.80, 0.50, 0.045)),
        (0.72, 1.00, 0.00, 0.30, (0.03, 0.10, 0.32)),
        (0.00, 0.33, 0.00, 0.20, (0.05, 0.05, 0.055)),
        (0.33, 0.72, 0.00, 0.30, (0.62, 0.60, 0.55)),
    ):
        _lay(picture, shade, _between(x / size[0], left, right) * _between(y / size[1], low, high))
    bars = [np.abs(x - share * size[0]) for share in (0.33, 0.72)]
    bars += [
        np.abs(y - share * size[1]) + 9 * _outside(x / size[0], *span)
        for share, span in ((0.45, (0, 0.33)), (0.20, (0, 0.33)), (0.72, (0.33, 1)), (0.30, (0.33, 1)))
    ]
    _lay(picture, (0.015, 0.015, 0.017), _inside(0.016 - np.minimum.reduce(bars)))
    return picture


def waves(size):
    """Scales of water, row over row, under a pale moon."""
    x, y = canvas(size)
    picture = _fade(y / size[1], (0.09, 0.24, 0.33), (0.70, 0.70, 0.62))
    _lay(picture, (0.90, 0.86, 0.74), _inside(0.12 - np.hypot(x - 1.08, y - 0.72)))
    for row in range(7, -1, -1):
        across = (x + 0.11 * (row % 2)) % 0.22 - 0.11
        radius = np.hypot(across, y - (0.075 * row - 0.06))
        _lay(picture, (0.015 + 0.006 * row, 0.07 + 0.016 * row, 0.15 + 0.02 * row), _inside(0.125 - radius))
        for ring in (0.115, 0.085, 0.055):
            _lay(picture, (0.62, 0.68, 0.66), 0.85 * _inside(0.006 - np.abs(radius - ring)))
    return picture


def still_life(size):
    """Three vessels on a table: hangs where the mirror is when all is matte."""
    x, y = canvas(size)
    picture = _fade(y / size[1], (0.30, 0.24, 0.19), (0.16, 0.20, 0.19))
    _lay(picture, (0.36, 0.18, 0.085), _inside(0.36 - y))
    for middle, base, radius, neck, shade in (
        (0.42, 0.26, 0.20, 0.42, (0.10, 0.23, 0.30)),
        (0.80, 0.20, 0.15, 0.62, (0.62, 0.56, 0.45)),
        (1.10, 0.24, 0.13, 0.24, (0.55, 0.17, 0.05)),
    ):
        belly = np.hypot((x - middle) / radius, (y - base - radius) / radius)
        side = np.clip((x - middle) / radius, -1, 1)
        tone = np.float32(shade) * (1.15 - 0.65 * side[..., None] ** 2 - 0.35 * side[..., None])
        _lay(picture, tone, _inside(radius * (1 - belly)))
        upright = np.maximum(np.abs(x - middle) - 0.28 * radius, np.abs(y - base - neck * 0.75) - neck / 2.6)
        _lay(picture, tone, _inside(-upright) * (y > base + radius))
    return picture


def lattice(size, cell=(0.3, 0.39), bar=0.034):
    """Where the bars of a paper screen are, (H, W, 1): 1 on a bar."""
    x, y = canvas(size)
    distances = [
        np.abs((value + period / 2) % period - period / 2) for value, period in zip((x, y), cell, strict=True)
    ]
    thick = np.abs((x + 0.6) % 1.2 - 0.6) - bar  # the leaves' own frames
    return _inside(bar / 2 - np.minimum(np.minimum(*distances), thick))[..., None]


def circles(size, spacing=0.58):
    """A wall of rings within rings, tone on tone."""
    x, y = canvas(size)
    row = np.floor(y / spacing)
    dx = (x + 0.5 * spacing * (row % 2)) % spacing - spacing / 2
    radius = np.hypot(dx, y % spacing - spacing / 2)
    picture = _plain(x, (0.125, 0.185, 0.185))
    for middle, half in ((0.245, 0.012), (0.17, 0.02), (0.07, 0.03)):
        _lay(picture, (0.20, 0.275, 0.265), _inside(half - np.abs(radius - middle)))
    return picture


def rug(size):
    """Borders round a field of lozenges."""
    x, y = canvas(size)
    dx, dy = np.abs(x - size[0] / 2), np.abs(y - size[1] / 2)
    edge = np.minimum(size[0] / 2 - dx, size[1] / 2 - dy)
    picture = _plain(x, (0.50, 0.43, 0.33))
    lozenge = np.abs((x + y) % 0.36 - 0.18) + np.abs((x - y) % 0.36 - 0.18)
    _lay(picture, (0.30, 0.075, 0.055), _inside(0.11 - lozenge))
    _lay(picture, (0.60, 0.53, 0.41), _inside(0.045 - lozenge))
    _lay(picture, (0.055, 0.105, 0.14), _inside(0.21 - edge))
    for middle in (0.06, 0.15):
        _lay(picture, (0.58, 0.46, 0.26), _inside(0.014 - np.abs(edge - middle)))
    return picture


def _plain(like, shade):
    return np.broadcast_to(np.asarray(shade, dtype=np.float32), (*like.shape, 3)).copy()


def _fade(share, low, high):
    share = np.clip(share, 0, 1)[..., None]
    return (1 - share) * np.float32(low) + share * np.float32(high)


def _lay(picture, shade, cover):
    """Paint a shade over a picture, in place, as much as ``cover`` (H, W) says."""
    picture += cover[..., None] * (np.asarray(shade, dtype=np.float32) - picture)


def _inside(distance):
    """1 where a distance inwards [m] is above 0, with an edge one pixel soft."""
    return np.clip(distance * PIXELS_PER_METRE + 0.5, 0, 1)


def _between(share, low, high):
    return ((share >= low) & (share < high)).astype(np.float32)


def _outside(share, low, high):
    return 1 - _between(share, low, high)
