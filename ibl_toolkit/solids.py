"""What stands on the floor: walls with a ceiling, boxes and cylinders over a floor shape, and their heights.

Local geometry stands on z = 0 and reaches to z = 1; the height is the z scale. Source: thesis, section 5.5.
"""

from dataclasses import dataclass

import numpy as np

from .meshes import Mesh
from .outlines import first_hit

STEEPEST_DEG = 89.0  # elevation beyond which the least click error moves a height by metres
ADVISED_DEVIATION_DEG = 2.0
LARGEST_DEVIATION_DEG = 30.0


@dataclass(frozen=True)
class Height:
    """height_m [m]; deviation_m: how far sideways of the line above its base point the pick is [m]."""

    height_m: float
    deviation_m: float = 0.0
    warnings: tuple[str, ...] = ()


def box(base, height):
    """Five faces, outwards, over a FloorShape, `height` [m] high; no bottom, which nothing sees -> Mesh.

    >>> from .floor_shapes import rectangle
    >>> len(box(rectangle([[1, 0], [1, 2], [2, 0]]), 0.7).faces)
    5
    """
    return _prism(base, height, outwards=True, closed=True)


def cylinder(base, height):
    """One face per side of the base and one on top, outwards, as high as `height` [m] -> Mesh."""
    return _prism(base, height, outwards=True, closed=True)


def walls(base, height, ceiling):
    """One face per side of the base, into the room, and with `ceiling` one n-gon that faces down -> Mesh."""
    return _prism(base, height, outwards=False, closed=ceiling)


def _prism(base, height, outwards, closed):
    if not (np.isfinite(height) and height > 0):
        raise ValueError(f"height {height:.3g} m: must be above 0")
    bottom = base.mesh.vertices
    count = len(bottom)
    vertices = np.concatenate([bottom, np.add(bottom, (0, 0, 1))])
    faces = []
    for i in range(count):
        j = (i + 1) % count
        faces.append((i, j, count + j, count + i))
    if closed:
        faces.append(tuple(range(count, 2 * count)))
    if not outwards:
        faces = [face[::-1] for face in faces]
    matrix = base.mesh.world_from_local.copy()
    matrix[2, 2] = height
    return Mesh(vertices, tuple(faces), matrix)


def height_above_point(direction, point, camera_height):
    """Height from a pick on the upper edge straight above a known base point -> Height.

    direction (3,) of the pick in the world; point (2,) on the floor [m]. The pick's azimuth should be the
    point's: what it deviates is reported, and warned of beyond ADVISED_DEVIATION_DEG.

    Raises ValueError for a pick that deviates by more than LARGEST_DEVIATION_DEG, is too steep, or gives no
    height.

    >>> height_above_point(np.array([1.0, 0, 0]), np.array([3.0, 0]), 1.5).height_m
    1.5
    """
    distance = float(np.linalg.norm(point))
    if distance <= 0.01 * camera_height:
        raise ValueError(
            "the first point lies straight below the panorama, where `top` has no azimuth: give `height`"
        )
    azimuth = np.arctan2(direction[1], direction[0])
    turn = azimuth - np.arctan2(point[1], point[0])
    deviation = (turn + np.pi) % (2 * np.pi) - np.pi
    deviation_deg = abs(np.degrees(deviation))
    if deviation_deg > LARGEST_DEVIATION_DEG:
        raise ValueError(
            f"`top` lies {deviation_deg:.1f}° beside the first point: pick it straight above that point "
            f"(within {LARGEST_DEVIATION_DEG:.0f}°)"
        )
    deviation_m = float(distance * abs(np.sin(deviation)))
    notes = ()
    if deviation_deg > ADVISED_DEVIATION_DEG:
        notes = (
            f"`top` lies {deviation_deg:.1f}° ({deviation_m:.3f} m) beside the line above the first point",
        )
    return Height(height_at(direction, distance, camera_height), deviation_m, notes)


def height_above_outline(direction, base, camera_height):
    """Height from a pick above the point where the base is first met in the pick's azimuth -> Height.

    base: a FloorShape; a circle is met exactly, not its n-gon.

    Raises ValueError where the azimuth misses the base, for a pick that is too steep or gives no height.
    """
    azimuth = np.arctan2(direction[1], direction[0])
    if base.circle is None:
        distance = first_hit(base.outline, azimuth)
    else:
        distance = first_hit_of_circle(*base.circle, azimuth)
    if distance is None:
        raise ValueError(
            "no part of the base lies below `top`: pick it straight above the base's nearest edge"
        )
    return Height(height_at(direction, distance, camera_height))


def height_at(direction, distance, camera_height):
    """Height [m] of what is seen in `direction` (3,) at a horizontal distance [m]: h + d · tan(elevation).

    Raises ValueError for a direction too steep and for a height of 0 or less.
    """
    across = float(np.hypot(direction[0], direction[1]))
    elevation_deg = float(np.degrees(np.arctan2(direction[2], across)))
    if abs(elevation_deg) > STEEPEST_DEG:
        raise ValueError(
            f"`top` is at {elevation_deg:.1f}° elevation, must be within ±{STEEPEST_DEG:.0f}°: give `height`"
        )
    height = float(camera_height + distance * direction[2] / across)
    if height <= 0:
        raise ValueError(
            f"`top` gives a height of {height:.3f} m, must be above 0: pick it above the base point"
        )
    return height


def first_hit_of_circle(centre, radius, azimuth):
    """Distance [m] at which a ray of this azimuth [rad] from the origin first meets a circle, or None.

    >>> first_hit_of_circle(np.array([3.0, 0.0]), 1.0, 0.0)
    2.0
    """
    middle = float(centre[0] * np.cos(azimuth) + centre[1] * np.sin(azimuth))
    half_chord_squared = radius**2 - (float(centre @ centre) - middle**2)
    if half_chord_squared < 0:
        return None
    half_chord = np.sqrt(half_chord_squared)
    ahead = [distance for distance in (middle - half_chord, middle + half_chord) if distance > 0]
    return float(ahead[0]) if ahead else None
