"""A panorama in layers: what is seen from its origin, and what stands behind it.

Source: thesis, section 6.2, eq. 6.7-6.12; a layer's domain V is where its depth is known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

EQUIRECTANGULAR, CUBE_MAP = "equirectangular", "cube map"
MAPPINGS = (EQUIRECTANGULAR, CUBE_MAP)

# What a layer can say of each pixel, with its channels: 3 is (H, W, 3), 1 is (H, W).
CHANNELS = {
    "radiance": 3,  # linear, scene-referred
    "depth": 1,  # [m] along the ray
    "diffuse light": 3,  # irradiance / pi
    "normals": 3,  # unit vectors, panorama frame
    "reflectivity": 1,  # 0 to 1
    "material index": 1,  # whole numbers
    "emission": 3,  # radiance that the surface itself gives
    "mask": 1,  # bool: the domain
}
_ORTHONORMAL = 1e-5  # as in RGB-D files: a matrix of single floats is no better
_LONGEST_NAME = 200


@dataclass(frozen=True, eq=False)
class Layer:
    """One layer; its resolution is its own.

    mapping: "equirectangular", W = 2H, or "cube map", 3N x 2N, in the conventions of the modules of these
    names. attributes: arrays (H, W) or (H, W, 3) by the names of CHANNELS. `depth` must be among them: (H, W)
    [m] along the ray, +inf at infinity, NaN outside of the domain. A bool `mask` may make the domain smaller
    than where the depth is known. What attributes hold outside of the domain has no meaning.

    Raises: ValueError for an attribute that is unknown, of another size or type, for a depth in the domain
    that is NaN or not above 0, and for an empty domain.

    >>> Layer("wall", "equirectangular", {"depth": np.full((2, 4), 3.0, np.float32)}).size
    (4, 2)
    """

    name: str
    mapping: str
    attributes: dict[str, np.ndarray]

    def __post_init__(self):
        if not (self.name.strip() and self.name.isprintable() and len(self.name) <= _LONGEST_NAME):
            raise ValueError(
                f"layer name {self.name!r} must be printable text of 1 to {_LONGEST_NAME} letters"
            )
        if self.mapping not in MAPPINGS:
            raise ValueError(f"{self} has mapping {self.mapping!r}, must be one of {', '.join(MAPPINGS)}")
        if "depth" not in self.attributes:
            raise ValueError(f"{self} has no depth")
        for name, values in self.attributes.items():
            _refuse_other_arrays(self, name, values)
        _refuse_other_sizes(self)
        _refuse_impossible_depth(self)

    def __str__(self):
        return f"layer '{self.name}'"

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [px]."""
        height, width = self.depth.shape
        return width, height

    @property
    def depth(self) -> np.ndarray:
        """(H, W) [m] along the ray, +inf at infinity."""
        return self.attributes["depth"]

    @property
    def radiance(self) -> np.ndarray | None:
        """(H, W, 3) float32, linear; None where the layer has none."""
        return self.attributes.get("radiance")

    @property
    def mask(self) -> np.ndarray:
        """(H, W) bool: the domain, from the attribute `mask` or from where the depth is a number."""
        mask = self.attributes.get("mask")
        return ~np.isnan(self.depth) if mask is None else mask

    def within(self, pixels: np.ndarray, name: str | None = None) -> Layer:
        """The layer with that part of its domain that is in `pixels` (H, W) bool, and another name if given.

        Raises: ValueError where nothing is left.
        """
        inside = self.mask & pixels
        attributes = {**self.attributes, "depth": np.where(inside, self.depth, self.depth.dtype.type(np.nan))}
        if "mask" in attributes:
            attributes["mask"] = inside
        return Layer(self.name if name is None else name, self.mapping, attributes)


@dataclass(frozen=True, eq=False)
class LayeredPanorama:
    """Layers of one panorama, and where it stands.

    world_from_panorama: (3, 3) rotation. origin: (3,) [m] in the world. radius: [m] round the origin within
    which the layers are made to be looked at ("Freedom radius").

    Raises: ValueError without layers, for two of one name, for what is no rotation, and for an origin or a
    radius that is not finite, a radius below 0.
    """

    layers: tuple[Layer, ...]
    world_from_panorama: np.ndarray
    origin: np.ndarray
    radius: float

    def __post_init__(self):
        names = [layer.name for layer in self.layers]
        if not names:
            raise ValueError("a layered panorama must have one layer or more")
        repeated = next((name for name in names if names.count(name) > 1), None)
        if repeated is not None:
            raise ValueError(f"two layers have the name '{repeated}': names must differ")
        refuse_other_place(self.world_from_panorama, self.origin, self.radius)


def refuse_other_place(world_from_panorama, origin, radius):
    """Raise ValueError unless these are a (3, 3) rotation, a finite (3,) origin and a radius of 0 or more."""
    matrix, origin = (np.asarray(a, dtype=np.float64) for a in (world_from_panorama, origin))
    is_rotation = matrix.shape == (3, 3) and np.allclose(matrix @ matrix.T, np.eye(3), atol=_ORTHONORMAL)
    if not is_rotation or np.linalg.det(matrix) < 0:
        raise ValueError(f"world_from_panorama {matrix.tolist()} must be a (3, 3) rotation")
    if origin.shape != (3,) or not np.isfinite(origin).all():
        raise ValueError(f"origin {origin.tolist()} must be three finite numbers")
    if not (np.isfinite(radius) and radius >= 0):
        raise ValueError(f"radius {radius} m must be finite and not below 0")


def refuse_other_layout(width, height, mapping):
    """Raise ValueError unless a whole map of `mapping` can have this size: 2:1, or 3N x 2N."""
    if mapping == EQUIRECTANGULAR and (width != 2 * height or height < 1):
        raise ValueError(f"{width} x {height} px, an equirectangular map must be 2:1")
    if mapping == CUBE_MAP and (height < 2 or height % 2 or 2 * width != 3 * height):
        raise ValueError(f"{width} x {height} px, a cube map must be 3N x 2N")


def _refuse_other_arrays(layer, name, values):
    if name not in CHANNELS:
        raise ValueError(f"{layer} has an unknown attribute '{name}'; known: {', '.join(CHANNELS)}")
    if values.ndim != (2 if CHANNELS[name] == 1 else 3) or (values.ndim == 3 and values.shape[2] != 3):
        right = "(H, W)" if CHANNELS[name] == 1 else "(H, W, 3)"
        raise ValueError(f"{layer} has {name} of shape {values.shape}, must be {right}")
    kinds, right = {"mask": ("b", "bool"), "material index": ("iu", "whole numbers")}.get(
        name, ("f", "float")
    )
    if values.dtype.kind not in kinds:
        raise ValueError(f"{layer} has {name} of type {values.dtype}, must be {right}")
    if name == "material index" and values.size and values.min() < 0:
        raise ValueError(f"{layer} has a material index of {values.min()}, must not be below 0")


def _refuse_other_sizes(layer):
    sizes = {name: values.shape[:2] for name, values in layer.attributes.items()}
    if len(set(sizes.values())) > 1:
        listed = ", ".join(f"{name} {w} x {h}" for name, (h, w) in sizes.items())
        raise ValueError(f"{layer} has attributes of several sizes: {listed}")
    try:
        refuse_other_layout(*layer.size, layer.mapping)
    except ValueError as error:
        raise ValueError(f"{layer}: {error}") from None


def _refuse_impossible_depth(layer):
    mask = layer.mask
    if not mask.any():
        raise ValueError(f"{layer} has an empty domain: its depth is NaN everywhere, or its mask is empty")
    bad = mask & ~(layer.depth > 0)
    if bad.any():
        row, column = (int(k) for k in np.unravel_index(np.argmax(bad), bad.shape))
        raise ValueError(
            f"{layer}: {np.count_nonzero(bad)} depths of its domain are NaN or not above 0, the first at "
            f"({column}, {row}): {layer.depth[row, column]}; +inf means none"
        )
