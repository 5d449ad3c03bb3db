"""Samples of a layer within its pixels, as many as a picture needs to be covered."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..panorama import Layer
from ..views.pinhole import Pinhole
from .neighbourhoods import Neighbourhoods

_MOST = 1 << 19  # samples per step
_ABOVE, _LEFT, _MIDDLE, _RIGHT, _BELOW = 1, 3, 4, 5, 7


@dataclass(frozen=True, eq=False)
class Samples:
    """Points (n) of surfaces in a picture.

    xy: (2, n) [px], pixel centres at +0.5. near: (n) 1/distance along the camera's forward [1/m]. colours:
    (3, n). sources: (n) which of the neighbourhoods they were taken from.
    """

    xy: np.ndarray
    near: np.ndarray
    colours: np.ndarray
    sources: np.ndarray

    def __len__(self):
        return len(self.near)

    def __getitem__(self, which) -> Samples:
        return Samples(self.xy[:, which], self.near[which], self.colours[:, which], self.sources[which])

    @staticmethod
    def none() -> Samples:
        """Not one."""
        return Samples(
            np.empty((2, 0), np.float32),
            np.empty(0, np.float32),
            np.empty((3, 0), np.float32),
            np.empty(0, np.int64),
        )

    @staticmethod
    def joined(parts: list[Samples]) -> Samples:
        """All of them as one."""
        names = ("xy", "near", "colours", "sources")
        return Samples(*(np.concatenate([getattr(part, name) for part in parts], axis=-1) for name in names))


def counts_needed(around: Neighbourhoods, camera: Pinhole, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """How many samples pixels (m) need across and down, so that every square of `spacing` px has one.

    With the steps u, v [px] in the picture to the neighbours in the map, the cells that n x m samples stand
    for are no larger than the square: |u_x|/n + |v_x|/m <= spacing, and the same in y. That is the m_h x m_v
    of Alg. 10 where the map's rows run along the picture's or at 45 degrees to them; it holds at all angles.
    """
    x, y = _projected(around.points, camera)
    u = [np.maximum(abs(k[_RIGHT] - k[_MIDDLE]), abs(k[_MIDDLE] - k[_LEFT])) for k in (x, y)]
    v = [np.maximum(abs(k[_BELOW] - k[_MIDDLE]), abs(k[_MIDDLE] - k[_ABOVE])) for k in (x, y)]
    longest_u, longest_v = (np.maximum(np.maximum(*k), 1e-6) for k in (u, v))
    shared = np.maximum(u[0] / longest_u + v[0] / longest_v, u[1] / longest_u + v[1] / longest_v)
    return tuple(
        _whole(k * shared / spacing, max(camera.width, camera.height)) for k in (longest_u, longest_v)
    )


def samples_within(
    layer: Layer, around: Neighbourhoods, camera: Pinhole, across: np.ndarray, down: np.ndarray
) -> Iterator[Samples]:
    """Regular samples of pixels (m), (m) across by (m) down in each; in batches, those before the camera.

    Homogeneous points and colours are interpolated bilinearly.
    """
    texels = layer.radiance.reshape(-1, 3)
    kinds, kind_of = np.unique(across * 65536 + down, return_inverse=True)
    order = np.argsort(kind_of, kind="stable")
    sizes = np.bincount(kind_of.reshape(-1), minlength=len(kinds))
    ends = np.cumsum(sizes)
    for kind, start, end in zip(kinds, ends - sizes, ends, strict=True):
        weights = _bilinear(*divmod(int(kind), 65536))
        step = max(1, _MOST // len(weights))
        for first in range(start, end, step):
            sources = order[first : min(first + step, end)]
            if len(weights) == 1:
                points = around.points[_MIDDLE][:, sources]
                colours = texels[around.texels[_MIDDLE, sources]].T
            else:
                points = _combined(weights, around.points[..., sources])
                colours = _combined(weights, np.moveaxis(texels[around.texels[:, sources]], 2, 1))
            yield _seen(points, colours, np.tile(sources, len(weights)), camera)


def _projected(points, camera):
    """Places x, y, each (9, m) [px]; NaN behind the eye."""
    distance = np.where(points[:, 2] > 0, points[:, 2], np.nan)
    return (camera.focal * points[:, axis] / distance for axis in (0, 1))


def _whole(counts, most):
    """Whole counts from 1 to `most`; large ones rounded up, so that there are fewer different ones.

    NaN, where a pixel lies across the plane of the eye and could be of any size, becomes an eighth of `most`.
    """
    counts = np.ceil(np.minimum(np.nan_to_num(counts, nan=most / 8), most)).astype(np.int64)
    coarse = np.where(counts > 64, 32, np.where(counts > 8, 4, 1))
    return np.maximum((counts + coarse - 1) // coarse * coarse, 1)


def _bilinear(across, down):
    """Weights (down * across, 9) of a pixel's neighbourhood at places spread evenly over it."""
    x, y = ((np.arange(n) + 0.5) / n - 0.5 for n in (across, down))
    x, y = (np.stack([np.maximum(-k, 0), 1 - abs(k), np.maximum(k, 0)], axis=1) for k in (x, y))
    return np.einsum("yj,xi->yxji", y, x).reshape(down * across, 9).astype(np.float32)


def _combined(weights, values):
    """Values (9, C, m) -> (C, k m)."""
    _, channels, count = values.shape
    combined = weights @ values.reshape(9, -1)
    return combined.reshape(len(weights), channels, count).swapaxes(0, 1).reshape(channels, -1)


def _seen(points, colours, sources, camera):
    before = points[2] > 0
    if not before.all():
        points, colours, sources = points[:, before], colours[:, before], sources[before]
    xy = points[:2] / points[2] * np.float32(camera.focal)
    xy += np.array([[camera.width / 2], [camera.height / 2]], dtype=np.float32)
    return Samples(xy, points[3] / points[2], colours, sources)
