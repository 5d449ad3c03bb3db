"""The picks as conditions: each side or line seen in the image runs along a known direction of the world.

A line of the world and the camera span a plane; the line's direction lies in it. For two clicks d1, d2 of
a line along e: (d1 × d2) · (R' e) = 0, with R = world_from_panorama. Two pairs of sides along two
perpendicular directions are all that makes a quadrilateral a rectangle. Source: thesis eq. 5.2 (the same
planes, intersected pair by pair).
"""

from dataclasses import dataclass

import numpy as np

VERTICAL = -1


@dataclass(frozen=True)
class Conditions:
    """m conditions on pairs of clicks.

    first, second (m,): clicks. family (m,): VERTICAL, or which azimuth the direction is measured from; family
    0 is the world's +x. turned (m,): True for a direction 90° left of its family's. owner (m,): the name
    of the rectangle or line. families: how many azimuths there are (0 if nothing but verticals).
    """

    first: np.ndarray
    second: np.ndarray
    family: np.ndarray
    turned: np.ndarray
    owner: tuple[str, ...]
    families: int

    def directions(self, azimuths):
        """World directions (m, 3) of the lines, and their derivatives (m, 3) by their family's azimuth."""
        angle = np.where(self.turned, np.pi / 2.0, 0.0)
        if self.families:
            angle = angle + np.asarray(azimuths)[np.maximum(self.family, 0)]
        level = (self.family != VERTICAL).astype(float)
        cosine, sine, zero = np.cos(angle) * level, np.sin(angle) * level, np.zeros_like(angle)
        return np.stack([cosine, sine, 1.0 - level], axis=-1), np.stack([-sine, cosine, zero], axis=-1)


def anchor_quad(clicks):
    """Index of the rectangle whose first side is the world's +x, or None if parallels or nothing decide it.

    The first floor rectangle; without one the parallels; without those the first ceiling rectangle, then the
    first wall rectangle (its first level side).
    """
    planes = [quad.plane for quad in clicks.quads]
    if "FLOOR" in planes:
        return planes.index("FLOOR")
    if any(line.axis != "Z" for line in clicks.lines):
        return None
    return next((planes.index(plane) for plane in ("CEILING", "WALL") if plane in planes), None)


def build_conditions(clicks, upright_pairs):
    """Conditions of all clicks. upright_pairs: per rectangle None, or for a WALL its vertical pair of sides.

    Pair 0 are the sides from click 1 to 2 and from 4 to 3, pair 1 those from 2 to 3 and from 1 to 4.
    """
    anchor = anchor_quad(clicks)
    families = int(anchor is not None or any(line.axis != "Z" for line in clicks.lines))
    rows = []
    for number, (quad, upright) in enumerate(zip(clicks.quads, upright_pairs, strict=True)):
        family = 0 if number == anchor else families
        families = max(families, family + 1)
        p0, p1, p2, p3 = quad.clicks
        for pair, sides in enumerate([((p0, p1), (p3, p2)), ((p1, p2), (p0, p3))]):
            along = VERTICAL if upright == pair else family
            turned = upright is None and pair == 1
            rows += [(*side, along, turned, quad.name) for side in sides]
    for line in clicks.lines:
        rows.append((*line.clicks, VERTICAL if line.axis == "Z" else 0, line.axis == "Y", line.name))
    first, second, family, turned, owner = zip(*rows, strict=True)
    columns = (np.array(column) for column in (first, second, family, turned))
    return Conditions(*columns, owner, families)
