"""Layers sorted into classes, and put in the order in which they may hide each other.

Source: thesis, section 6.2.4, whose strategies start from layers that depth alone has parted.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..panorama import Layer, LayeredPanorama
from .classification import by_depth, flattened, with_infinity
from .geometry import by_geometry
from .visibility_order import VisibilityOrder, visibility_order

_LARGE = 0.1


@dataclass(frozen=True)
class Classes:
    """What layers are sorted by.

    depths: distances [m], ascending, at which each layer is parted (6.2.4.1). geometry: whether
    large layers are parted into lights, floor, ceiling, walls and the rest (6.2.4.2). infinity: whether what
    moves by less than a pixel goes to a layer at infinity (6.2.4.3). flat: whether thin ranges become one
    distance or one plane (6.2.4.3).
    """

    depths: tuple[float, ...] = ()
    geometry: bool = False
    infinity: bool = False
    flat: bool = False

    def __bool__(self):
        return bool(self.depths or self.geometry or self.infinity or self.flat)


def sorted_layers(panorama: LayeredPanorama, classes: Classes) -> tuple[LayeredPanorama, VisibilityOrder]:
    """The panorama's layers by classes, from back to front, and which of them may hide which (6.2.4.4).

    Parts have the layer's name and the class's: "background, floor", "front 1, to 2 m". Large is a layer with
    a tenth of its map's pixels at a finite depth: a room is, and its floor alone; a sofa, whose seat is not
    the floor, is not.

    Raises: ValueError for depths that are not above 0, finite and ascending.

    >>> depth = np.where(np.arange(16) < 8, 2.0, 5.0) * np.ones((8, 1))
    >>> room = Layer("room", "equirectangular", {"depth": depth})
    >>> found, _ = sorted_layers(LayeredPanorama((room,), np.eye(3), np.zeros(3), 1), Classes(depths=(3,)))
    >>> [layer.name for layer in found.layers]
    ['room, from 3 m', 'room, to 3 m']
    """
    if classes.infinity:
        panorama = with_infinity(panorama)
    layers = list(panorama.layers)
    if classes.geometry:
        turn = panorama.world_from_panorama
        layers = [
            part for layer in layers for part in (by_geometry(layer, turn) if _large(layer) else [layer])
        ]
    if classes.depths:
        layers = [part for layer in layers for part in _by_depth(layer, classes.depths)]
    if classes.flat:
        layers = [flattened(layer, panorama.radius) for layer in layers]
    found = replace(panorama, layers=tuple(layers))
    order = visibility_order(found)
    by_name = {layer.name: layer for layer in layers}
    return replace(found, layers=tuple(by_name[name] for name in order.order)), order


def _by_depth(layer: Layer, depths):
    """Its parts; what is at infinity as a whole stays as it is."""
    return by_depth(layer, depths) if _finite(layer).any() else [layer]


def _large(layer):
    return _finite(layer).mean() >= _LARGE


def _finite(layer):
    return layer.mask & np.isfinite(layer.depth)
