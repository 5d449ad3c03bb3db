"""Where a camera stands before an ArUco marker.

The frame `marker`: origin in the marker's middle, x to the right and y up as the marker is read, z out of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from .errors import ProbeError
from .square_sides import measured_corners

DICTIONARY = "4X4_50"
AMBIGUOUS = 2.0
"""The other pose of the same square explains the corners this many times worse, or the pose is doubtful."""
FINE_RESIDUAL = 1.0
"""Of the corners [px], rms; beyond, size, intrinsics or distortion are doubtful."""
_SMALL = 24  # side [px]


@dataclass(frozen=True, eq=False)
class MarkerPose:
    """Of one marker: id, corners (4, 2) [px] from its top left clockwise, and where it lies.

    marker_from_camera: (3, 3) rotation. origin: (3,) of the marker in the frame `camera` [m].
    residual_px: rms distance of the corners to where the pose puts them.
    """

    id: int
    corners: np.ndarray
    marker_from_camera: np.ndarray
    origin: np.ndarray
    residual_px: float
    warnings: tuple[str, ...] = ()

    @property
    def eye(self) -> np.ndarray:
        """(3,) the camera in the frame `marker` [m]."""
        return -self.marker_from_camera @ self.origin

    def to_camera(self, points) -> np.ndarray:
        """Points (..., 3) [m] of the frame `marker` in `camera`."""
        return np.asarray(points, dtype=np.float64) @ self.marker_from_camera + self.origin

    def on_plane(self, rays) -> np.ndarray:
        """Where rays of sight (..., 3) meet the marker's plane, (..., 3) [m] of `marker`; NaN where not."""
        rays = np.asarray(rays, dtype=np.float64) @ self.marker_from_camera.T
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = -self.eye[2] / rays[..., 2]
            return np.where(depth[..., None] > 0, self.eye + depth[..., None] * rays, np.nan)


def dictionary_names() -> list[str]:
    """Of the predefined dictionaries, less their DICT_.

    >>> "4X4_50" in dictionary_names()
    True
    """
    return sorted(name[5:] for name in dir(cv2.aruco) if name.startswith("DICT_"))


def find_marker(photo, camera, size, marker_id=None, dictionary=DICTIONARY) -> MarkerPose:
    """The pose of the marker of a given side `size` [m] in a Photo.

    marker_id: which, where there are several.

    Raises: ProbeError for a size that is not above 0, an unknown dictionary, no marker, none of this id, two
    markers without an id, and one id that is seen twice; it names the ids that are seen.
    """
    if not (np.isfinite(size) and size > 0):
        raise ProbeError(f"marker's side {size} m must be above 0")
    corners, ids = _detect(photo.grey, dictionary)
    chosen, corners = _chosen(corners, ids, marker_id, dictionary)
    return _pose(chosen, measured_corners(photo.white_at_one, camera, corners), camera, size)


def _detect(grey, dictionary):
    if dictionary not in dictionary_names():
        raise ProbeError(f"dictionary {dictionary!r} is unknown; known are {', '.join(dictionary_names())}")
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{dictionary}"))
    corners, ids, _ = cv2.aruco.ArucoDetector(known, parameters).detectMarkers(grey)
    return [c[0] + 0.5 for c in corners], [] if ids is None else ids.ravel().tolist()


def _chosen(corners, ids, marker_id, dictionary):
    """(id, corners) of the one that is meant."""
    seen = ", ".join(map(str, sorted(ids)))
    if not ids:
        raise ProbeError(
            f"no marker of dictionary {dictionary} is seen: it must be whole and sharp, with a white margin"
        )
    if marker_id is None and len(set(ids)) > 1:
        raise ProbeError(f"markers {seen} are seen: say which one is meant by its id")
    wanted = ids[0] if marker_id is None else marker_id
    matching = [c for c, i in zip(corners, ids, strict=True) if i == wanted]
    if not matching:
        raise ProbeError(f"marker {wanted} is not seen; seen: {seen}")
    if len(matching) > 1:
        raise ProbeError(f"marker {wanted} is seen {len(matching)} times: cover all but one")
    return wanted, matching[0].astype(np.float64)


def _pose(marker_id, corners, camera, size):
    half = size / 2
    square = np.array([[-half, half, 0], [half, half, 0], [half, -half, 0], [-half, -half, 0]])
    count, turns, shifts, errors = cv2.solvePnPGeneric(
        square, corners - 0.5, camera.matrix, camera.coefficients, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    if not count:
        raise ProbeError(f"marker {marker_id}: no pose explains its corners {corners.round(1).tolist()}")
    camera_from_marker = cv2.Rodrigues(turns[0])[0]
    residual, rival = float(errors[0].item()), float(errors[-1].item()) if count > 1 else np.inf
    warnings = tuple(_doubts(marker_id, corners, residual, rival))
    return MarkerPose(marker_id, corners, camera_from_marker.T, shifts[0].ravel(), residual, warnings)


def _doubts(marker_id, corners, residual, rival):
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    if sides.min() < _SMALL:
        yield f"marker {marker_id}: a side has {sides.min():.0f} px, its tilt is uncertain: come nearer"
    if residual > FINE_RESIDUAL:
        yield (
            f"marker {marker_id}: its corners miss the pose by {residual:.1f} px: "
            "check the field of view, the distortion, and that it lies flat"
        )
    if rival < AMBIGUOUS * residual:
        yield (
            f"marker {marker_id}: a second pose, tilted the other way, explains its corners as well "
            f"({rival:.2f} px, {residual:.2f} px): see it at a slant, or larger"
        )
