"""The picture of a layer as a texture: 8-bit sRGB, gone on with beyond the domain's edge.

A texture is looked up between texels, and in mip levels: what lies outside of the domain shows at its edge.
So the colours of the domain's pixels are spread over those outside. The faces of a cube map each get a border
from their neighbours, for on the image they lie beside faces that are none.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from ...images.png import srgb_codes
from ..meshes.summed_area import rectangle_sums, summed_area_table
from ..panorama import CUBE_MAP, Layer
from .texture_coordinates import CubeChart, EquirectangularChart

BORDER = 4
"""[px] round the faces of a cube map, so that the first two mip levels don't mix them."""
_SPREAD = 16  # [px] beyond the domain


@dataclass(frozen=True, eq=False)
class Texture:
    """pixels: (h, w, 4) uint8, sRGB and alpha, top row first. chart: where corners of triangles lie on it."""

    name: str
    pixels: np.ndarray
    chart: EquirectangularChart | CubeChart
    _files: dict[bool, bytes] = field(default_factory=dict, init=False, repr=False)

    def png(self, with_alpha: bool) -> bytes:
        """The file, made once; without alpha unless a mesh needs it."""
        if with_alpha not in self._files:
            code = cv2.COLOR_RGBA2BGRA if with_alpha else cv2.COLOR_RGBA2BGR
            self._files[with_alpha] = cv2.imencode(".png", cv2.cvtColor(self.pixels, code))[1].tobytes()
        return self._files[with_alpha]

    def cut_to(self, part: Layer) -> Texture:
        """The same with the domain of a part of the layer as alpha; black where no look-up reaches."""
        pixels = self.pixels.copy()
        pixels[self.chart.texels(part, _surroundings(part.mask)) == 0] = 0
        pixels[..., 3] = np.round(self.chart.texels(part, part.mask.astype(np.float32)) * 255)
        return Texture(part.name, pixels, self.chart)

    def is_seen_on(self, uv: np.ndarray) -> np.ndarray:
        """Whether there may be something of the domain on triangles with corners uv (T, 3, 2) -> (T,) bool.

        None of those that are left out shows a texel that isn't transparent.
        """
        height, width = self.pixels.shape[:2]
        opaque = self.pixels[..., 3] > 0
        table = summed_area_table(np.concatenate([opaque, opaque], axis=1)[None])  # u may exceed 1
        low = np.floor(uv.min(axis=1) * (width, height)).astype(np.int64) - 1
        high = np.ceil(uv.max(axis=1) * (width, height)).astype(np.int64) + 1
        across = (low[:, 0] < 0) * width  # the texel before the first is the last
        x0, x1 = low[:, 0] + across, np.minimum(high[:, 0] + across, 2 * width)
        y0, y1 = low[:, 1].clip(0, height), high[:, 1].clip(0, height)
        return rectangle_sums(table, x0, y0, x1, y1, np.zeros(len(uv), dtype=np.int64)) > 0


def texture_of(layer: Layer, exposure: float) -> Texture:
    """The layer's radiance times `exposure`, clipped to 0 to 1 and encoded as sRGB; opaque.

    Of an equirectangular map only the rows that hold something of its domain, and a few beyond.

    Raises: ValueError for a layer without radiance, or with one that is NaN or infinite in its domain.
    """
    if layer.radiance is None:
        raise ValueError(f"{layer} has no radiance, so there is nothing to show on its surface")
    inside = layer.mask
    if not np.isfinite(layer.radiance[inside]).all():
        raise ValueError(f"{layer} has radiance that is NaN or infinite in its domain")
    if layer.mapping == CUBE_MAP:
        chart = CubeChart(layer.size[0] // 3, BORDER)
    else:
        chart = EquirectangularChart(layer.size[0], _rows(inside))
    linear = chart.texels(layer, spread(layer.radiance, inside, layer.mapping))
    pixels = np.full((*linear.shape[:2], 4), 255, dtype=np.uint8)
    pixels[..., :3] = srgb_codes(linear, exposure)
    return Texture(layer.name, pixels, chart)


def spread(values: np.ndarray, inside: np.ndarray, mapping: str) -> np.ndarray:
    """The values (H, W, 3) of a map, outside of its domain those of the nearest pixel inside; float32.

    Farther than 16 px from the domain they are 0. On a cube map each face is spread for itself.
    """
    if inside.all():
        return values.astype(np.float32)
    found = np.zeros(values.shape, dtype=np.float32)
    if mapping == CUBE_MAP:
        size = len(inside) // 2
        for place in range(6):
            row, column = place // 3 * size, place % 3 * size
            face = np.s_[row : row + size, column : column + size]
            found[face] = _spread(values[face], inside[face])
        return found
    around = min(_SPREAD, inside.shape[1])
    wrapped = [np.pad(a, ((0, 0), (around, around), (0, 0))[: a.ndim], mode="wrap") for a in (values, inside)]
    return _spread(*wrapped)[:, around:-around]


def _surroundings(inside):
    """Where (H, W) a mask is within 16 px, round the seam too, as float32."""
    around = min(_SPREAD, inside.shape[1])
    wrapped = np.pad(inside.astype(np.uint8), ((0, 0), (around, around)), mode="wrap")
    side = 2 * _SPREAD + 1
    return cv2.dilate(wrapped, np.ones((side, side), np.uint8))[:, around:-around].astype(np.float32)


def _spread(values, inside):
    if not inside.any():
        return np.zeros(values.shape, dtype=np.float32)
    distance, labels = cv2.distanceTransformWithLabels(
        (~inside).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
    )
    nearest = np.zeros(labels.max() + 1, dtype=np.int64)
    nearest[labels[inside]] = np.flatnonzero(inside)
    spread = values.reshape(-1, values.shape[-1])[nearest[labels]]
    return np.where((distance <= _SPREAD)[..., None], spread, 0).astype(np.float32)


def _rows(inside):
    """First and number of the rows that hold something of the domain, and of those to which it is spread.

    A power of two, where the map has so many: old graphics cards make mip levels of no other textures.
    """
    rows, height = np.flatnonzero(inside.any(axis=1)), len(inside)
    first, last = max(rows[0] - _SPREAD, 0), min(rows[-1] + _SPREAD, height - 1)
    count = min(1 << int(last - first).bit_length(), height)
    return int(min(first, height - count)), count
