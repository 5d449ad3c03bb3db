"""A polygon mesh of unit size in its own frame, with its true size in the transform to the world.

Local geometry fits a box of 1 × 1 (× 1, standing on local z = 0), so that an artist reads and edits the true
size as the object's scale. Source: thesis, section 5.5.1.2.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Mesh:
    """Vertices, faces and the transform to the world.

    vertices: (V, 3) in the local frame. faces: tuples of vertex indices; seen from the side to which the
    normal points they run counter-clockwise (up for floors, down for ceilings, into the room for walls,
    outwards for boxes and cylinders). world_from_local: (4, 4) = translation · rotation about z · scale,
    world in metres.
    """

    vertices: np.ndarray
    faces: tuple[tuple[int, ...], ...]
    world_from_local: np.ndarray

    def __post_init__(self):
        for name, tail in (("vertices", (3,)), ("world_from_local", (4,))):
            array = np.array(getattr(self, name), dtype=np.float64)
            if array.ndim != 2 or array.shape[1:] != tail:
                raise ValueError(
                    f"{name} has shape {array.shape}, must be {'(V, 3)' if tail == (3,) else '(4, 4)'}"
                )
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @property
    def world_vertices(self):
        """(V, 3) vertices in the world [m]."""
        return transformed(self.world_from_local, self.vertices)

    @property
    def scale(self):
        """(3,) lengths of the local axes in the world [m]: the object's scale."""
        return np.linalg.norm(self.world_from_local[:3, :3], axis=0)

    @property
    def area_vectors(self):
        """(F, 3) per face its normal in the world times its area [m²] (Newell)."""
        points = self.world_vertices
        return np.array([newell(points[list(face)]) for face in self.faces])


def newell(points):
    """Normal times area of a closed polygon, points (k, 3); exact for planar ones, concave ones too.

    >>> newell(np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])).tolist()
    [0.0, 0.0, 2.0]
    """
    relative = np.asarray(points, dtype=np.float64) - points[0]
    return 0.5 * np.cross(relative, np.roll(relative, -1, axis=0)).sum(axis=0)


def transformed(matrix, points):
    """points (..., 3) through an affine matrix (4, 4)."""
    return np.asarray(points) @ matrix[:3, :3].T + matrix[:3, 3]


def placement(centre, angle, scale):
    """world_from_local (4, 4) = T · Rz · S.

    centre (3,) [m]; angle about z, signed, counter-clockwise seen from above [rad]; scale (3,) [m].

    >>> matrix = placement((1, 2, 0), np.pi / 2, (4, 3, 1))
    >>> transformed(matrix, (0.5, 0, 0)).round(12).tolist()
    [1.0, 4.0, 0.0]
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]]) * np.asarray(
        scale, dtype=float
    )
    matrix[:3, 3] = centre
    return matrix
