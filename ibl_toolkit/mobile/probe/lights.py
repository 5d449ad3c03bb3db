"""A light that a probe tells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...light.light_map import LUMINANCE


@dataclass(frozen=True, eq=False)
class ProbeLight:
    """One light at infinity.

    direction: (3,) unit vector to it, frame `camera`. irradiance: (3,) RGB on a surface that faces it, in the
    photograph's units, times the ball's reflectance (times its albedo over π for a diffuse ball), which the
    photograph does not tell. diameter_deg: of the disc of its solid angle [°]; NaN for a diffuse ball.
    uncertainty_deg: of the direction [°]: on a mirror ball, what an outline half a cell off moves it by; on a
    diffuse ball, the standard error that the shading's residual explains, or how far off the nearest light is
    of another set that explains the shading as well.
    cells: of the picture, or of the ball's own domain, that show it. is_clipped: whether it is stronger than
    the photograph holds. is_cut: whether it ends at the ball's rim, or at the frame.
    """

    direction: np.ndarray
    irradiance: np.ndarray
    diameter_deg: float
    uncertainty_deg: float
    cells: int
    is_clipped: bool
    is_cut: bool

    @property
    def luminance(self) -> float:
        """Of its irradiance."""
        return float(LUMINANCE @ self.irradiance)

    @property
    def colour(self) -> np.ndarray:
        """(3,) RGB, the largest 1."""
        return self.irradiance / max(float(self.irradiance.max()), 1e-30)
