"""Other maps than VSM that one could hold in 32 bits a texel, and what more bits would give.

ESM: Annen et al., "Exponential shadow maps", GI 2008. MSM: Peters and Klein, "Moment shadow mapping",
I3D 2015, algorithm 3 and, for 8 bits a moment, the affine transform they optimised for rounding.
"""

import numpy as np

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import evsm, suggested_settings, vsm
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps.gaussian import along
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps.lookup import bilinear
from expanded_panoramas.ibl_toolkit.mobile.shadow_maps.storage import packed, unpacked

_TRANSFORM = np.array(
    [
        [-2.07224649, 13.7948857237, 0.105877704, 9.7924062118],
        [32.23703778, -59.4683975703, -1.9077466311, -33.7652110555],
        [-68.571074599, 82.0359750338, 9.3496555107, 47.9456096605],
        [39.3703274134, -35.364903257, -6.6543490743, -23.9728048165],
    ]
)
_OFFSET = np.array([0.035955884801, 0, 0, 0])
ESM_EXPONENT = 80.0  # what a 32-bit float holds
HALF_EXPONENT = 5.5  # e^(2 · 5.5) is what a half float holds, of x from e^−c to e^c
BIASES = (1e-6, 6e-5, 1e-3, 5e-3, 1.5e-2, 5e-2)
"""Of MSM, towards moments of an even coin; the best for each scene is shown."""


def candidates():
    """Name -> (storage of the depths, bits a texel, function of (depth, places (n, 3), window)).

    The function gives one visibility (n,) for each bias to choose from.
    """
    return {
        "VSM 16 + 16": ("16+16", 32, lambda d, p, w: [_vsm(d, p, w, "16+16")]),
        "ESM float": ("float32", 32, lambda d, p, w: [_esm(d, p, w)]),
        "EVSM half floats": ("16+16", 32, _evsm_half),
        "MSM 4 × 8": ("16+16", 32, lambda d, p, w: [_msm(d, p, w, _eight, a) for a in BIASES]),
        "MSM 4 × float": ("float32", 128, lambda d, p, w: [_msm(d, p, w, np.float32, a) for a in BIASES]),
        "EVSM 16 + 16, ours": ("16+16", 32, lambda d, p, w: [_ours(d, p, w, "16+16")]),
        "EVSM 8 + 8, ours": ("8+8", 16, lambda d, p, w: [_ours(d, p, w, "8+8")]),
    }


def _filtered(moments, window, rounded):
    moments = rounded(moments)
    for axis in (1, 0):
        moments = rounded(along(moments.astype(np.float64), axis, window))
    return moments


def _powers(z, count):
    return np.stack([z**k for k in range(1, count + 1)], axis=-1)


def _at(moments, places):
    return bilinear(moments, places[:, :2], lambda t: t.astype(np.float64))


def _vsm(depth, places, window, storage):
    held = _filtered(_powers(depth, 2), window, lambda m: unpacked(packed(m, storage), storage))
    return vsm.chebyshev(_at(held, places), places[:, 2], vsm.least_variance(storage))


def _esm(depth, places, window):
    """One number, exp(c z), of which the mean is compared: visible by mean/exp(c d)."""
    held = _filtered(np.exp(ESM_EXPONENT * (depth - 1))[..., None], window, lambda m: m.astype(np.float32))
    return np.clip(_at(held, places)[:, 0] * np.exp(ESM_EXPONENT * (1 - places[:, 2])), 0, 1)


def _evsm_half(depth, places, window):
    def warped(z):
        return np.exp(HALF_EXPONENT * (2 * z - 1))

    held = _filtered(_powers(warped(depth), 2), window, lambda m: m.astype(np.float16))
    x = warped(places[:, 2])
    return [vsm.chebyshev(_at(held, places), x, (least * x) ** 2) for least in (0.03, 0.05, 0.1)]


def _eight(moments):
    """Rounded to 8 bits in the optimised basis."""
    held = np.rint(np.clip(moments @ _TRANSFORM + _OFFSET, 0, 1) * 255) / 255
    return (held - _OFFSET) @ np.linalg.inv(_TRANSFORM)


def _msm(depth, places, window, rounded, bias):
    """Hamburger: of all distributions with four moments, the one that is nearest to lit."""
    moments = _at(_filtered(_powers(depth, 4), window, rounded), places)
    b1, b2, b3, b4 = ((1 - bias) * moments + bias * 0.5).T
    one, z0 = np.ones_like(b1), places[:, 2]
    hankel = np.stack([one, b1, b2, b1, b2, b3, b2, b3, b4], axis=-1).reshape(-1, 3, 3)
    hankel += 1e-12 * np.eye(3)
    c = np.linalg.solve(hankel, np.stack([one, z0, z0**2], axis=-1)[..., None])[..., 0]
    half = -c[:, 1] / (2 * c[:, 2])
    root = np.sqrt(np.maximum(half**2 - c[:, 0] / c[:, 2], 0))
    z1, z2 = half - root, half + root
    with np.errstate(divide="ignore", invalid="ignore"):
        between = (z0 * z2 - b1 * (z0 + z2) + b2) / ((z2 - z1) * (z0 - z1))
        beyond = 1 - (z1 * z2 - b1 * (z1 + z2) + b2) / ((z0 - z1) * (z0 - z2))
    shadow = np.where(z0 <= z1, 0.0, np.where(z0 <= z2, between, beyond))
    return 1 - np.clip(np.nan_to_num(shadow), 0, 1)


def _ours(depth, places, window, storage):
    """What the package does, without its reduction of bleeding."""
    settings = suggested_settings(1.0, storage=storage)
    decode, encode = (lambda t: evsm.decoded(t, settings)), (lambda m: evsm.encoded(m, settings))
    held = _filtered(_powers(evsm.warped(depth, settings.exponent), 2), window, lambda m: decode(encode(m)))
    x = evsm.warped(places[:, 2], settings.exponent)
    return vsm.chebyshev(_at(held, places), x, (evsm.least_deviation(settings) * x) ** 2)
