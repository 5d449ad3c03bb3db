"""Boxes and balls on a floor, as triangles and as what rays can be traced against: shadows of known truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
_LIFT = 1e-6  # of a ray's start off the surface [m]


@dataclass(frozen=True)
class Box:
    """Axes along the world's; low and high corners [m]."""

    low: tuple
    high: tuple

    def mesh(self):
        points = np.array([[(self.low, self.high)[c >> k & 1][k] for k in (2, 1, 0)][::-1] for c in range(8)])
        return points, np.array([[f[0], f[k], f[k + 1]] for f in _FACES for k in (1, 2)])

    def blocks(self, origins, directions, reach):
        """Slabs: (n,) of rays (n, 3)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / directions
            ends = np.stack([(np.array(c) - origins) * inverse for c in (self.low, self.high)])
        entry, leave = np.nanmax(ends.min(axis=0), axis=1), np.nanmin(ends.max(axis=0), axis=1)
        return (np.maximum(entry, 0) < np.minimum(leave, reach)) & (leave > 0)


@dataclass(frozen=True)
class Ball:
    """Centre and radius [m], and into how many rings its mesh is cut."""

    centre: tuple
    radius: float
    rings: int = 96

    def mesh(self):
        n, m = self.rings, 2 * self.rings
        polar, round_ = np.meshgrid(np.linspace(0, np.pi, n + 1), 2 * np.pi * np.arange(m) / m, indexing="ij")
        unit = np.stack([np.sin(polar) * np.cos(round_), np.sin(polar) * np.sin(round_), np.cos(polar)], -1)
        i, j = (v.ravel() for v in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
        a, b = i * m + j, i * m + (j + 1) % m
        triangles = np.concatenate([np.stack([a, a + m, b + m], 1), np.stack([a, b + m, b], 1)])
        return np.array(self.centre) + self.radius * unit.reshape(-1, 3), triangles

    def blocks(self, origins, directions, reach):
        away = origins - np.array(self.centre)
        half = (away * directions).sum(axis=1)
        under = half**2 - (away**2).sum(axis=1) + self.radius**2
        root = np.sqrt(np.maximum(under, 0))
        return (under > 0) & (root - half > 0) & (-half - root < reach) & (-half - root > 0)


@dataclass(frozen=True)
class Scene:
    """Solids over a square floor at z = 0, ``half`` m to each side."""

    solids: tuple
    half: float = 2.0

    def mesh(self):
        """points (V, 3), triangles (T, 3), the floor's two first."""
        h = self.half
        points, triangles = (
            [np.array([[-h, -h, 0], [h, -h, 0], [h, h, 0], [-h, h, 0.0]])],
            [[[0, 1, 2], [0, 2, 3]]],
        )
        count = 4
        for solid in self.solids:
            more, of = solid.mesh()
            points.append(more)
            triangles.append(of + count)
            count += len(more)
        return np.concatenate(points), np.concatenate(triangles)

    def floor(self, count, half=None):
        """Places (count², 3) on the floor, row by row; (count², 3) normals."""
        side = (half or self.half) * ((np.arange(count) + 0.5) / count * 2 - 1)
        x, y = np.meshgrid(side, side)
        points = np.stack([x.ravel(), y.ravel(), np.zeros(count**2)], axis=1)
        return points, np.broadcast_to((0.0, 0, 1), points.shape)

    def lit(self, points, normals, lamp):
        """The part of a lamp, unblocked, that points (n, 3) see: (n,). lamp: a Lamp or Sun."""
        seen = np.zeros(len(points))
        samples = lamp.samples()
        for sample in samples:
            directions, reach = lamp.towards(points, sample)
            open_ = (directions * normals).sum(axis=1) > 0
            origins = points + _LIFT * normals
            for solid in self.solids:
                at = np.flatnonzero(open_)
                open_[at] = ~solid.blocks(origins[at], directions[at], reach[at])
            seen += open_
        return seen / len(samples)


@dataclass(frozen=True)
class Sun:
    """A disc in the sky: direction to its middle, and its angular diameter. 1 sample: a point."""

    direction: tuple
    diameter_deg: float = 0.0
    count: int = 1

    def samples(self):
        return np.tan(np.radians(self.diameter_deg / 2)) * disc(self.count)

    def towards(self, points, sample):
        middle, right, up = around(self.direction)
        ray = middle + sample[0] * right + sample[1] * up
        ray = ray / np.linalg.norm(ray)
        return np.broadcast_to(ray, points.shape), np.full(len(points), np.inf)


@dataclass(frozen=True)
class Lamp:
    """A disc of a diameter [m] at a place [m] that faces the origin."""

    position: tuple
    diameter: float = 0.0
    count: int = 1

    def samples(self):
        return self.diameter / 2 * disc(self.count)

    def towards(self, points, sample):
        _, right, up = around(self.position)
        away = np.array(self.position) + sample[0] * right + sample[1] * up - points
        reach = np.linalg.norm(away, axis=1)
        return away / reach[:, None], reach


def around(direction):
    """A unit vector along ``direction``, and two across it."""
    middle = np.array(direction, float) / np.linalg.norm(direction)
    right = np.cross(middle, (0, 0, 1.0) if abs(middle[2]) < 0.9 else (0, 1.0, 0))
    right /= np.linalg.norm(right)
    return middle, right, np.cross(right, middle)


def disc(count):
    """Places (count, 2) spread evenly over the unit disc (Vogel's spiral); one is its middle."""
    if count == 1:
        return np.zeros((1, 2))
    number = np.arange(count)
    radius, angle = np.sqrt((number + 0.5) / count), number * np.pi * (3 - np.sqrt(5))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
