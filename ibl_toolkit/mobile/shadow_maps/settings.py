"""What can be chosen of a shadow map."""

from dataclasses import dataclass
from numbers import Integral

from .storage import STEPS

METHODS = ("hard", "pcf", "vsm", "evsm")
"""One test; percentage-closer filtering; variance, exponential variance shadow maps."""
STORAGES = tuple(STEPS)
SMALLEST, LARGEST = 16, 8192
"""Least and greatest resolution [texels a side]."""
STRONGEST = 42.0
"""Greatest exponent: exp(2 · 42) is the last that a 32-bit float holds on either side of 1."""


@dataclass(frozen=True)
class ShadowSettings:
    """One kind of shadow map.

    method: of METHODS. resolution: texels a side. storage: of STORAGES, see `storage`.
    window: width of the filter [texels], odd; `hard` has none.
    offset_factor, offset_units: of glPolygonOffset, see `depth_buffer`; the classic set-up has 1.9 and 4.
    bleeding_reduction: visibility below which a point counts as dark, 0 to 0.95; `vsm` and `evsm` only.
    exponent: of `evsm`, above 0.

    Raises: ValueError that names the field and what is right.
    """

    method: str = "evsm"
    resolution: int = 1024
    storage: str = "16+16"
    window: int = 3
    offset_factor: float = 1.9
    offset_units: float = 4.0
    bleeding_reduction: float = 0.15
    exponent: float = 40.0

    def __post_init__(self):
        _one_of("method", self.method, METHODS)
        _one_of("storage", self.storage, STORAGES)
        for name in ("resolution", "window"):
            if not isinstance(getattr(self, name), Integral):
                raise ValueError(f"{name} {getattr(self, name)} must be a whole number of texels")
        _within("resolution", self.resolution, SMALLEST, LARGEST)
        if self.window < 1 or self.window % 2 != 1:
            raise ValueError(f"window {self.window} must be an odd number of texels: 1, 3, 5 …")
        if self.window > self.resolution:
            raise ValueError(f"window {self.window} must not exceed the resolution {self.resolution}")
        _within("offset_factor", self.offset_factor, -100, 100)
        _within("offset_units", self.offset_units, -1e7, 1e7)
        _within("bleeding_reduction", self.bleeding_reduction, 0, 0.95)
        _within("exponent", self.exponent, 0.1, STRONGEST)

    @property
    def has_moments(self) -> bool:
        """Whether texels hold moments of depths, which are blurred, and not a depth."""
        return self.method in ("vsm", "evsm")

    @property
    def bytes_per_texel(self) -> int:
        """Of the texture, without the depth buffer that a device needs to draw it.

        >>> ShadowSettings("vsm", storage="16+16").bytes_per_texel
        4
        """
        numbers = 2 if self.has_moments else 1
        return numbers * {"float32": 4, "8+8": 1, "16+16": 2}[self.storage]


def _one_of(name, value, right):
    if value not in right:
        raise ValueError(f"{name} {value!r} must be one of {', '.join(right)}")


def _within(name, value, low, high):
    if not low <= value <= high:  # NaN is not either
        raise ValueError(f"{name} {value} must lie between {low:g} and {high:g}")
