"""Where the ball of a photograph is: by a marker, by points of its outline, or by its outline's edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .ball import Ball
from .errors import ProbeError
from .outline import measure_outline, outline_from_points
from .outline_search import find_outline
from .samples import visible_share

SURE_COVERAGE = 0.6
"""Of a measured outline that may contradict the marker."""
_OFF_PX, _OFF = 2.0, 0.06  # px, and part of the radius, by which marker and outline may differ
_ROUGH_PX = 1.0
_THIN_COVERAGE = 0.6


@dataclass(frozen=True, eq=False)
class PlacedBall:
    """ball: [m] where is_metric, else in radii. by: `marker`, `points` or `edges`.

    residual_px: rms distance of outline's points from it; of a ball by its marker, how far off that puts its
    outline; NaN where no outline is seen. coverage: share of the outline that is seen; NaN likewise.
    """

    ball: Ball
    by: str
    is_metric: bool
    residual_px: float
    coverage: float
    warnings: tuple[str, ...]


def place_ball(photo, camera, *, pose=None, radius=None, centre=None, points=None) -> PlacedBall:
    """The ball in a photograph.

    pose: a MarkerPose, and centre (3,) [m] of the ball in its frame: the ball is where the marker says.
    points (n ≥ 3, 2) [px]: its outline goes through them. With neither, the outline is looked for. radius
    [m]: of the ball; without it, distances are told in radii.

    Raises: ProbeError for a centre without marker or radius, for centre and points together, and where no
    outline is seen or what is given fits no ball.
    """
    if centre is not None:
        if pose is None or radius is None:
            missing = "a marker" if pose is None else "its radius"
            raise ProbeError(f"the ball's centre is given in the marker's frame: {missing} is needed too")
        if points is not None:
            raise ProbeError(
                "the ball's centre and points of its outline: only one of them can say where it is"
            )
        return _by_marker(photo, camera, Ball(pose.to_camera(centre), float(radius)))
    if points is not None:
        outline, by = outline_from_points(camera, points), "points"
    else:
        outline, by = find_outline(photo.grey, photo.white_at_one, camera), "edges"
    ball = outline.ball if radius is None else outline.ball.scaled(radius)
    warnings = [*_cut(camera, ball), *_rough(outline, by)]
    return PlacedBall(ball, by, radius is not None, outline.residual_px, outline.coverage, tuple(warnings))


def _by_marker(photo, camera, ball):
    warnings = list(_cut(camera, ball))
    seen = measure_outline(photo.white_at_one, camera, ball)
    if seen is None:
        return PlacedBall(ball, "marker", True, float("nan"), float("nan"), tuple(warnings))
    off = float(np.linalg.norm(camera.pixels(seen.ball.axis) - camera.pixels(ball.axis)))
    width = camera.pixels(ball.outline())
    radius = float(np.mean(np.nanmax(width, axis=0) - np.nanmin(width, axis=0)) / 2)
    if seen.coverage >= SURE_COVERAGE and off > max(_OFF_PX, _OFF * radius):
        warnings.append(
            f"the ball's outline is seen {off:.1f} px beside where the marker puts it: check its place "
            "and radius, the marker's side and the field of view"
        )
    return PlacedBall(ball, "marker", True, off, seen.coverage, tuple(warnings))


def _cut(camera, ball):
    share = visible_share(camera, ball)
    if share < 1:
        yield f"the frame cuts the ball: {share:.0%} of its outline is in it, lights in the rest are missed"


def _rough(outline, by):
    if outline.residual_px > _ROUGH_PX:
        what = (
            "the points of the ball's outline are"
            if by == "points"
            else "the ball's outline is seen roughly,"
        )
        yield f"{what} {outline.residual_px:.1f} px off it: give points of it anew"
    if outline.coverage < _THIN_COVERAGE:
        yield (
            f"{outline.coverage:.0%} of the ball's outline is seen: look whether it is the ball's, or give "
            "points of it"
        )
