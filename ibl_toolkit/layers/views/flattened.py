"""A layered panorama as one picture: in each direction what is nearest, seen from the origin."""

from __future__ import annotations

import numpy as np

from ... import equirectangular
from ..panorama import CUBE_MAP, LayeredPanorama
from .rendered_view import sampled

_BLOCK_ROWS = 256


def flattened(panorama: LayeredPanorama) -> np.ndarray:
    """Radiance (H, W, 3) float32, equirectangular, of the nearest layers; 0 where there is none.

    W is the largest width of the layers, of a cube map that of its four faces round the horizon.

    Raises: ValueError for a layer without radiance.

    >>> from ..panorama import Layer
    >>> grey = {"depth": np.full((2, 4), 3, np.float32), "radiance": np.full((2, 4, 3), 0.5, np.float32)}
    >>> back = Layer("back", "equirectangular", grey)
    >>> flattened(LayeredPanorama((back,), np.eye(3), np.zeros(3), 0.0)).shape
    (2, 4, 3)
    """
    for layer in panorama.layers:
        if layer.radiance is None:
            raise ValueError(f"{layer} has no radiance, so it cannot be seen")
    width = max(
        4 * (layer.size[0] // 3) if layer.mapping == CUBE_MAP else layer.size[0] for layer in panorama.layers
    )
    directions = equirectangular.pixel_directions(width, width // 2)
    picture = np.zeros((width // 2, width, 3), dtype=np.float32)
    nearest = np.full((width // 2, width), -1.0)  # 1/depth, of which the largest is the nearest
    for layer in panorama.layers:
        weights = layer.mask.astype(np.float32)
        near = np.divide(1, layer.depth, out=np.zeros_like(layer.depth), where=layer.mask)
        colours = np.where(layer.mask[..., None], layer.radiance, np.float32(0))
        for start in range(0, width // 2, _BLOCK_ROWS):
            rows = slice(start, start + _BLOCK_ROWS)
            weight, here = (sampled(layer, values, directions[rows]) for values in (weights, near))
            seen = (weight >= 0.5) & (here > nearest[rows] * weight)
            picture[rows][seen] = sampled(layer, colours, directions[rows][seen]) / weight[seen][:, None]
            nearest[rows][seen] = here[seen] / weight[seen]
    return picture
