"""Views of a layered panorama by samples, as many in each pixel as its neighbours lie apart in the view."""

from __future__ import annotations

from .panorama import LayeredPanorama
from .pinhole import Pinhole
from .point_canvas import view_in_bands
from .point_visibility import Nearest
from .rendered_view import RenderedView
from .subsampling import Samples, counts_needed, samples_within

_SPACING = 1.0  # px: no pixel of a surface is without a sample of it


def adaptive_view(panorama: LayeredPanorama, camera: Pinhole, *, filter_radius: float = 0.75) -> RenderedView:
    """See a panorama through a camera in the world, by samples adapted to the 8-neighbourhood.

    filter_radius: [px], 0.5 to 1; the thesis has 0.75.

    Source: thesis, 7.3.2, Alg. 10, whose m_h x m_v are those of `counts_needed`. Of samples of the nearest
    sample's layer in a pixel those on another surface behind it are left out, too.

    Raises: ValueError for a layer without radiance and for a radius outside of 0.5 to 1 px.
    """
    return view_in_bands(panorama, camera, filter_radius, _visible_samples)


def _visible_samples(canvas, layers, sky):
    rows, columns = canvas.shape
    nearest, found = Nearest.of_cells(rows * columns), []
    for number, (layer, tiles) in enumerate(layers):
        for around in canvas.neighbourhoods(layer, tiles):
            counts = counts_needed(around, canvas.camera, _SPACING)
            for samples in samples_within(layer, around, canvas.camera, *counts):
                samples, pixels = canvas.placed(samples)
                nearest.add(number, pixels, samples.near)
                kept = nearest.reaches(pixels, samples.near)  # so far: it saves memory
                found.append((number, pixels[kept], samples[kept]))
    sky, pixels = canvas.placed(sky)
    nearest.add(len(layers), pixels, sky.near)
    found.append((len(layers), pixels, sky))
    return Samples.joined(
        [samples[nearest.is_nearest(number, pixels, samples.near)] for number, pixels, samples in found]
    )
