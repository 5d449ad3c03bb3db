"""The direction of a light from a shadow on the marker's plane, where there is no ball."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .errors import ProbeError

LEAST_ALTITUDE_DEG = 5.0
"""Below, a shadow is more than eleven times as long as what casts it, and its tip is hard to see."""


@dataclass(frozen=True, eq=False)
class ShadowLight:
    """direction: (3,) unit vector to the light, frame `marker`. top, tip: (3,) [m], frame `marker`.

    uncertainty_deg: by which the direction changes where the shadow's tip is one pixel off [°].
    """

    direction: np.ndarray
    top: np.ndarray
    tip: np.ndarray
    uncertainty_deg: float
    warnings: tuple[str, ...]

    @property
    def altitude_deg(self) -> float:
        """Above the marker's plane [°]."""
        return float(np.degrees(np.arcsin(self.direction[2])))


def light_from_shadow(camera, pose, base, tip, height) -> ShadowLight:
    """The light that throws the shadow of the upper end of an upright edge to `tip`.

    base, tip: (2,) [px] of the edge's foot and of its end's shadow, both on the marker's plane. height: of
    the edge [m]; it stands at a right angle to the marker.

    Raises: ProbeError for a height that is not above 0, and for points at or above the plane's horizon.
    """
    if not (np.isfinite(height) and height > 0):
        raise ProbeError(f"height {height} m of what casts the shadow must be above 0")
    foot = _on_plane(camera, pose, base, "foot")
    end = _on_plane(camera, pose, tip, "shadow's tip")
    top = foot + np.array([0, 0, height])
    direction = _unit(top - end)
    off = [
        _unit(top - pose.on_plane(camera.rays(np.add(tip, d)))) for d in ((1, 0), (-1, 0), (0, 1), (0, -1))
    ]
    cosines = np.clip(np.array(off) @ direction, -1, 1)
    uncertainty = float(np.degrees(np.arccos(cosines)).max()) if np.isfinite(cosines).all() else 90.0
    altitude = np.degrees(np.arcsin(direction[2]))
    warnings = ()
    if altitude < LEAST_ALTITUDE_DEG:
        warnings = (f"the light {low_light(altitude)}",)
    return ShadowLight(direction, top, end, uncertainty, warnings)


def low_light(altitude_deg) -> str:
    """What is to be said of a light as low over the plane that receives shadows, after its name.

    >>> low_light(-3)
    'stands 3° below the plane of the marker: it throws no shadow on it'
    """
    if altitude_deg <= -0.5:
        return f"stands {-altitude_deg:.0f}° below the plane of the marker: it throws no shadow on it"
    if altitude_deg < 0.5:
        return "stands in the plane of the marker: its shadows have no end"
    times = 1 / np.tan(np.radians(altitude_deg))
    return (
        f"stands {altitude_deg:.1f}° above the plane of the marker: its shadows are {times:.0f} times as "
        "long as things are high"
    )


def _on_plane(camera, pose, point, name):
    found = pose.on_plane(camera.rays(np.asarray(point, dtype=np.float64)))
    if not np.isfinite(found).all():
        raise ProbeError(
            f"{name} at {np.asarray(point).tolist()} px lies above the horizon of the marker's plane"
        )
    return found


def _unit(vector):
    return vector / np.linalg.norm(vector)
