"""How far a depth's error shifts what an eye beside the panorama's centre sees.

A point in direction w (unit) at depth d is seen by an eye e in the direction of w - n e, n = 1/d. Two depths
on one ray are seen at an angle A apart, with

    tan A = |n1 - n2| |w x e| / ((w - n1 e) . (w - n2 e)).

Of all eyes at distance r < d1, d2 the worst stands at the angle c to w with cos c = (x1 + x2) / (1 + x1 x2),
x = r n, and sees

    tan A = |x1 - x2| / sqrt((1 - x1^2)(1 - x2^2)) = sinh |y1 - y2|,    y = artanh x.

It grows with r. So with y = artanh(radius / depth) the difference |y1 - y2| bounds the parallax [rad] from
anywhere within the radius; it is attained but for a part of A^2/6.

A surface within the radius can be touched by the eye, where no error is small enough. So beyond x = 0.95 y
goes on along its tangent, as if eyes kept away from the surface by about a twentieth of its depth.

Source: thesis, 6.2.4, which has the parallax of a layer against infinity; the worst case is derived here.
"""

import numpy as np

from ..panorama import EQUIRECTANGULAR

_NEAREST = 0.95
_SLOPE = 1 / (1 - _NEAREST**2)


def parallax(near, radius):
    """y (...) [rad] of reciprocal depths (...) [1/m]: the differences of y are the largest parallax.

    >>> eye, points = np.array([0.6, 0.8]), np.array([[0.0, 2.0], [0.0, 2.1]])  # at a distance of 1
    >>> x, y = (points - eye).T
    >>> seen = abs(np.diff(np.arctan2(y, x)))[0]
    >>> bool(seen < abs(np.diff(parallax(1 / points[:, 1], 1.0)))[0])
    True
    """
    x = np.asarray(near) * radius
    y = np.arctanh(np.minimum(x, _NEAREST))
    return y + _SLOPE * np.maximum(x - _NEAREST, 0)


def pixel_angle(layer):
    """The angle [rad] of a layer's pixels: a right angle by a quarter of the width, or by a cube's face."""
    width, _ = layer.size
    return np.pi / 2 / (width / 4 if layer.mapping == EQUIRECTANGULAR else width // 3)
