"""The camera that stands where the light is: orthographic for the sun, perspective for a lamp."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .settings import ShadowSettings

TEXTURE_FROM_CLIP = np.array([[0.5, 0, 0, 0.5], [0, 0.5, 0, 0.5], [0, 0, 0.5, 0.5], [0, 0, 0, 1]])
"""The bias matrix: from clip space, −1 to 1, to what textures and depth buffers have, 0 to 1."""
WIDEST = float(np.tan(np.radians(75)))
"""Tangent of half the angle beyond which a lamp's map has no use: its texels differ by 1 : 15 and more."""
_MARGIN = 0.02  # of the map's half width, for filters at the scene's border
_NEAREST = 1e-3  # of far: a depth buffer with less has no steps left for what is far
_AIMS = 4  # until the middle of what a lamp sees is in the middle of its map
_FLAT = 1e-3  # of the scene's size: the least width and depth of what a map covers


@dataclass(frozen=True, eq=False)
class LightCamera:
    """Where the light looks from, and how far.

    eye: (3,) [m]. axes: (3, 3) rotation, its rows right, up and forward (away from the light), in the world.
    half_width, half_height: of what the map covers [m]; if ``perspective``, tangents of half its angles.
    near, far: [m] along forward from the eye; what lies outside throws no shadow.

    Raises: ValueError for axes that are no rotation, sizes that are not above 0, an empty range of depths,
    and a perspective camera whose near is not above 0.
    """

    eye: np.ndarray
    axes: np.ndarray
    perspective: bool
    half_width: float
    half_height: float
    near: float
    far: float

    def __post_init__(self):
        if np.shape(self.eye) != (3,) or not np.isfinite(self.eye).all():
            raise ValueError(f"light's eye {np.asarray(self.eye).tolist()} must be three finite numbers")
        if np.shape(self.axes) != (3, 3) or not np.allclose(self.axes @ self.axes.T, np.eye(3), atol=1e-6):
            raise ValueError(f"light's axes {np.asarray(self.axes).tolist()} must be a (3, 3) rotation")
        if not (self.half_width > 0 and self.half_height > 0):
            raise ValueError(f"light's half sizes {self.half_width}, {self.half_height} must be above 0")
        if not self.near < self.far < np.inf:
            raise ValueError(f"light's range of depths {self.near} to {self.far} m must be finite, not empty")
        if self.perspective and not self.near > 0:
            raise ValueError(f"lamp's nearest depth {self.near} m must be above 0")

    @classmethod
    def of_sun(cls, direction, points: np.ndarray) -> LightCamera:
        """A sun in ``direction`` (3,), to the light, whose map just covers points (n, 3) [m].

        Raises ValueError for no points or such as are not finite, and a direction without one.

        >>> noon = LightCamera.of_sun((0, 0, 1), np.array([[-1.0, -1, 0], [1, 1, 2]]))
        >>> noon.texture(np.array([[0.0, 0, 2], [0, 0, 0]])).round(2)  # s, t, and the depth r
        array([[0.5 , 0.5 , 0.01],
               [0.5 , 0.5 , 0.99]])
        """
        points = _scene(points)
        axes = _axes(-np.asarray(direction, dtype=np.float64), "sun's direction", direction)
        places = points @ axes.T
        low, high = places.min(axis=0), places.max(axis=0)
        least = _FLAT * max(np.linalg.norm(high - low), 1e-6)
        half = np.maximum((high - low) / 2, least) * (1 + _MARGIN)
        eye = (low + high) / 2 @ axes
        eye = eye - half[2] * axes[2]
        return cls(eye, axes, False, float(half[0]), float(half[1]), 0.0, float(2 * half[2]))

    @classmethod
    def of_lamp(cls, position, points: np.ndarray) -> LightCamera:
        """A lamp at ``position`` (3,) [m] that looks at points (n, 3) [m], over 150° at most.

        A lamp among the points does not see what is beside and behind it: `ShadowMap.warnings` says so.
        Raises ValueError for no points or such as are not finite, and where all are at the lamp.
        """
        points = _scene(points)
        eye = np.asarray(position, dtype=np.float64)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        axes = _axes(middle - eye, "lamp's position, at the middle of the scene:", position)
        for _ in range(_AIMS):
            places = (points - eye) @ axes.T
            if not (places[:, 2] > 0).all():
                break
            across = places[:, :2] / places[:, 2:]
            middle = (across.min(axis=0) + across.max(axis=0)) / 2
            axes = _turned(axes[2] + np.clip(middle, -1, 1) @ axes[:2], axes[1])
        places = (points - eye) @ axes.T
        far = float(places[:, 2].max()) * (1 + _MARGIN)
        if not far > 0:
            raise ValueError(f"lamp at {eye.tolist()} m must see a part of the scene before it")
        near = max(float(places[:, 2].min()) * (1 - _MARGIN), _NEAREST * far)
        before = places[places[:, 2] >= near]
        tangents = np.abs(before[:, :2] / before[:, 2:]).max(axis=0) if len(before) else np.full(2, WIDEST)
        half = np.clip(tangents * (1 + _MARGIN), _FLAT, WIDEST)
        return cls(eye, axes, True, float(half[0]), float(half[1]), near, max(far, near * (1 + _FLAT)))

    def with_border(self, settings: ShadowSettings) -> LightCamera:
        """Wider by a border of the filter's width, so that no blur ends at the map's border.

        >>> noon = LightCamera(np.array([0, 0, 4.0]), np.diag([-1.0, 1, -1]), False, 1, 1, 0, 4)
        >>> noon.with_border(ShadowSettings("vsm", 64, window=7)).half_width
        1.28
        """
        border = settings.window if settings.method != "hard" else 0
        wider = settings.resolution / max(settings.resolution - 2 * border, settings.resolution / 2)
        most = WIDEST if self.perspective else np.inf
        sizes = (min(half * wider, most) for half in (self.half_width, self.half_height))
        return replace(self, **dict(zip(("half_width", "half_height"), sizes, strict=True)))

    @property
    def light_from_world(self) -> np.ndarray:
        """(4, 4), to a frame with x right, y up, z backward, as GL's cameras have."""
        turn = self.axes * [[1], [1], [-1]]
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = turn, -turn @ self.eye
        return matrix

    @property
    def clip_from_light(self) -> np.ndarray:
        """(4, 4): what is between near and far is within −1 to 1 once divided by its fourth number."""
        near, far = self.near, self.far
        depth = far - near
        matrix = np.diag([1 / self.half_width, 1 / self.half_height, 0.0, 0.0])
        if self.perspective:
            matrix[2, 2:], matrix[3, 2] = [-(far + near) / depth, -2 * far * near / depth], -1.0
        else:
            matrix[2, 2:], matrix[3, 3] = [-2 / depth, -(far + near) / depth], 1.0
        return matrix

    @property
    def texture_from_world(self) -> np.ndarray:
        """(4, 4): bias matrix · projection · view, what fixed-function GL has in its texture coordinates."""
        return TEXTURE_FROM_CLIP @ self.clip_from_light @ self.light_from_world

    def texture(self, points: np.ndarray) -> np.ndarray:
        """(s, t, r) of points (n, 3): place on the map and depth, each from 0 to 1. NaN behind a lamp."""
        texture_from_world = self.texture_from_world
        places = np.asarray(points) @ texture_from_world[:, :3].T + texture_from_world[:, 3]
        return places[:, :3] / np.where(places[:, 3:] > 0, places[:, 3:], np.nan)

    def linear_depth(self, r: np.ndarray) -> np.ndarray:
        """Of depths r in 0 to 1, as a buffer has them: 0 at near, 1 at far, linear in metres."""
        if not self.perspective:
            return r
        return r * self.near / (self.far - r * (self.far - self.near))

    def to_light(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unit vectors (n, 3) from points to the light, and their distances (n,) [m], 1 for the sun."""
        if not self.perspective:
            return np.broadcast_to(-self.axes[2], np.shape(points)), np.ones(len(points))
        away = self.eye - points
        distance = np.linalg.norm(away, axis=1)
        return away / np.where(distance > 0, distance, 1.0)[:, None], distance


def _scene(points):
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"scene's points {points.shape} must be (n, 3)")
    if not len(points):
        raise ValueError("the scene is empty: there is nothing that could throw a shadow or receive one")
    if not np.isfinite(points).all():
        raise ValueError("the scene's points must be finite")
    return points


def _axes(forward, name, value):
    length = np.linalg.norm(forward) if np.shape(forward) == (3,) else 0.0
    if not 0 < length < np.inf:
        raise ValueError(
            f"{name} {np.asarray(value).tolist()} must be three finite numbers that give a direction"
        )
    return _turned(forward, (0.0, 0.0, 1.0) if abs(forward[2]) < 0.999 * length else (0.0, 1.0, 0.0))


def _turned(forward, upright):
    """Rows right, up and forward of a camera that looks along ``forward`` and has ``upright`` above."""
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, upright)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(right, forward), forward])
