"""What the adjustment says about each click: how far it was moved, and how well its place is known after."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .calibration import solve
from .clicks import CLICK_ERROR_PIXELS


@dataclass(frozen=True, eq=False)
class ClickReport:
    """The n distinct clicks of a calibration.

    uv (n, 2): as clicked, u in [0, 1). corrected (n, 3): unit directions [panorama frame] that fulfil all
    conditions; those of a rectangle are its corners reprojected. residual_pixels (n,): how far a click lies
    from there [px of the image]. covariance (n, 2, 2): of the corrected click, for clicks that err by half a
    pixel, in squared half pixels, sideways and upwards. tangents (n, 3, 2) [rad]: what half a pixel of
    either is as a direction.
    """

    uv: np.ndarray
    corrected: np.ndarray
    residual_pixels: np.ndarray
    covariance: np.ndarray
    tangents: np.ndarray

    def indices(self, uv):
        """Which clicks picks (k, 2) became: (k,), −1 for those that took no part."""
        points = np.asarray(uv, dtype=np.float64).reshape(-1, 2).tolist()
        return np.array([self._known.get((u % 1.0, v), -1) for u, v in points], dtype=int)

    @cached_property
    def _known(self):
        return {(u, v): k for k, (u, v) in enumerate(self.uv.tolist())}

    def half_axes(self):
        """Half axes (n, 3, 2) [rad] of the ellipses of one standard deviation, tangent to the sphere."""
        variances, axes = np.linalg.eigh(self.covariance)
        return self.tangents @ (axes * np.sqrt(np.maximum(variances, 0.0))[:, None])


def calibrate_with_report(picks, image_size):
    """(Calibration, ClickReport) of CalibrationPicks: as `calibrate`, which see.

    The adjusted observations of a Gauss–Helmert model have the covariance I − Q_vv, in units of their error,
    with that of the corrections Q_vv = B' (M⁻¹ − M⁻¹ A N⁻¹ A' M⁻¹) B, M = B B', N = A' M⁻¹ A. A click that
    nothing checks keeps its own error, a circle of half a pixel.

    Source: W. Förstner, B. Wrobel: Photogrammetric Computer Vision, Springer 2016, section 4.8.
    """
    calibration, clicks, adjustment = solve(picks, image_size)
    return calibration, click_report(clicks, adjustment)


def click_report(clicks, adjustment):
    """The ClickReport of a solution."""
    moved = np.einsum("nij,nj->ni", clicks.tangents, adjustment.corrections)
    corrected = clicks.directions + moved
    weighted = np.tensordot(adjustment.multiplier_cofactors, adjustment.by_click, axes=1)
    of_corrections = np.einsum("mni,mnj->nij", adjustment.by_click, weighted)
    return ClickReport(
        uv=clicks.uv,
        corrected=corrected / np.linalg.norm(corrected, axis=1, keepdims=True),
        residual_pixels=CLICK_ERROR_PIXELS * np.linalg.norm(adjustment.corrections, axis=1),
        covariance=np.eye(2) - of_corrections,
        tangents=clicks.tangents,
    )
