"""Exponential variance shadow maps in the same 32 bits: the depths are warped by x = exp(c (z − 1)) first.

What is behind a first occluder is then so much farther than it that Chebyshev's bound has little light to
leak. Of whole numbers x and x² would need far more than 16 bits. They are not held as such: with moments
M₁ and M₂ of x,

    a = 1 + ln(M₁)/c        the depth that the mean stands for
    b = v/(1 + v)           v = √(M₂ − M₁²)/M₁, the relative deviation

lie in 0 to 1 and hold c ≤ 42 in 16 bits each. Unpacking costs one exponential; filters have to unpack anyway.

Source: A. Lauritzen and M. McCool, "Layered variance shadow maps", GI 2008, section 4 (the warp). The storage
is ours.
"""

import numpy as np

from .gaussian import blurred
from .lookup import bilinear
from .storage import STEPS, packed, unpacked
from .vsm import chebyshev, without_bleeding

_FLOAT_DEVIATION = 1e-3  # of a 32-bit float's rounding: √(2⁻²³ · 8) of x


def warped(z, exponent):
    """x of linear depths z, from exp(−exponent) to 1."""
    return np.exp(exponent * (z - 1))


def texels(depth, camera, settings):
    """The filtered map as the device holds it."""
    x = warped(camera.linear_depth(depth), settings.exponent)
    decode, encode = (lambda t: decoded(t, settings)), (lambda m: encoded(m, settings))
    return blurred(encode(np.stack([x, x * x], axis=-1)), settings.window, encode, decode)


def visibility(shadow_map, texture):
    """Of places (n, 3), s, t, r."""
    settings = shadow_map.settings
    moments = bilinear(shadow_map.texels, texture[:, :2], lambda t: decoded(t, settings))
    x = warped(shadow_map.camera.linear_depth(texture[:, 2]), settings.exponent)
    least = (least_deviation(settings) * x) ** 2
    return without_bleeding(chebyshev(moments, x, least), settings.bleeding_reduction)


def least_deviation(settings) -> float:
    """What rounding alone makes of the relative deviation: a step of z times c."""
    step = STEPS[settings.storage]
    return settings.exponent * step if step else _FLOAT_DEVIATION


def encoded(moments, settings):
    """Texels of moments (…, 2) of x; 32-bit floats hold them as they are."""
    if settings.storage == "float32":
        return packed(moments, settings.storage)
    mean = np.maximum(moments[..., 0], np.exp(-settings.exponent))
    deviation = np.sqrt(np.maximum(moments[..., 1] - mean**2, 0.0)) / mean
    depth = 1 + np.log(mean) / settings.exponent
    return packed(np.stack([depth, deviation / (1 + deviation)], axis=-1), settings.storage)


def decoded(texels_, settings):
    """Moments (…, 2) of x that texels stand for."""
    numbers = unpacked(texels_, settings.storage)
    if settings.storage == "float32":
        return numbers
    mean = warped(numbers[..., 0], settings.exponent)
    share = np.minimum(numbers[..., 1], 1 - STEPS[settings.storage] / 2)  # 1 stands for all that is beyond
    return np.stack([mean, mean**2 * (1 + (share / (1 - share)) ** 2)], axis=-1)
