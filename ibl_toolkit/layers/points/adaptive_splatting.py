"""Views of a layered panorama by samples, as many in each pixel as its neighbours lie apart in the view."""

from __future__ import annotations

from ..panorama import LayeredPanorama
from ..views.pinhole import Pinhole
from ..views.rendered_view import RenderedView
from .point_canvas import view_in_bands
from .point_visibility import Nearest
from .subsampling import Samples, counts_needed, samples_within

_SPACING = 1.0  # px: no pixel of a surface is without a sample of it
_TIDIED = 1 << 21  # so many samples more, and those that turned out to be hidden are left out


def adaptive_view(panorama: LayeredPanorama, camera: Pinhole) -> RenderedView:
    """See a panorama through a camera in the world, by samples adapted to the 8-neighbourhood.

    Source: thesis, 7.3.2, Alg. 10, whose m_h x m_v are those of `counts_needed`. Of samples of the nearest
    sample's layer in a pixel those on another surface behind it are left out, too.

    Raises: ValueError for a layer without radiance.
    """
    return view_in_bands(panorama, camera, _visible_samples)


def _visible_samples(canvas, layers, sky):
    rows, columns = canvas.shape
    nearest, found, held, most = Nearest.of_cells(rows * columns), [], 0, _TIDIED
    for number, (layer, tiles) in enumerate(layers):
        for around in canvas.neighbourhoods(layer, tiles):
            counts = counts_needed(around, canvas.camera, _SPACING)
            for samples in samples_within(layer, around, canvas.camera, *counts):
                samples, pixels = canvas.placed(samples)
                nearest.add(number, pixels, samples.near)
                found.append((number, pixels, samples))
                held += len(samples)
                if held > most:
                    found = _visible(nearest, found)
                    held = sum(len(samples) for _, _, samples in found)
                    most = 2 * held + _TIDIED
    sky, pixels = canvas.placed(sky)
    nearest.add(len(layers), pixels, sky.near)
    found.append((len(layers), pixels, sky))
    return Samples.joined([samples for _, _, samples in _visible(nearest, found)])


def _visible(nearest, found):
    """Of samples by layer and pixel those that are seen, as far as it is known."""
    seen = []
    for number, pixels, samples in found:
        which = nearest.is_nearest(number, pixels, samples.near)
        seen.append((number, pixels[which], samples[which]))
    return seen
