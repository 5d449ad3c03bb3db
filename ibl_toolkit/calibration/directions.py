"""Directions of lines in space from where they are seen: sides of rectangles, vanishing points, angles."""

import numpy as np


def angle_between(a, b):
    """The angle between unit vectors (..., 3) [rad], accurate for tiny angles and near π.

    >>> import numpy as np
    >>> angle_between(np.array([1.0, 0.0, 0.0]), np.array([0.0, -1.0, 0.0])) == np.pi / 2
    True
    """
    return 2.0 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))


def corner_volumes(corners):
    """Signed volumes (..., 4) of corners (..., 4, 3), each without the k-th: p · (q × r) of the others.

    All of one sign for a convex outline, whichever way round; two of each for one whose sides cross.
    """
    p, q, r = (corners[..., others, :] for others in ([1, 0, 0, 0], [2, 2, 1, 1], [3, 3, 3, 2]))
    return np.sum(p * np.cross(q, r), axis=-1)


def side_directions(corners):
    """Unit directions (..., 2, 3) of the sides 1→2 and 2→3 of rectangles seen along corners (..., 4, 3).

    Thesis eq. 5.2, x = (p0 × p1) × (p3 × p2) and y = (p1 × p2) × (p0 × p3), whose signs depend on the order
    of the clicks. The corners of a parallelogram are at depths λ with λ0 p0 − λ1 p1 + λ2 p2 − λ3 p3 = 0; its
    sides λ1 p1 − λ0 p0 and λ2 p2 − λ1 p1 are the same directions with the right sign.

    >>> import numpy as np
    >>> corners = np.array([[1, 1, -1], [3, 1, -1], [3, 2, -1], [1, 2, -1.0]])
    >>> (side_directions(corners / np.linalg.norm(corners, axis=1)[:, None]).round(9) + 0.0).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    """
    depths = corner_volumes(corners)
    scaled = corners * (depths * np.sign(depths.sum(axis=-1, keepdims=True)))[..., None]
    sides = scaled[..., 1:3, :] - scaled[..., 0:2, :]
    return sides / np.linalg.norm(sides, axis=-1, keepdims=True)


def reverse_depth(sides, corners):
    """Sides (2, 3) of the figure that looks alike from afar with near and far exchanged (Necker's cube).

    Mirrored in the plane across the line of sight to its middle; corners (4, 3) are its directions.

    >>> import numpy as np
    >>> reverse_depth(np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]]), np.array([[0.0, 0.0, 1.0]] * 4)).tolist()
    [[0.6, 0.0, -0.8], [0.0, 1.0, 0.0]]
    """
    sight = corners.sum(axis=0)
    sight = sight / np.linalg.norm(sight)
    return sides - 2.0 * np.outer(sides @ sight, sight)


def vanishing_direction(normals):
    """The unit direction (3,) nearest to all planes of unit normals (k, 3), k ≥ 2; its sign is free.

    >>> import numpy as np
    >>> abs(vanishing_direction(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))).tolist()
    [0.0, 0.0, 1.0]
    """
    return np.linalg.eigh(normals.T @ normals)[1][:, 0]


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
