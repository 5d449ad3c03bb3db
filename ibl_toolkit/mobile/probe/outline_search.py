"""The outline of a ball, looked for in a whole picture by its edges.

Candidates: cones through three pixels of one chain of edges. Each is judged by how much of its outline lies
on edges that run along it. The best ones are fitted anew to the pixels beside them, and of those that can be
measured, the one with the longest outline on edges is taken.
"""

from __future__ import annotations

import cv2
import numpy as np

from .ball import ball_from_rays
from .edges import noise_of
from .errors import ProbeError
from .outline import NEAR, Outline, measure_outline, outline_pixels, radius_px

LEAST_COVERAGE = 0.45
"""Of the outline that must lie on edges."""
LEAST_DIAMETER = 12
"""Of a ball's picture [px]; smaller ones are not looked for."""
_SMOOTH, _MOST_SMOOTH = 1.2, 2.5  # px, of a picture without noise, and of one with much
_QUIET = 4.0  # noise that needs no more smoothing, in codes
_CHAIN = 12  # pixels of a chain of edges, at least
_CHAINS = 160
_TRIPLES = 24
_SEED = 1
_SAMPLES = 120
_ALONG = np.cos(np.radians(25.0))
_BEST = 8
_LARGEST = 2.0  # diameters of the picture's shorter side


def find_outline(grey, luminance, camera) -> Outline:
    """The outline of the largest ball that edges show in a picture: grey (H, W) uint8, linear float32.

    Raises: ProbeError where none is seen.
    """
    edges = _Edges(grey)
    candidates = _candidates(edges, camera)
    if not candidates:
        raise ProbeError("no outline of a ball is seen: give points of it, or a marker and the ball's place")
    best = sorted(candidates, key=lambda ball: -_support(edges, camera, ball)[0])[:_BEST]
    refitted = [again for again in (_refitted(edges, camera, ball) for ball in best) if again is not None]
    for ball in sorted(refitted, key=lambda ball: -_support(edges, camera, ball)[0]):
        outline = measure_outline(luminance, camera, ball)
        if outline is not None and outline.coverage >= LEAST_COVERAGE:
            return outline
    raise ProbeError(
        "no outline of a ball is seen clearly: give points of it, or a marker and the ball's place"
    )


class _Edges:
    """Pixels on edges, where brightness rises there, and the nearest of them to every pixel."""

    def __init__(self, grey):
        noise = noise_of(grey.astype(np.float32))
        smooth = cv2.GaussianBlur(
            grey, (0, 0), float(np.clip(_SMOOTH * np.sqrt(noise / _QUIET), _SMOOTH, _MOST_SMOOTH))
        )
        dx, dy = cv2.Sobel(smooth, cv2.CV_16S, 1, 0), cv2.Sobel(smooth, cv2.CV_16S, 0, 1)
        strength = np.hypot(dx.astype(np.float32), dy)
        high = float(np.clip(np.percentile(strength, 96), 16, 160))
        self.map = cv2.Canny(dx, dy, 0.4 * high, high, L2gradient=True)
        length = np.maximum(strength, 1e-6)
        self.across = np.stack([dx / length, dy / length], axis=-1)
        self.shape = grey.shape
        away, labels = cv2.distanceTransformWithLabels(
            255 - self.map, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
        )
        self.distance = away
        rows, columns = np.nonzero(self.map)
        place = np.zeros((labels.max() + 1, 2), np.int64)
        place[labels[rows, columns]] = np.stack([columns, rows], axis=1)
        self.nearest = place[labels]

    def chains(self):
        """Pixels (n, 2), x and y, of each chain, the longest first."""
        count, labels, statistics, _ = cv2.connectedComponentsWithStats(self.map, connectivity=8)
        sizes = statistics[:, cv2.CC_STAT_AREA]
        rows, columns = np.nonzero(self.map)
        order = np.argsort(labels[rows, columns], kind="stable")
        ends = np.cumsum(sizes[1:])[:-1]
        chains = np.split(np.stack([columns, rows], axis=1)[order], ends) if count > 1 else []
        return sorted((chain for chain in chains if len(chain) >= _CHAIN), key=len, reverse=True)[:_CHAINS]


def _candidates(edges, camera):
    random = np.random.default_rng(_SEED)
    found = []
    for chain in edges.chains():
        rays = camera.rays(chain + 0.5)
        tries = _TRIPLES * (1 + len(chain) // 150)
        for _ in range(tries):
            # A stretch of the chain: the whole may run on along the table.
            extent = int(len(chain) * random.choice((1.0, 0.6, 0.3)))
            middle = chain[random.integers(len(chain))]
            near = np.argsort(np.abs(chain - middle).max(axis=1), kind="stable")[: max(extent, _CHAIN)]
            three = random.choice(near, 3, replace=False)
            ball = _ball_through(rays[three], camera)
            if ball is not None and _support(edges, camera, ball)[1] > LEAST_COVERAGE / 3:
                found.append(ball)
    return found


def _ball_through(rays, camera):
    if abs(np.linalg.det(rays)) < 1e-9:
        return None
    try:
        ball = ball_from_rays(rays)
    except ProbeError:
        return None
    if ball.centre[2] < 0.2 * ball.distance or ball.angular_radius > 1.0:
        return None
    diameter = 2 * radius_px(camera, ball)
    return ball if LEAST_DIAMETER <= diameter <= _LARGEST * min(camera.width, camera.height) else None


def _support(edges, camera, ball):
    """Length [px] and share of a ball's outline that lies on edges along it."""
    xy, outward = outline_pixels(camera, ball, _SAMPLES)
    inside = camera.is_inside(xy)
    columns, rows = np.minimum(xy[inside].astype(int), (camera.width - 1, camera.height - 1)).T
    nearest = edges.nearest[rows, columns]
    across = edges.across[nearest[:, 1], nearest[:, 0]]
    # Any distance up to NEAR counts, the nearer ones more: of two outlines on one edge, the one along it.
    near = np.clip(1.5 - edges.distance[rows, columns] / NEAR, 0, 1)
    along = np.abs(np.sum(across * outward[inside], axis=1)) > _ALONG
    share = float(np.sum(near * along) / _SAMPLES)
    return share**2 * 2 * np.pi * radius_px(camera, ball), share


def _refitted(edges, camera, ball):
    """A ball fitted to the pixels of edges along its outline, a few times over."""
    for near in (3 * NEAR, 2 * NEAR, NEAR, NEAR):
        xy, outward = outline_pixels(camera, ball, 3 * _SAMPLES)
        inside = camera.is_inside(xy)
        columns, rows = np.minimum(xy[inside].astype(int), (camera.width - 1, camera.height - 1)).T
        nearest = edges.nearest[rows, columns]
        along = np.abs(np.sum(edges.across[nearest[:, 1], nearest[:, 0]] * outward[inside], axis=1)) > _ALONG
        chosen = np.unique(nearest[along & (edges.distance[rows, columns] < near)], axis=0)
        try:
            ball = ball_from_rays(camera.rays(chosen + 0.5))
        except ProbeError:
            return None
    return ball
