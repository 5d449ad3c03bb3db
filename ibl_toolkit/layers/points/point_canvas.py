"""Where samples are gathered: a band of a picture's rows with a rim, and what is made of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ..panorama import Layer, LayeredPanorama
from ..views.pinhole import Pinhole
from ..views.rendered_view import RenderedView, far_view
from ..views.visible_tiles import Tiles, frustum
from .neighbourhoods import Neighbourhoods, neighbourhoods
from .point_filter import filtered
from .subsampling import Samples

BLOCK = 3
"""Side of the blocks of section 7.3.1 [px]; a canvas has whole ones, and its rim is two of them."""
_RIM = 2 * BLOCK
_PIXELS = 1 << 21  # of a band at most, but for wide pictures: it bounds the memory
_FILTER = 0.75  # [px], the radius printed for Fig. 7-7; the thesis allows 0.5 to 1


@dataclass(frozen=True, eq=False)
class Canvas:
    """Pixels of a picture's rows `first` to `end`, and of a rim round them.

    camera: in the panorama's frame. Samples placed on it have (0, 0) in the corner of the rim.
    """

    camera: Pinhole
    first: int
    end: int

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns, multiples of BLOCK."""
        sides = (self.end - self.first + 2 * _RIM, self.camera.width + 2 * _RIM)
        return tuple(-(-side // BLOCK) * BLOCK for side in sides)

    def neighbourhoods(self, layer: Layer, tiles: Tiles) -> Iterator[Neighbourhoods]:
        """Those of a layer that may be seen on the canvas."""
        return neighbourhoods(layer, tiles, self.camera, frustum(self.camera, (self.first, self.end), _RIM))

    def placed(self, samples: Samples) -> tuple[Samples, np.ndarray]:
        """Those on the canvas, moved to its own coordinates, and the pixels (n,) they lie in, row-major."""
        rows, columns = self.shape
        xy = samples.xy + np.array([[_RIM], [_RIM - self.first]], dtype=np.float32)
        there = ((xy >= 0) & (xy < np.array([[columns], [rows]]))).all(axis=0)
        x, y = xy = xy[:, there]
        return Samples(xy, *(a[..., there] for a in (samples.near, samples.colours, samples.sources))), (
            y.astype(np.int32) * columns + x.astype(np.int32)
        )

    def sky(self, far: RenderedView) -> Samples:
        """A view of what lies at infinity as samples, one in the middle of each pixel that is no hole."""
        j, i = np.nonzero(~far.holes[self.first : self.end])
        colours = far.radiance[self.first : self.end][j, i].T
        xy = np.stack([i + 0.5, j + self.first + 0.5]).astype(np.float32)
        return Samples(xy, np.zeros(len(j), np.float32), colours, np.zeros(len(j), np.int64))

    def filtered(self, visible: Samples) -> RenderedView:
        """The view of the rows, without the rim, that visible samples make."""
        rows, columns = self.shape
        radiance, near = filtered(visible, _FILTER, columns, rows)
        inner = np.s_[_RIM : _RIM + self.end - self.first, _RIM : _RIM + self.camera.width]
        rays = self.camera.directions()[self.first : self.end] @ self.camera.axes[2]
        with np.errstate(divide="ignore"):
            return RenderedView(radiance[inner], (1 / (near[inner] * rays)).astype(np.float32))


def view_in_bands(
    panorama: LayeredPanorama,
    camera: Pinhole,
    visible_samples: Callable[[Canvas, list[tuple[Layer, Tiles]], Samples], Samples],
) -> RenderedView:
    """A view that is made band by band, each filtered from what `visible_samples` finds.

    That is called with a canvas, the layers with their tiles, and the samples at infinity.

    Raises: ValueError for a layer without radiance.
    """
    for layer in panorama.layers:
        if layer.radiance is None:
            raise ValueError(f"{layer} has no radiance: there is nothing to be seen of it")
    far = far_view(panorama, camera)
    layers = [(layer, Tiles(layer)) for layer in panorama.layers]
    height = max(1, _PIXELS // camera.width)
    bands = []
    for first in range(0, camera.height, height):
        canvas = Canvas(camera.in_panorama(panorama), first, min(first + height, camera.height))
        bands.append(canvas.filtered(visible_samples(canvas, layers, canvas.sky(far))))
    return RenderedView(
        np.concatenate([band.radiance for band in bands]), np.concatenate([band.depth for band in bands])
    )
