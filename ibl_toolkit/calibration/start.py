"""Start values for the orientation: eq. 5.2 per rectangle, vanishing points of lines, and which way is up."""

from dataclasses import dataclass

import numpy as np

from .conditions import anchor_quad
from .picks import CalibrationError

PARALLEL = 1e-6  # cross products of unit vectors below this say nothing about the vertical


@dataclass(frozen=True)
class Start:
    """world_from_panorama (3, 3), azimuths (families,), and each rectangle's upright pair or None."""

    world_from_panorama: np.ndarray
    azimuths: np.ndarray
    upright_pairs: tuple[int | None, ...]


def side_directions(corners):
    """Unit directions (2, 3) of the sides 1→2 and 2→3 of a rectangle seen along corners (4, 3).

    Thesis eq. 5.2, x = (p0 × p1) × (p3 × p2) and y = (p1 × p2) × (p0 × p3), whose signs depend on the order
    of the clicks. The corners of a parallelogram are at depths λ with λ0 p0 − λ1 p1 + λ2 p2 − λ3 p3 = 0; its
    sides λ1 p1 − λ0 p0 and λ2 p2 − λ1 p1 are the same directions with the right sign.

    >>> import numpy as np
    >>> corners = np.array([[1, 1, -1], [3, 1, -1], [3, 2, -1], [1, 2, -1.0]])
    >>> (side_directions(corners / np.linalg.norm(corners, axis=1)[:, None]).round(9) + 0.0).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    """
    p0, p1, p2, p3 = corners
    depths = np.array(
        [np.dot(p, np.cross(q, r)) for p, q, r in ((p1, p2, p3), (p0, p2, p3), (p0, p1, p3), (p0, p1, p2))]
    )
    scaled = corners * (depths * np.sign(depths.sum()))[:, None]
    sides = np.array([scaled[1] - scaled[0], scaled[2] - scaled[1]])
    return sides / np.linalg.norm(sides, axis=1)[:, None]


def vanishing_direction(normals):
    """The unit direction (3,) nearest to all planes of normals (k, 3), k ≥ 2; its sign is free."""
    return np.linalg.eigh(normals.T @ normals)[1][:, 0]


def start_values(clicks):
    """Candidates for the start, the most trustworthy kind first.

    Raises: CalibrationError if the picks leave the vertical undetermined, saying what would add it.
    """
    floor, ceiling = (clicks.directions[k].sum(0) for k in (clicks.floor_clicks(), clicks.ceiling_clicks()))
    candidates = [_unit(up) for up in _vertical_candidates(clicks) if np.linalg.norm(up) > PARALLEL]
    if not candidates:
        raise CalibrationError(_missing(clicks))
    return [_complete(clicks, up * _sign(up, ceiling - floor)) for up in candidates]


def _sign(up, up_votes):
    """+1 or −1: floor below and ceiling above the horizon; without either the panorama's own top is up."""
    vote = np.dot(up, up_votes) if np.any(up_votes) else up[2]
    return 1.0 if vote >= 0.0 else -1.0


def _vertical_candidates(clicks):
    walls = []
    for quad in clicks.quads:
        sides = side_directions(clicks.directions[list(quad.clicks)])
        if quad.plane == "WALL":
            walls.append(sides[np.argsort(-np.abs(sides[:, 2]), kind="stable")])
        else:
            yield np.cross(*sides)
    normals = {axis: _line_normals(clicks, axis) for axis in "XYZ"}
    if len(normals["Z"]) >= 2:
        yield vanishing_direction(normals["Z"])
    yield from _from_parallels(normals)
    for likelier, _ in walls:
        yield likelier
    for _, other in walls:
        yield other


def _from_parallels(normals):
    """The vertical from lines along X and Y, or along one of them and a single vertical."""
    for one, other in (("X", "Y"), ("Y", "X")):
        if len(normals[one]) < 2:
            continue
        along = vanishing_direction(normals[one])
        if len(normals[other]):
            if len(normals[other]) >= 2:
                across = vanishing_direction(normals[other])
            else:
                across = np.cross(along, normals[other][0])
            yield np.cross(along, across)
        elif len(normals["Z"]):
            yield np.cross(along, normals["Z"][0])


def _line_normals(clicks, axis):
    pairs = np.array([line.clicks for line in clicks.lines if line.axis == axis], dtype=int).reshape(-1, 2)
    normals = np.cross(clicks.directions[pairs[:, 0]], clicks.directions[pairs[:, 1]])
    return normals / np.linalg.norm(normals, axis=1)[:, None]


def _unit(vector):
    return vector / np.linalg.norm(vector)


def _missing(clicks):
    count = {axis: sum(line.axis == axis for line in clicks.lines) for axis in "XYZ"}
    if count["Z"] == 1 and not (count["X"] or count["Y"]):
        return (
            "a single vertical does not fix the tilt; add a second one in another direction, or a rectangle"
        )
    if count["X"] or count["Y"]:
        return (
            f"{count['X']} parallels along X, {count['Y']} along Y and {count['Z']} verticals leave the tilt "
            f"open; add two lines along the other axis, or verticals, or a rectangle"
        )
    return "no picks: orientation needs a rectangle, parallels along X and Y, or two verticals"


def minimal_rotation(up):
    """The shortest rotation (3, 3) that takes the unit vector up (3,) to +z.

    >>> import numpy as np
    >>> minimal_rotation(np.array([0.0, 0.0, -1.0])).round(9).tolist()
    [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]
    """
    axis = np.array([up[1], -up[0], 0.0])
    sine = np.linalg.norm(axis)
    axis = axis / sine if sine > 1e-12 else np.array([1.0, 0.0, 0.0])
    skew = np.array([[0.0, 0.0, axis[1]], [0.0, 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.eye(3) + sine * skew + (1.0 - up[2]) * (skew @ skew)


def _complete(clicks, up):
    """Azimuths and the walls' upright sides for a given vertical."""
    rotation = minimal_rotation(up)
    pairs, level_sides = [], []
    for quad in clicks.quads:
        sides = side_directions(clicks.directions[list(quad.clicks)])
        pair = int(np.argmax(np.abs(sides @ up))) if quad.plane == "WALL" else None
        pairs.append(pair)
        level_sides.append(rotation @ sides[1 if pair == 0 else 0])
    anchor = anchor_quad(clicks)
    azimuth = _azimuth(level_sides[anchor]) if anchor is not None else _azimuth_of_parallels(clicks, rotation)
    spin = np.array(
        [[np.cos(azimuth), np.sin(azimuth), 0.0], [-np.sin(azimuth), np.cos(azimuth), 0.0], [0.0, 0.0, 1.0]]
    )
    further = [_azimuth(side) - azimuth for number, side in enumerate(level_sides) if number != anchor]
    return Start(spin @ rotation, np.array([0.0, *further]), tuple(pairs))


def _azimuth(direction):
    return float(np.arctan2(direction[1], direction[0]))


def _azimuth_of_parallels(clicks, level_from_panorama):
    """Azimuth of the world's +x that lines along X and Y agree on; 0 without lines."""
    cross, first = np.zeros((2, 2)), None
    for line in sorted((line for line in clicks.lines if line.axis != "Z"), key=lambda line: line.axis):
        a, b = (level_from_panorama @ clicks.directions[k] for k in line.clicks)
        normal = np.cross(a, b)[:2] / np.linalg.norm(np.cross(a, b))
        run = b[:2] / max(-b[2], 1e-9) - a[:2] / max(
            -a[2], 1e-9
        )  # from the first to the second point, on the floor
        if line.axis == "Y":  # a quarter turn right makes lines along Y lines along X
            normal, run = np.array([normal[1], -normal[0]]), np.array([run[1], -run[0]])
        cross += np.outer(normal, normal)
        first = run if first is None else first
    if first is None:
        return 0.0
    along = np.linalg.eigh(cross)[1][:, 0]
    return (
        float(np.arctan2(along[1], along[0]))
        if np.dot(along, first) >= 0
        else float(np.arctan2(-along[1], -along[0]))
    )
