"""Views of a layered panorama by regular samples, refined where blocks of the picture show two surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ..panorama import LayeredPanorama
from ..views.pinhole import Pinhole
from ..views.rendered_view import RenderedView
from .point_canvas import BLOCK, Canvas, view_in_bands
from .point_visibility import SAME_SURFACE, Nearest
from .subsampling import Samples, counts_needed, samples_within

_SPACING = 1.0  # px: where a layer's pixels lie further apart, there are several samples in each
_FINER_SPACING = 0.5  # px, in blocks that are refined


def splat_view(panorama: LayeredPanorama, camera: Pinhole) -> RenderedView:
    """See a panorama through a camera in the world, by direct sampling with refinement at discontinuities.

    Source: thesis, 7.3.1, and 7.3.1.1, Alg. 9. It wants layers no coarser than the picture: pixels that lie
    further apart in it have several samples here, as in Alg. 10. What it asks of layers is asked of surfaces
    here: one layer may have several, one behind the other.

    Raises: ValueError for a layer without radiance.
    """
    return view_in_bands(panorama, camera, _visible_samples)


def _visible_samples(canvas, layers, sky):
    found = [_first_samples(canvas, layer, tiles) for layer, tiles in layers]
    found.append(_Placed.on(canvas, sky))
    refined = _with_neighbours(
        _unresolved(canvas, _nearest_in_blocks(canvas, found), found), _block_grid(canvas)
    )
    for number, (layer, tiles) in enumerate(layers):
        coarse = found[number].chosen(~refined[found[number].blocks])
        found[number] = _Placed.joined([coarse, *_finer_samples(canvas, layer, tiles, refined)])
    return _resolved(canvas, found)


@dataclass(frozen=True, eq=False)
class _Placed:
    """Samples of a layer on a canvas, the pixels (n,) and the blocks (n,) they lie in, row-major."""

    samples: Samples
    pixels: np.ndarray
    blocks: np.ndarray

    @classmethod
    def on(cls, canvas: Canvas, samples: Samples) -> _Placed:
        samples, pixels = canvas.placed(samples)
        columns = canvas.shape[1]
        row, column = np.divmod(pixels, columns)
        return cls(samples, pixels, row // BLOCK * (columns // BLOCK) + column // BLOCK)

    @classmethod
    def joined(cls, parts: list[_Placed]) -> _Placed:
        return cls(
            Samples.joined([part.samples for part in parts]),
            np.concatenate([part.pixels for part in parts]),
            np.concatenate([part.blocks for part in parts]),
        )

    def chosen(self, which) -> _Placed:
        return _Placed(self.samples[which], self.pixels[which], self.blocks[which])


def _first_samples(canvas, layer, tiles):
    """Steps 1 to 3: regular samples of what may be seen of a layer, projected."""
    parts = [_Placed.on(canvas, Samples.none())]
    for around in canvas.neighbourhoods(layer, tiles):
        counts = counts_needed(around, canvas.camera, _SPACING)
        samples = samples_within(layer, around, canvas.camera, *counts)
        parts += [_Placed.on(canvas, some) for some in samples]
    return _Placed.joined(parts)


def _finer_samples(canvas, layer, tiles, refined):
    """Step 6: denser samples of the layer in blocks that are flagged."""
    parts = []
    for around in canvas.neighbourhoods(layer, tiles):
        counts = counts_needed(around, canvas.camera, _SPACING)
        hit = np.zeros(len(around), dtype=bool)
        for some in samples_within(layer, around, canvas.camera, *counts):
            placed = _Placed.on(canvas, some)
            hit[placed.samples.sources[refined[placed.blocks]]] = True
        around = around[hit]
        counts = counts_needed(around, canvas.camera, _FINER_SPACING)
        for some in samples_within(layer, around, canvas.camera, *counts):
            placed = _Placed.on(canvas, some)
            parts.append(placed.chosen(refined[placed.blocks]))
    return parts


def _nearest_in_blocks(canvas, found):
    nearest = Nearest.of_cells(np.prod(_block_grid(canvas)))
    for number, placed in enumerate(found):
        nearest.add(number, placed.blocks, placed.samples.near)
    return nearest


def _unresolved(canvas, nearest, found):
    """Steps 4 and 5: blocks (n,) that show several surfaces and are not amid the nearest of them."""
    several = np.zeros(len(nearest.near), dtype=bool)
    for number, placed in enumerate(found):
        several[placed.blocks[~nearest.is_nearest(number, placed.blocks, placed.samples.near)]] = True
    return several & ~_amid_one_surface(nearest, _block_grid(canvas))


def _amid_one_surface(nearest, grid):
    """Blocks (n,) whose nearest sample is of the same surface as those of their 8 neighbours, or fewer."""
    near, layer = (
        np.pad(values.reshape(grid), 1, constant_values=-1) for values in (nearest.near, nearest.layer)
    )
    own_near, own_layer = near[1:-1, 1:-1], layer[1:-1, 1:-1]
    amid = np.ones(grid, dtype=bool)
    for row in range(3):
        for column in range(3):
            part = np.s_[row : row + grid[0], column : column + grid[1]]
            alike = (near[part] * SAME_SURFACE >= own_near) & (own_near * SAME_SURFACE >= near[part])
            amid &= (layer[part] < 0) | ((layer[part] == own_layer) & alike)
    return amid.reshape(-1)


def _with_neighbours(flags, grid):
    """Blocks (n,) that are flagged or one of whose 8 neighbours is."""
    return cv2.dilate(flags.reshape(grid).astype(np.uint8), np.ones((3, 3), np.uint8)).reshape(-1) > 0


def _resolved(canvas, found):
    """Steps 5 and 7: of each layer's samples those that are seen, block by block or, failing that, by pixel.

    A pixel where the nearest surface of its block has no sample, in a notch of it, is judged by itself.
    """
    in_blocks, in_pixels = _nearest_in_blocks(canvas, found), Nearest.of_cells(np.prod(canvas.shape))
    by_block = [in_blocks.is_nearest(k, placed.blocks, placed.samples.near) for k, placed in enumerate(found)]
    notches = np.ones(len(in_pixels.near), dtype=bool)
    for number, placed in enumerate(found):
        notches[placed.pixels[by_block[number]]] = False
        in_pixels.add(number, placed.pixels, placed.samples.near)
    unresolved = _unresolved(canvas, in_blocks, found)
    seen = []
    for number, placed in enumerate(found):
        by_pixel = in_pixels.is_nearest(number, placed.pixels, placed.samples.near)
        alone = unresolved[placed.blocks] | notches[placed.pixels]
        seen.append(placed.samples[np.where(alone, by_pixel, by_block[number])])
    return Samples.joined(seen)


def _block_grid(canvas):
    return tuple(side // BLOCK for side in canvas.shape)
