"""The settings that measurements speak for: docs/methods/shadow_maps.md says which."""

from .settings import METHODS, ShadowSettings

WIDEST_WINDOW = 15
"""Texels; a Gaussian of more costs more than a map of half the resolution, which is as soft."""
EXPONENTS = {"float32": 40.0, "16+16": 40.0, "8+8": 20.0}
"""Of `evsm`: in 8 bits a greater one makes steps of depth into steps of light."""
BLEEDING_REDUCTION = 0.15
_NARROWEST = 3


def suggested_settings(
    extent: float, resolution: int = 1024, storage: str = "16+16", penumbra: float = 0.0, method: str = "evsm"
) -> ShadowSettings:
    """Settings for a map ``extent`` m wide whose shadows have edges ``penumbra`` m wide.

    A disc lamp of angular diameter α throws edges 2 h tan(α/2) wide from h m away; the window is as wide,
    from 3 to WIDEST_WINDOW texels. `evsm` is the default since it errs least in every storage; another
    method gets the offsets that keep it free of acne.
    Raises ValueError for an extent that is not above 0, a penumbra below 0, and what ShadowSettings refuses.

    >>> suggested_settings(4.0, 1024, penumbra=0.02).window
    5
    """
    if not 0 < extent < float("inf"):
        raise ValueError(f"extent {extent} m of the scene must be above 0")
    if not 0 <= penumbra < float("inf"):
        raise ValueError(f"penumbra {penumbra} m must be 0 or more")
    texels = min(penumbra * resolution / extent, WIDEST_WINDOW)
    window = 1 if method == "hard" else max(2 * round((texels - 1) / 2) + 1, _NARROWEST)
    factor, units = offsets(method, window) if method in METHODS else (0.0, 0.0)
    return ShadowSettings(
        method=method,
        resolution=resolution,
        storage=storage,
        window=window,
        offset_factor=factor,
        offset_units=units,
        bleeding_reduction=BLEEDING_REDUCTION,
        exponent=EXPONENTS.get(storage, EXPONENTS["float32"]),
    )


def offsets(method: str, window: int) -> tuple[float, float]:
    """Factor and units of glPolygonOffset.

    A texel compared with is up to ½ texel from the place for `hard`, (window + 1)/2 for `pcf`, in x and in y.
    A plane's depth changes by m at most over a texel along either, so by m, or by m (window + 1); rounding
    adds half a unit. Variances know the slope: `evsm` needs a unit for the rounding of its mean, `vsm`, whose
    least variance is wider than that, nothing.
    """
    return {"hard": (1.0, 1.0), "pcf": (window + 1.0, 1.0), "vsm": (0.0, 0.0), "evsm": (0.0, 1.0)}[method]
