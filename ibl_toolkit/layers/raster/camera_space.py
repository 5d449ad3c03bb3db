"""Corners of triangles as a camera has them before it, and triangles cut off where they come too near to it.

A vertex has the same place in all of its triangles, to the last bit, and so has the point at which a side is
cut: only then do neighbours meet without a crack.
"""

import numpy as np

NEAR = 1e-4
"""Distance along forward [m] up to which nothing is drawn."""


def to_camera(points, camera):
    """Places (..., 3) to the right, down and forward [m] of points (..., 3).

    The sums are written out: a product of matrices may be rounded otherwise in another block of points.
    """
    x, y, z = (points[..., k] - camera.eye[k] for k in range(3))
    return np.stack([axis[0] * x + axis[1] * y + axis[2] * z for axis in camera.axes], axis=-1)


def on_picture(places, camera):
    """Column and row [px] of places (..., 3) before a camera, and the reciprocal of their distance [1/m].

    The reciprocal is linear in the picture.
    """
    near = 1.0 / places[..., 2]
    right, down = (camera.focal * places[..., k] * near for k in (0, 1))
    return right + camera.width / 2, down + camera.height / 2, near


def cut_at_near(points, triangles, camera):
    """What lies beyond NEAR of triangles (n, 3) that reach across it, and which of them it is of, (m,).

    It comes as corners (m, 3, 3), to the camera. Sides are cut from the vertex of the lower number to the
    other, so that neighbours cut alike.
    """
    before = to_camera(points[triangles], camera)[..., 2] > NEAR
    count = before.sum(axis=1)
    alone = np.argmax(before == (count == 1)[:, None], axis=1)  # the vertex that is on a side by itself
    a, b, c = (triangles[np.arange(len(triangles)), (alone + k) % 3] for k in range(3))
    ab, ac = _crossings(points, a, b, camera), _crossings(points, a, c, camera)
    a, b, c = (to_camera(points[k], camera) for k in (a, b, c))
    one, two = np.flatnonzero(count == 1), np.flatnonzero(count == 2)
    parts = [
        np.stack([a[one], ab[one], ac[one]], axis=1),
        np.stack([ab[two], b[two], c[two]], axis=1),
        np.stack([ab[two], c[two], ac[two]], axis=1),
    ]
    return np.concatenate(parts), np.concatenate([one, two, two])


def _crossings(points, one, other, camera):
    first, last = (to_camera(points[f(one, other)], camera) for f in (np.minimum, np.maximum))
    share = (NEAR - first[:, 2]) / (last[:, 2] - first[:, 2])
    place = first + share[:, None] * (last - first)
    place[:, 2] = NEAR
    return place
