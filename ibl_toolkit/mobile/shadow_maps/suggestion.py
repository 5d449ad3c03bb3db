"""The settings that measurements speak for: docs/methods/shadow_maps.md says which."""

from .settings import ShadowSettings

WIDEST_WINDOW = 15
"""Texels; a Gaussian of more costs more than a map of half the resolution, which is as soft."""
EXPONENTS = {"float32": 40.0, "16+16": 40.0, "8+8": 20.0}
"""Of `evsm`: in 8 bits a greater one makes steps of depth into steps of light."""
REDUCTIONS = {"float32": 0.05, "16+16": 0.05, "8+8": 0.15}
"""Of light bleeding, for `evsm`: less leaves light on the dark, more makes soft shadows too wide."""
VSM_REDUCTION = 0.3
"""`vsm` bleeds more than any reduction hides; this one errs least in sum."""
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
    return settings_with(max(2 * round((texels - 1) / 2) + 1, _NARROWEST), resolution, storage, method)


def settings_with(window: int, resolution: int, storage: str, method: str) -> ShadowSettings:
    """The measured settings for a window [texels]; `hard` has none. Raises what ShadowSettings refuses."""
    window = 1 if method == "hard" else window
    factor, units = offsets(method, window)
    return ShadowSettings(
        method=method,
        resolution=resolution,
        storage=storage,
        window=window,
        offset_factor=factor,
        offset_units=units,
        bleeding_reduction=reduction(method, storage),
        exponent=exponent(storage),
    )


def reduction(method: str, storage: str) -> float:
    """Of light bleeding; 0 for a storage that ShadowSettings refuses."""
    return VSM_REDUCTION if method == "vsm" else REDUCTIONS.get(storage, 0.0)


def exponent(storage: str) -> float:
    """Of `evsm`."""
    return EXPONENTS.get(storage, EXPONENTS["float32"])


def offsets(method: str, window: int) -> tuple[float, float]:
    """Factor and units of glPolygonOffset.

    A texel compared with is up to ½ texel from the place for `hard`, (window + 1)/2 for `pcf`, in x and in y.
    A plane's depth changes by m at most over a texel along either: by twice those many m in the worst case,
    by just as many where the slope is along one of them, as a floor's is under an upright light camera. One
    test can afford the worst case. For a window it would move the rims of round things behind what they
    shadow, which errs more than the acne left on other slopes. Rounding adds half a unit. Variances know the
    slope: `evsm` needs a unit for the rounding of its mean, `vsm`, whose least variance is wider, nothing.
    """
    factor = {"hard": 1.0, "pcf": (window + 1) / 2}.get(method, 0.0)
    return factor, 0.0 if method == "vsm" else 1.0
