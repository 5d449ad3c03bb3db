"""The shader in a real Blender against numpy: all kinds of views, the seam, the poles, shrunken pictures."""

import os
import pathlib
import shlex
import subprocess
from dataclasses import dataclass, field

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.equirectangular import sample
from expanded_panoramas.ibl_toolkit.views import View

BLENDER = os.environ.get("BLENDER")
MEAN, LARGEST = 0.05 / 255, 0.5 / 255
"""Of the difference in sRGB: the graphics card computes where a direction lies with fewer digits."""
LARGEST_HALF = 65504
SIZE = 96, 64


def turn(x=0.0, y=0.0, z=0.0):
    """A rotation (3, 3) about x, then y, then z [degrees]."""
    (cx, sx), (cy, sy), (cz, sz) = ((np.cos(a), np.sin(a)) for a in np.radians([x, y, z]))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def looking(rotation, eye=(0.0, 0.0, 1.5)):
    """view_from_world of a camera, which looks along its -z, y upwards."""
    world_from_view = np.eye(4)
    world_from_view[:3, :3], world_from_view[:3, 3] = rotation, eye
    return np.linalg.inv(world_from_view)


def perspective(half_width, shift_x=0.0, shift_y=0.0, size=SIZE, near=0.1, far=100.0):
    """clip_from_view of half a field's tangent; shifts are in half widths and heights."""
    x, y = 1 / half_width, size[0] / size[1] / half_width
    depth = (near + far) / (near - far), 2 * near * far / (near - far)
    return np.array([[x, 0, shift_x, 0], [0, y, shift_y, 0], [0, 0, *depth], [0, 0, -1, 0]])


def parallel(half_width, shift_x=0.0, size=SIZE):
    """clip_from_view of an orthographic view, half its width [m]."""
    x, y = 1 / half_width, size[0] / size[1] / half_width
    return np.array([[x, 0, 0, shift_x], [0, y, 0, 0], [0, 0, -0.01, 0], [0, 0, 0, 1]])


def noise(width, seed=0):
    """A panorama of noise up to 2, in steps that half floats have."""
    rng = np.random.default_rng(seed)
    return (rng.integers(0, 129, (width // 2, width, 3)) / 64).astype(np.float32)


def sunny(width):
    """A panorama with a sun that half floats cannot hold."""
    image = noise(width)
    image[width // 4, width // 2] = 3e5
    return image


def smooth(width):
    """A panorama without edges, so that means over pixels have no sharp places to differ at."""
    u, v = (np.arange(width) + 0.5) / width, (np.arange(width // 2) + 0.5) / (width // 2)
    waves = np.sin(2 * np.pi * 24 * u)[None, :, None] * np.sin(np.pi * v)[:, None, None]
    return (0.5 + 0.4 * waves * (1, -1, 0.5)).astype(np.float32)


@dataclass
class Case:
    """A view, and how many points along each side of a pixel it is the mean of."""

    window: np.ndarray
    view: np.ndarray
    steps: int = 1
    image: np.ndarray = field(default_factory=lambda: noise(32))
    frame: np.ndarray = field(default_factory=lambda: np.eye(3))
    height: float = 1.5
    exposure: float = 0.0
    share: float = 1.0
    size: tuple[int, int] = SIZE

    def expected(self):
        """What numpy makes of it (H, W, 4)."""
        seen = View.from_matrices(self.window, self.view, self.frame, self.height, self.size)
        rows, columns = np.mgrid[self.size[1] : 0 : -1, : self.size[0]]
        corners = np.stack([columns, rows - 1], axis=-1).astype(float)
        parts = (np.arange(self.steps) + 0.5) / self.steps
        points = [(x, y) for x in parts for y in parts]
        held = np.minimum(self.image, LARGEST_HALF)
        mean = np.mean([sample(held, seen.directions_at(corners + p)) for p in points], axis=0)
        opaque = np.ones((*mean.shape[:2], 1))
        return np.concatenate([mean * 2**self.exposure, opaque], axis=-1) * self.share


FORWARD = turn(x=90, z=-90)  # +x, the middle of the image, its top up
CASES = {
    "perspective": Case(perspective(0.7), looking(FORWARD)),
    "seam": Case(perspective(0.3), looking(turn(x=90, z=90))),
    "zenith": Case(perspective(0.2), looking(turn(x=180))),
    "nadir": Case(perspective(0.2), looking(np.eye(3))),
    "rolled, moved": Case(perspective(1.2), looking(turn(30, 50, 70), eye=(3, -2, 8))),
    "tilted panorama": Case(perspective(0.5), looking(FORWARD), frame=turn(10, -20, 130), height=2.0),
    "camera with shift": Case(perspective(0.4, 0.8, -0.5), looking(turn(80, 10, 20))),
    "plan": Case(parallel(6.0), looking(np.eye(3), eye=(1, 2, 9))),
    "plan, shifted and turned": Case(parallel(3.0, 0.4), looking(turn(z=40), eye=(1, 2, 9)), height=2.5),
    "slanted": Case(parallel(3.0), looking(turn(50, 0, 30), eye=(0, 0, 4)), frame=turn(5, 5, 60)),
    "along the floor": Case(parallel(3.0), looking(FORWARD)),
    "brighter": Case(perspective(0.7), looking(FORWARD), image=noise(32) / 8, exposure=1.5),
    "sun": Case(perspective(0.7), looking(FORWARD), image=sunny(32), exposure=-17),
    "mixed": Case(perspective(0.7), looking(FORWARD), share=0.25),
    "shrunk": Case(perspective(0.2), looking(FORWARD), 4, smooth(1024), size=(24, 16)),
    "shrunk by half": Case(perspective(0.1), looking(FORWARD), 2, smooth(1024), size=(16, 12)),
}


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear < 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """What Blender drew of each case."""
    if not BLENDER:
        pytest.skip("the wheel draws nothing: needs BLENDER=/path/to/blender ./run test")
    folder = tmp_path_factory.mktemp("background")
    arrays = {"names": np.array(list(CASES))}
    for name, case in CASES.items():
        arrays[f"{name}.image"] = case.image
        arrays[f"{name}.window"], arrays[f"{name}.view"] = case.window, case.view
        arrays[f"{name}.frame"] = case.frame
        arrays[f"{name}.numbers"] = np.array([case.height, case.exposure, case.share, *case.size])
    np.savez(folder / "cases.npz", **arrays)
    script = pathlib.Path(__file__).with_name("shown_in_blender.py")
    command = ["--background", "--factory-startup", "--python-exit-code", "1", "--python", script]
    command += ["--", folder / "cases.npz", folder / "shown.npz"]
    done = subprocess.run(
        [*shlex.split(BLENDER), *map(str, command)],
        capture_output=True, text=True, env={**os.environ, "BLENDER_USER_RESOURCES": str(folder)},
    )  # fmt: skip
    if "No graphics" in done.stdout + done.stderr:
        pytest.skip("this Blender has no graphics here")
    assert done.returncode == 0, done.stdout + done.stderr
    return np.load(folder / "shown.npz")


@pytest.mark.parametrize("name", CASES)
def test_shader_draws_what_numpy_says(shown, name):
    expected = CASES[name].expected()
    difference = np.abs(srgb(shown[name]) - srgb(expected))
    assert difference.mean() < MEAN
    assert difference.max() < LARGEST


@pytest.mark.parametrize(("name", "flat"), [("zenith", False), ("seam", False), ("along the floor", True)])
def test_cases_would_tell_a_difference(name, flat):
    spread = CASES[name].expected()[..., 0].std()
    assert (spread < 1e-9) == flat
