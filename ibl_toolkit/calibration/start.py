"""Start values for the orientation: eq. 5.2 per rectangle, vanishing points of lines, and which way is up."""

from dataclasses import dataclass

import numpy as np

from .conditions import anchor_quad
from .directions import (
    angle_between,
    minimal_rotation,
    reverse_depth,
    side_directions,
    vanishing_direction,
)
from .picks import CalibrationError

# Perspective tells near from far by the square of a figure's extent: (30°)² is 15°, more than any click errs.
REVERSIBLE_SPAN = np.radians(30.0)
PARALLEL = 1e-6  # a cross product of unit vectors below this says nothing about the vertical


@dataclass(frozen=True)
class Start:
    """world_from_panorama (3, 3), azimuths (families,), and each rectangle's upright pair or None."""

    world_from_panorama: np.ndarray
    azimuths: np.ndarray
    upright_pairs: tuple[int | None, ...]


def start_values(clicks):
    """Candidates for the start one by one, the most trustworthy kind first.

    Raises: CalibrationError if the picks leave the vertical undetermined, saying what would add it.
    """
    floor, ceiling = (clicks.directions[k].sum(0) for k in (clicks.floor_clicks(), clicks.ceiling_clicks()))
    corners = clicks.directions[np.array([quad.clicks for quad in clicks.quads], dtype=int).reshape(-1, 4)]
    sides = side_directions(corners)
    views = [(sides, _verticals(clicks, sides))]
    # A small figure looks the same with near and far exchanged, so its start may fall on the wrong side.
    for number in np.flatnonzero(_spans(corners) < REVERSIBLE_SPAN):
        reversed_sides = sides.copy()
        reversed_sides[number] = reverse_depth(sides[number], corners[number])
        views.append((reversed_sides, _rectangle_verticals(clicks.quads[number], reversed_sides[number])))
    none = True
    for these_sides, verticals in views:
        for up in verticals:
            if np.linalg.norm(up) > PARALLEL:
                none = False
                up = up / np.linalg.norm(up)
                yield _complete(clicks, these_sides, up * _sign(up, ceiling - floor))
    if none:
        raise CalibrationError(_missing(clicks))


def _spans(corners):
    """The longer diagonal [rad] of each figure (q, 4, 3) as the camera sees it."""
    return np.maximum(
        angle_between(corners[:, 0], corners[:, 2]), angle_between(corners[:, 1], corners[:, 3])
    )


def _sign(up, up_votes):
    """+1 or −1: floor below and ceiling above the horizon; without either the panorama's own top is up."""
    vote = np.dot(up, up_votes) if np.any(up_votes) else up[2]
    return 1.0 if vote >= 0.0 else -1.0


def _verticals(clicks, sides):
    """Candidates for the vertical (3,), of either sign: level rectangles, then lines, then walls."""
    for wall in (False, True):
        for quad, pair in zip(clicks.quads, sides, strict=True):
            if (quad.plane == "WALL") == wall:
                yield from _rectangle_verticals(quad, pair)
        if not wall:
            normals = {axis: _line_normals(clicks, axis) for axis in "XYZ"}
            if len(normals["Z"]) >= 2:
                yield vanishing_direction(normals["Z"])
            yield from _from_parallels(normals)


def _rectangle_verticals(quad, sides):
    """The normal of a level rectangle, either side of a wall."""
    return sides if quad.plane == "WALL" else [np.cross(*sides)]


def _from_parallels(normals):
    """The vertical from lines along X and Y, or along one of them and a single vertical."""
    for one, other in (("X", "Y"), ("Y", "X")):
        if len(normals[one]) < 2:
            continue
        along = vanishing_direction(normals[one])
        if len(normals[other]) >= 2:
            yield np.cross(along, vanishing_direction(normals[other]))
        elif len(normals[other]) == 1:
            yield np.cross(along, np.cross(along, normals[other][0]))
        elif len(normals["Z"]):
            yield np.cross(along, normals["Z"][0])


def _line_normals(clicks, axis):
    """Unit normals (k, 3) of the planes through the camera and each line along an axis."""
    pairs = np.array([line.clicks for line in clicks.lines if line.axis == axis], dtype=int).reshape(-1, 2)
    normals = np.cross(clicks.directions[pairs[:, 0]], clicks.directions[pairs[:, 1]])
    return normals / np.linalg.norm(normals, axis=1)[:, None]


def _missing(clicks):
    count = {axis: sum(line.axis == axis for line in clicks.lines) for axis in "XYZ"}
    if count["Z"] == 1 and not (count["X"] or count["Y"]):
        return "a single vertical leaves the tilt open; add one in another direction, or a rectangle"
    if count["X"] or count["Y"]:
        return (
            f"{count['X']} parallels along X, {count['Y']} along Y and {count['Z']} verticals leave the tilt "
            f"open; add two lines along the other axis, or verticals, or a rectangle"
        )
    return "no picks: orientation needs a rectangle, parallels along X and Y, or two verticals"


def _complete(clicks, sides, up):
    """Azimuths and the walls' upright sides for a given vertical."""
    rotation = minimal_rotation(up)
    pairs, azimuths = [], []
    for quad, (first, second) in zip(clicks.quads, sides, strict=True):
        pair = None
        if quad.plane == "WALL":
            pair = 0 if abs(np.dot(first, up)) > abs(np.dot(second, up)) else 1
        pairs.append(pair)
        azimuths.append(_azimuth(rotation @ (second if pair == 0 else first)))
    anchor = anchor_quad(clicks)
    azimuth = azimuths[anchor] if anchor is not None else _azimuth_of_parallels(clicks, rotation)
    cosine, sine = np.cos(azimuth), np.sin(azimuth)
    spin = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    further = [other - azimuth for number, other in enumerate(azimuths) if number != anchor]
    return Start(spin @ rotation, np.array([0.0, *further]), tuple(pairs))


def _azimuth(direction):
    return float(np.arctan2(direction[1], direction[0]))


def _azimuth_of_parallels(clicks, level_from_panorama):
    """Azimuth of the +x that lines along X and Y agree on, as the first was clicked; 0 without lines."""
    lines = sorted((line for line in clicks.lines if line.axis != "Z"), key=lambda line: line.axis)
    if not lines:
        return 0.0
    normals, runs = [], []
    for line in lines:
        a, b = clicks.directions[list(line.clicks)] @ level_from_panorama.T
        normal = np.cross(a, b)[:2] / np.linalg.norm(np.cross(a, b))
        run = b[:2] / max(-b[2], 1e-9) - a[:2] / max(-a[2], 1e-9)  # on the floor
        if line.axis == "Y":  # a quarter turn to the right makes it a line along X
            normal, run = np.array([normal[1], -normal[0]]), np.array([run[1], -run[0]])
        normals.append(normal)
        runs.append(run)
    along = vanishing_direction(np.array(normals))
    return _azimuth(along if np.dot(along, runs[0]) >= 0.0 else -along)
