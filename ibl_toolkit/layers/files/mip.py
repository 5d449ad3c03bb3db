"""Mip levels: a layer at half its resolution, again and again.

Every pixel is made of the pixels of its 2 x 2 block that lie in the domain, and is in the domain if one of
them is: the levels cover what the layer covers. Depth is the harmonic mean, since 1/depth is what changes
linearly along a plane; infinity counts as 1/depth = 0.

Source: thesis, section 6.2.3.1, which names mip maps and leaves the filter open.
"""

from __future__ import annotations

import numpy as np

from ..panorama import CUBE_MAP, Layer


def mip_levels(layer: Layer, count: int) -> list[Layer]:
    """The layer and up to count - 1 halvings of it; fewer where a map (or a cube's face) is of odd size.

    >>> depth = np.full((4, 8), 2.0, np.float32)
    >>> [level.size for level in mip_levels(Layer("wall", "equirectangular", {"depth": depth}), 9)]
    [(8, 4), (4, 2), (2, 1)]
    """
    levels = [layer]
    while len(levels) < count and _side(levels[-1]) % 2 == 0:
        levels.append(halved(levels[-1]))
    return levels


def halved(layer: Layer) -> Layer:
    """The layer at half its resolution.

    Raises: ValueError for a map, or a face of a cube, of odd size.
    """
    if _side(layer) % 2:
        raise ValueError(f"{layer} of {layer.size[0]} x {layer.size[1]} px cannot be halved")
    inside = _blocks(layer.mask)
    attributes = {name: _reduced(name, _blocks(values), inside) for name, values in layer.attributes.items()}
    return Layer(layer.name, layer.mapping, attributes)


def _side(layer):
    return layer.size[1] // 2 if layer.mapping == CUBE_MAP else layer.size[1]


def _blocks(values):
    """The four pixels of every block, (4, H/2, W/2, …)."""
    return np.stack([values[j::2, i::2] for j in (0, 1) for i in (0, 1)])


def _reduced(name, blocks, inside):
    if name == "mask":
        return inside.any(axis=0)
    if name == "material index":
        first = np.argmax(inside, axis=0)  # indices have no mean: the first of the domain
        return np.take_along_axis(blocks, first[None], axis=0)[0]
    if name == "depth":
        with np.errstate(divide="ignore"):
            return (1 / _mean(1 / blocks.astype(np.float64), inside, np.nan)).astype(blocks.dtype)
    mean = _mean(blocks, inside[..., None] if blocks.ndim == 4 else inside)
    if name == "normals":
        length = np.linalg.norm(mean, axis=-1, keepdims=True)
        mean = np.divide(mean, length, out=mean, where=length > 0)
    return mean.astype(blocks.dtype)


def _mean(blocks, inside, outside=0.0):
    """Mean over the domain; `outside` where a block has nothing of it."""
    count = inside.sum(axis=0)
    total = np.where(inside, blocks, 0).sum(axis=0)
    return np.divide(total, count, out=np.full_like(total, outside), where=count > 0)
