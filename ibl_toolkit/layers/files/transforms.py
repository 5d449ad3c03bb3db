"""The TransformGroup of panorama.xml: where the panorama stands in the world.

The transforms multiply as matrices in the printed order, M = T · R · S, so that the one that is last in the
file acts first on a point. M leads from the mapping's own frame to the world [m]. That frame is the one of
the thesis' appendix A: of the cube map it is ours; of the equirectangular map (eq. A.5) its x axis points
the other way, which mirrors what is seen. The printed `Scale vector='-1 1 1'` undoes that: in
M = T · R · diag(-1, 1, 1), R is our world_from_panorama and T our origin.

Source: thesis, section 6.2.1. It doesn't say the order; this is the usual one of scene graphs, and with it
the printed group makes a right-handed world of eq. A.5.
"""

from __future__ import annotations

import cv2
import numpy as np

from ..panorama import EQUIRECTANGULAR, refuse_other_place
from .xml_nodes import Node

_MIRROR = {EQUIRECTANGULAR: np.diag([-1.0, 1.0, 1.0])}  # our panorama frame from the mapping's own


def place_of(group: Node, mapping: str) -> tuple[np.ndarray, np.ndarray]:
    """World_from_panorama (3, 3) and origin (3,) [m] of a TransformGroup for maps of `mapping`.

    Raises: LayersError for what does not give a right-handed world in metres, and for unknown elements.
    """
    matrix = np.eye(4)
    for node in group.children("Translate", "Rotate", "Scale"):
        matrix = matrix @ _MATRICES[node.tag](node)
        node.finish()
    group.finish()
    rotation = matrix[:3, :3] @ _MIRROR.get(mapping, np.eye(3))
    try:
        refuse_other_place(rotation, matrix[:3, 3], 0)
    except ValueError:
        mirror = "with Scale vector='-1 1 1' " if mapping in _MIRROR else ""
        group.fail(
            f"it must turn and move the panorama, {mirror}and neither stretch nor mirror it; "
            f"it is {matrix[:3].round(6).tolist()}"
        )
    return rotation, matrix[:3, 3]


def transforms_of(world_from_panorama: np.ndarray, origin: np.ndarray, mapping: str) -> list[str]:
    """The elements of a TransformGroup, as printed: Translate, Rotate [degrees], and Scale for the mirror.

    >>> transforms_of(np.eye(3), np.array([0, 0, 1.15]), "cube map")
    ["<Translate vector='0.0 0.0 1.15' />", "<Rotate axis='0 0 1' angle='0' />"]
    """
    axis, angle = _axis_and_angle(np.asarray(world_from_panorama, dtype=np.float64))
    degrees, axis = (repr(float(np.degrees(angle))), _written(axis)) if angle else ("0", "0 0 1")
    elements = [f"<Translate vector='{_written(origin)}' />", f"<Rotate axis='{axis}' angle='{degrees}' />"]
    return [*elements, "<Scale vector='-1 1 1' />"] if mapping in _MIRROR else elements


def _axis_and_angle(rotation):
    """Unit axis (3,) and angle [rad] from 0 to pi, exact for the smallest and the largest angles too.

    Source: I. Bar-Itzhack, "New Method for Extracting the Quaternion from a Rotation Matrix", 2000.
    """
    trace, skew = np.trace(rotation), rotation - rotation.T
    k = np.empty((4, 4))
    k[:3, :3] = rotation + rotation.T - trace * np.eye(3)
    k[3, :3] = k[:3, 3] = skew[2, 1], skew[0, 2], skew[1, 0]
    k[3, 3] = trace
    quaternion = np.linalg.eigh(k)[1][:, -1]
    quaternion *= np.copysign(1, quaternion[3])
    sine = np.linalg.norm(quaternion[:3])
    return quaternion[:3] / (sine or 1), 2 * np.arctan2(sine, quaternion[3])


def _translation(node):
    matrix = np.eye(4)
    matrix[:3, 3] = node.numbers("vector", 3)
    return matrix


def _rotation(node):
    """About an axis of any length, right-handed."""
    axis, degrees = np.array(node.numbers("axis", 3)), node.number("angle")
    length = float(np.linalg.norm(axis))
    if not 0 < length < np.inf:
        node.fail(f"axis is '{node.text('axis')}', must have a length")
    matrix = np.eye(4)
    matrix[:3, :3] = cv2.Rodrigues(axis / length * np.radians(degrees))[0]
    return matrix


def _scale(node):
    return np.diag([*node.numbers("vector", 3), 1.0])


_MATRICES = {"Translate": _translation, "Rotate": _rotation, "Scale": _scale}


def _written(vector):
    return " ".join(repr(float(value)) for value in vector)
