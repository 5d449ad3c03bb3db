"""Rectangle, square, circle and polygon on the floor, from picks already projected to the floor plane.

Each returns a FloorShape: its outline in the world and one n-gon of unit size, facing up.
Source: thesis, section 5.5.1, equations 5.3 and 5.4, with the corrections that the docstrings name.
"""

from dataclasses import dataclass

import numpy as np

from .circle_fit import fit_circle
from .meshes import Mesh, placement
from .outlines import counter_clockwise, crossing_sides, extent, signed_area, without_redundant_points

DEGENERATE = 1e-3  # smallest ratio of the sides of a rectangle
THINNEST = 1e-5  # smallest ratio of a polygon's area to its squared extent
HALF_PIXEL = np.pi / 4096  # [rad] half a pixel of a panorama 4096 wide
FEWEST_SIDES = 8  # of the n-gon that stands for a circle, however far away it is
UNIT_SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


@dataclass(frozen=True, eq=False)
class FloorShape:
    """A closed outline on the floor.

    outline (n, 2) in the world [m], counter-clockwise; mesh: one n-gon, facing up; residual_m: how far the
    picks are from the shape [m]; circle: (centre (2,), radius [m]) where the shape is one, of which the
    outline is an approximation; conditioning: metres that the radius of a circle moves per metre of pick
    error, else 1.
    """

    outline: np.ndarray
    mesh: Mesh
    residual_m: float
    circle: tuple[np.ndarray, float] | None = None
    conditioning: float = 1.0
    warnings: tuple[str, ...] = ()

    @property
    def size_m(self):
        """(2,) width and depth along the local axes [m]."""
        return self.mesh.scale[:2]


def rectangle(points):
    """Rectangle from one whole side (first two points) and any point of the opposite side, points (3, 2) [m].

    Deviates from eq. 5.4: the normal is of unit length and points to the side on which the third point lies,
    the angle is signed. residual_m is how far the third point lies beyond the ends of the side it fixes.

    Raises ValueError for a side of no length or a third point on the first side.

    >>> shape = rectangle([[1, 1], [1, 4], [-1, 2]])
    >>> shape.size_m.tolist(), shape.mesh.world_from_local[:3, 3].tolist(), shape.residual_m
    ([3.0, 2.0], [0.0, 2.5, 0.0], 0.0)
    """
    first, second, third = _points(points, 3, exactly=True)
    side = second - first
    width = np.linalg.norm(side)
    if width <= DEGENERATE * np.linalg.norm(third - first):
        raise ValueError(f"the first two points are {width:.2g} m apart: pick both ends of one whole side")
    along = side / width
    normal = np.array([-along[1], along[0]])
    signed_depth = (third - first) @ normal
    if abs(signed_depth) <= DEGENERATE * width:
        raise ValueError(
            f"the third point is {abs(signed_depth):.2g} m off the first side's line ({width:.2g} m long): "
            "pick it on the opposite side"
        )
    across = signed_depth * normal
    offset = (third - first) @ along
    beyond = max(0.0, -offset, offset - width)
    outline = np.array([first, second, second + across, first + across])
    matrix = placement(
        [*(0.5 * (first + second) + 0.5 * across), 0.0],
        np.arctan2(along[1], along[0]),
        (width, abs(signed_depth), 1),
    )
    return FloorShape(counter_clockwise(outline), _n_gon(UNIT_SQUARE, matrix), float(beyond))


def square(points):
    """Square from two opposite corners, points (2, 2) [m]; exactly determined, so residual_m is 0.

    Raises ValueError when the corners coincide.

    >>> square([[0, 0], [2, 2]]).size_m.round(12).tolist()
    [2.0, 2.0]
    """
    first, opposite = _points(points, 2, exactly=True)
    diagonal = opposite - first
    length = np.linalg.norm(diagonal)
    if length <= DEGENERATE * np.linalg.norm(first):
        raise ValueError(f"the two points are {length:.2g} m apart: pick opposite corners")
    centre = 0.5 * (first + opposite)
    half_turned = 0.5 * np.array([-diagonal[1], diagonal[0]])
    outline = np.array([first, centre - half_turned, opposite, centre + half_turned])
    side = length / np.sqrt(2)
    matrix = placement([*centre, 0.0], np.arctan2(diagonal[1], diagonal[0]) - np.pi / 4, (side, side, 1))
    return FloorShape(outline, _n_gon(UNIT_SQUARE, matrix), 0.0)


def polygon(points):
    """Simple polygon, not necessarily convex, of either winding, points (n ≥ 3, 2) [m]; residual_m is 0.

    Repeated points and points exactly on a straight side are left out. The local axes are the world's.

    Raises ValueError for fewer than three distinct points, crossing sides, no area.
    Source: section 5.5.1.3.

    >>> polygon([[0, 0], [0, 2], [4, 2], [4, 0], [2, 0]]).outline.tolist()
    [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]
    """
    picked = _points(points, 3)
    distinct = len(np.unique(picked, axis=0))
    if distinct < 3:
        raise ValueError(f"{distinct} distinct points: a polygon needs three or more")
    size = extent(picked)
    outline = without_redundant_points(picked)
    if len(outline) < 3:
        raise ValueError(f"all {len(picked)} points lie on one line: pick the corners around an area")
    crossing = crossing_sides(outline)
    if crossing is not None:
        ends = [f"{i + 1}–{(i + 1) % len(outline) + 1}" for i in crossing]
        raise ValueError(
            f"sides {ends[0]} and {ends[1]} of the outline meet: pick the corners in order around it"
        )
    area = abs(signed_area(outline))
    if area <= THINNEST * size**2:
        raise ValueError(
            f"area {area:.2g} m² at an extent of {size:.2g} m: the points lie almost on one line"
        )
    outline = counter_clockwise(outline)
    low, high = outline.min(axis=0), outline.max(axis=0)
    matrix = placement([*(0.5 * (low + high)), 0.0], 0.0, [*(high - low), 1])
    return FloorShape(outline, _n_gon((outline - 0.5 * (low + high)) / (high - low), matrix), 0.0)


def circle(points, camera_height, tolerance=HALF_PIXEL):
    """Circle through or between three or more points (n, 2) [m], by least squares.

    Deviates from eq. 5.3, whose bisectors need exactly three points that are far from collinear. The n-gon
    has its corners on the circle and as few sides as keep the circle within `tolerance` [rad] of it, seen
    from the panorama at camera_height [m] above the world's origin (default: half a pixel of an image 4096
    wide).

    Raises ValueError for collinear points or an arc too short to fix a circle.

    >>> shape = circle([[2, 0], [4, 0], [3, 1]], 1.5)
    >>> shape.circle[0].round(9).tolist(), round(shape.circle[1], 9)
    ([3.0, 0.0], 1.0)
    """
    fit = fit_circle(_points(points, 3))
    nearest = np.hypot(camera_height, np.linalg.norm(fit.centre) - fit.radius)
    return _round_shape(fit, sides_of_circle(fit.radius, nearest, tolerance))


def cylinder_base(points, camera_height, tolerance=HALF_PIXEL):
    """Base of a cylinder: as `circle`, with sides enough for what stands on it.

    A cylinder may reach up to the panorama, so the horizontal distance to it counts, not the slant to its
    base.
    """
    fit = fit_circle(_points(points, 3))
    nearest = abs(np.linalg.norm(fit.centre) - fit.radius)
    return _round_shape(fit, sides_of_circle(fit.radius, max(nearest, 0.05 * camera_height), tolerance))


def sides_of_circle(radius, nearest, tolerance):
    """Fewest sides whose sagitta, radius · (1 − cos(π/n)), is at most `tolerance` [rad] seen from `nearest`
    [m].

    >>> sides_of_circle(1.0, 2.0, 0.001)
    50
    """
    cosine = max(1 - tolerance * nearest / radius, 0.0)
    return max(FEWEST_SIDES, int(np.ceil(np.pi / np.arccos(cosine) - 1e-9)))


def _round_shape(fit, sides):
    turns = np.arange(sides) * (2 * np.pi / sides)
    local = 0.5 * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
    matrix = placement([*fit.centre, 0.0], 0.0, (2 * fit.radius, 2 * fit.radius, 1))
    outline = fit.centre + 2 * fit.radius * local
    return FloorShape(
        outline,
        _n_gon(local, matrix),
        fit.residual_m,
        (fit.centre, fit.radius),
        fit.conditioning,
        fit.warnings,
    )


def _n_gon(local_outline, matrix):
    vertices = np.column_stack([local_outline, np.zeros(len(local_outline))])
    return Mesh(vertices, (tuple(range(len(vertices))),), matrix)


def _points(points, count, exactly=False):
    array = np.array(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < count or (exactly and len(array) != count):
        raise ValueError(
            f"points have shape {array.shape}, must be ({count}{'' if exactly else ' or more'}, 2)"
        )
    if not np.isfinite(array).all():
        raise ValueError(f"point {int(np.argmin(np.isfinite(array).all(axis=1)))} is not finite")
    return array
