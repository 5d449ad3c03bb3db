"""The panorama set of the closed room: picks as an artist would click them, by projecting known points."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..ibl_toolkit import equirectangular
from ..ibl_toolkit.calibration.picks import CalibrationPicks, Rectangle
from ..ibl_toolkit.panorama_set import PanoramaSet, Shape
from . import closed_room as room


def closed_room_set(
    image: Path, panorama_from_world: np.ndarray | None = None, click_error: float = 0.0
) -> PanoramaSet:
    """Return the set of a panorama of the room.

    ``panorama_from_world`` (3, 3): how the camera was held, level by default; ``click_error``: standard
    deviation of each pick in u and v, as a share of the image's width.
    """
    clicks = _Clicks(np.eye(3) if panorama_from_world is None else panorama_from_world, click_error)
    rug = clicks(_level(_corners(room.RUG_CENTRE, room.RUG_SIZE)))
    wall = clicks(
        [(room.floor_corners()[1][0], y, z) for y, z in ((-1.1, 0.9), (0.3, 0.9), (0.3, 2.1), (-1.1, 2.1))]
    )
    picks = CalibrationPicks(
        rectangles=(Rectangle(rug, "FLOOR"), Rectangle(wall, "WALL")), camera_height=room.CAMERA_HEIGHT
    )
    corners = room.floor_corners()
    shapes = (
        Shape("floor", "polygon", clicks(_level(corners)), role="SUPPORT"),
        Shape(
            "walls",
            "walls",
            of="floor",
            top=clicks([(*corners[2], room.SIZE[2])])[0],
            ceiling=True,
            role="ENVIRONMENT",
        ),
        _box(clicks, room.TABLE, "SUPPORT"),
        _box(clicks, room.CABINET, "ENVIRONMENT"),
        _column(clicks),
    )
    return PanoramaSet(image=Path(image), calibration=picks, shapes=shapes)


class _Clicks:
    """Projects world points (n, 3) [m] to picks (n, 2), with the same random errors every time."""

    def __init__(self, panorama_from_world, click_error):
        self._rotation, self._error = np.asarray(panorama_from_world), click_error
        self._random = np.random.default_rng(2016)

    def __call__(self, points):
        seen = np.asarray(points, float) - (0, 0, room.CAMERA_HEIGHT)
        uv = equirectangular.uv_from_direction(seen @ self._rotation.T)
        return uv + self._random.normal(0, 1, uv.shape) * self._error * (1, 2)


def _box(clicks, box: room.Box, role: str) -> Shape:
    """Nearest side first, as an artist clicks the sides that show."""
    corners = _corners(box.centre, box.size[:2], box.turn)
    nearest = int(np.argmin(np.linalg.norm(corners, axis=1)))
    order = [nearest, (nearest + 1) % 4, (nearest + 2) % 4]
    top = clicks([(*corners[nearest], box.size[2])])[0]
    return Shape(box.name, "box", clicks(_level(corners[order])), top=top, role=role)


def _column(clicks) -> Shape:
    """Three points of the base's near half; the top straight above where the base is first met."""
    centre = np.array(room.COLUMN_CENTRE)
    towards = -centre / np.linalg.norm(centre)
    across = np.array([-towards[1], towards[0]])
    base = [
        centre + room.COLUMN_RADIUS * (c * towards + s * across)
        for c, s in ((0.1, 0.995), (1, 0), (0.1, -0.995))
    ]
    return Shape(
        "column",
        "cylinder",
        clicks(_level(base)),
        top=clicks([(*base[1], room.COLUMN_HEIGHT)])[0],
        role="ENVIRONMENT",
    )


def _corners(centre, size, turn=0.0):
    """Corners (4, 2) of a rectangle on the floor, counter-clockwise from its own (−, −) corner."""
    signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return np.asarray(centre) + (signs * np.asarray(size) / 2) @ rotation.T


def _level(points):
    """Floor points (n, 2) as (n, 3)."""
    return np.column_stack([np.asarray(points, float), np.zeros(len(points))])
