"""A scene for a phone: glTF 2.0 in one file, its lights' cameras and the kinds of shadow map beside it.

Everything that glTF has no word for is in the extras: of the scene the lights, the kinds of shadow map, the
ambient light, the camera and the background; of each material the mesh's role and whether it throws shadows.
Other programs read the meshes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from ..glb import GlbBinary, glb_bytes
from ..layers.views.pinhole import Pinhole
from .shadow_maps import LightCamera, ShadowSettings

ROLES = ("support", "environment", "synthetic")
"""Real surfaces, which show the background but for what shadows take of it: those meant to receive shadows,
and others; and what is new, with a colour of its own."""
MOST_LIGHTS = 8
"""A phone tests each of them in each pixel."""
_NEAREST = 0.01  # distance from the camera [m] from which on meshes are drawn
_MARGIN = 1.01


@dataclass(frozen=True, eq=False)
class SceneMesh:
    """Triangles of one colour.

    points: (V, 3) in the world [m]. triangles: (T, 3) indices. role: of ROLES. albedo: (3,) linear, 0 to 1,
    of what is new. normals: (V, 3) unit vectors, or None for flat triangles, whose normals are to the side
    from which their corners run counter-clockwise. throws: whether it throws shadows; those of a real thing
    are in the photograph already, and would be seen twice.

    Raises: ValueError that names the mesh and what is right.
    """

    name: str
    points: np.ndarray
    triangles: np.ndarray
    role: str = "support"
    albedo: tuple[float, float, float] = (0.8, 0.8, 0.8)
    normals: np.ndarray | None = None
    throws: bool = True

    def __post_init__(self):
        points, triangles = np.asarray(self.points), np.asarray(self.triangles)
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise ValueError(f"{self.name}: points {points.shape} must be (V, 3), all finite")
        if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
            raise ValueError(f"{self.name}: triangles {triangles.shape} must be (T, 3) whole numbers")
        if not len(triangles) or not 0 <= triangles.min() <= triangles.max() < len(points):
            raise ValueError(
                f"{self.name}: must have triangles, whose corners are among {len(points)} points"
            )
        if self.role not in ROLES:
            raise ValueError(f"{self.name}: role {self.role!r} must be one of {', '.join(ROLES)}")
        if np.shape(self.albedo) != (3,) or not all(0 <= v <= 1 for v in self.albedo):
            raise ValueError(f"{self.name}: albedo {self.albedo} must be three numbers from 0 to 1")
        if self.normals is not None and np.shape(self.normals) != points.shape:
            raise ValueError(f"{self.name}: normals {np.shape(self.normals)} must be {points.shape}")

    @property
    def is_new(self) -> bool:
        """Whether it has a colour of its own, and does not show the picture."""
        return self.role == "synthetic"

    @property
    def is_ground(self) -> bool:
        """Whether maps of moments hold it where nothing throws a shadow, see `shadow_maps.ground`."""
        return self.role == "support" and not self.throws

    def with_normals(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points (n, 3), normals (n, 3) and triangles; flat ones have their corners to themselves."""
        if self.normals is not None:
            return np.asarray(self.points), np.asarray(self.normals), np.asarray(self.triangles)
        corners = np.asarray(self.points, dtype=np.float64)[self.triangles]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(across, axis=1, keepdims=True)
        corners, across = corners[length[:, 0] > 0], across[length[:, 0] > 0]  # without area nothing is seen
        normals = np.repeat(across / length[length > 0][:, None], 3, axis=0)
        return corners.reshape(-1, 3), normals, np.arange(len(normals)).reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class SceneLight:
    """camera: where the light is. strength: (3,) irradiance of a sun [W/m²], intensity of a lamp [W/sr].

    Raises: ValueError for a strength that is not finite or is negative.
    """

    camera: LightCamera
    strength: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def __post_init__(self):
        if np.shape(self.strength) != (3,) or not all(0 <= v < np.inf for v in self.strength):
            raise ValueError(f"light's strength {self.strength} must be three numbers, 0 or more")


@dataclass(frozen=True, eq=False)
class ShadowScene:
    """Meshes, 1 to MOST_LIGHTS lights, and the irradiance without them [W/m²], in shadow too.

    ambient: (3,) of faces that look up, ambient_down: of such that look down, None for as much; between them
    it changes with the normal's z.

    Raises: ValueError for no meshes, too few or many lights, and ambient light that is negative.
    """

    meshes: Sequence[SceneMesh]
    lights: Sequence[SceneLight]
    ambient: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ambient_down: tuple[float, float, float] | None = None

    def __post_init__(self):
        if not self.meshes:
            raise ValueError("the scene has no meshes: nothing could throw a shadow or receive one")
        if not 1 <= len(self.lights) <= MOST_LIGHTS:
            raise ValueError(f"scene with {len(self.lights)} lights must have 1 to {MOST_LIGHTS}")
        for light in (self.ambient, self.from_below):
            if np.shape(light) != (3,) or not all(0 <= v < np.inf for v in light):
                raise ValueError(f"ambient light {light} must be three numbers, 0 or more")

    @property
    def from_below(self) -> tuple[float, float, float]:
        """The ambient light (3,) of faces that look down."""
        return self.ambient if self.ambient_down is None else self.ambient_down

    def ambient_on(self, normals: np.ndarray) -> np.ndarray:
        """Ambient light (n, 3) of faces with normals (n, 3)."""
        share = 0.5 + 0.5 * np.asarray(normals)[:, 2:]
        return share * np.array(self.ambient) + (1 - share) * np.array(self.from_below)


def scene_glb(
    scene: ShadowScene, settings: Sequence[ShadowSettings], camera: Pinhole, background: dict
) -> bytes:
    """The .glb file of a scene as the page reads it; the first of ``settings`` is shown first.

    Raises ValueError without settings.
    """
    if not settings:
        raise ValueError("there must be at least one kind of shadow map to show")
    binary = GlbBinary()
    return glb_bytes(
        {
            "asset": {"version": "2.0", "generator": "Expanded Panoramas"},
            "scene": 0,
            "scenes": [
                {
                    "nodes": list(range(len(scene.meshes))),
                    "extras": _extras(scene, settings, camera, background),
                }
            ],
            "nodes": [{"name": mesh.name, "mesh": k} for k, mesh in enumerate(scene.meshes)],
            "meshes": [_mesh(mesh, k, binary) for k, mesh in enumerate(scene.meshes)],
            "materials": [_material(mesh) for mesh in scene.meshes],
        },
        binary,
    )


def _mesh(mesh, material, binary):
    points, normals, triangles = mesh.with_normals()
    attributes = {
        "POSITION": binary.add_vectors(points, with_bounds=True),
        "NORMAL": binary.add_vectors(normals),
    }
    primitive = {"attributes": attributes, "indices": binary.add_triangles(triangles), "material": material}
    return {"name": mesh.name, "primitives": [primitive]}


def _material(mesh):
    return {
        "name": mesh.name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*map(float, mesh.albedo), 1.0],
            "metallicFactor": 0,
            "roughnessFactor": 1,
        },
        "doubleSided": True,
        "extras": {"role": mesh.role, "throws": bool(mesh.throws)},
    }


def _extras(scene, settings, camera, background):
    farthest = max(np.linalg.norm(np.asarray(m.points) - camera.eye, axis=1).max() for m in scene.meshes)
    return {
        "lights": [_light(light) for light in scene.lights],
        "ambient": [float(v) for v in scene.ambient],
        "ambient_down": [float(v) for v in scene.from_below],
        "shadow_settings": [_kind(one) for one in settings],
        "camera": {
            "eye": np.asarray(camera.eye, dtype=float).tolist(),
            "axes": np.asarray(camera.axes, dtype=float).tolist(),
            "half_width": float(np.tan(np.radians(camera.fov_deg) / 2)),
        },
        "near": _NEAREST,
        "far": float(max(farthest * _MARGIN, 2 * _NEAREST)),
        "background": background,
    }


def _kind(settings):
    whole = {"resolution": int(settings.resolution), "window": int(settings.window)}  # numpy's may be given
    return {**asdict(settings), **whole, "label": label(settings)}


def _light(light):
    camera = light.camera
    return {
        "clip_from_world": (camera.clip_from_light @ camera.light_from_world).tolist(),
        "perspective": bool(camera.perspective),
        "range": [float(camera.near), float(camera.far)],
        "eye": np.asarray(camera.eye, dtype=float).tolist(),
        "to_sun": (-np.asarray(camera.axes[2], dtype=float)).tolist(),
        "strength": [float(v) for v in light.strength],
    }


def label(settings: ShadowSettings) -> str:
    """What a menu calls a kind of shadow map.

    >>> label(ShadowSettings("pcf", 512, "8+8", 5))
    'PCF, 512 × 512, 8+8, window 5, 256 KiB'
    """
    size = settings.resolution**2 * settings.bytes_per_texel / 1024
    window = "" if settings.method == "hard" else f", window {settings.window}"
    return (
        f"{settings.method.upper()}, {settings.resolution} × {settings.resolution}, {settings.storage}"
        f"{window}, {size:.0f} KiB"
    )
