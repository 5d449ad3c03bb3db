"""The child Blender of long work, started by a real one on the installed zip from a file never saved."""

import json
import os
import shlex
import subprocess

import build_zips
import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.images import write_exr
from expanded_panoramas.ibl_toolkit.panorama_set import write_set

from .test_real_blender import BLENDER, blender

pytestmark = pytest.mark.skipif(not BLENDER, reason="needs BLENDER=/path/to/blender ./run test")

PARENT = """
import bpy, json, sys, time
from bl_ext.user_default.expanded_panoramas.cycles_integration import preparation
from bl_ext.user_default.expanded_panoramas.operators import light
from bl_ext.user_default.expanded_panoramas.operators.child import start

def until(done):
    end = time.monotonic() + 60
    while not done() and time.monotonic() < end:
        time.sleep(0.05)
        child.read_progress()

bpy.ops.panorama.import_set(filepath={set_path!r})
bpy.ops.panorama.calibrate()
bpy.ops.panorama.build()
scene = bpy.context.scene
objects = len(bpy.data.objects)
child = start.start_child(light.measure_light, scene, {{"most": None}})
until(child.is_done)
measured = child.value()
child.stop().join()
unchanged = (len(bpy.data.objects), bpy.data.filepath, scene.panorama_place.irradiance) == (objects, "", None)
preparation.apply(scene, measured)
lamps = len(scene.panorama_place.lights.objects)

child = start.start_child(light.measure_light, scene, {{"most": None}})
until(lambda: child.step == "irradiance")
child.stop().join()
print("FOUND", json.dumps({{
    "unchanged": unchanged, "lamps": lamps, "irradiance": float(measured.irradiance.mean()),
    "cancelled_at": child.step, "has_ended": child.process.poll() is not None, "folder": child.path.exists(),
}}))
"""


@pytest.fixture
def room(tmp_path):
    """A set whose room is uniformly grey but for a lamp."""
    pytest.importorskip("bpy")
    from expanded_panoramas.sample_scenes.closed_room_set import closed_room_set

    image = np.full((64, 128), 0.5, np.float16)
    image[10:13, 30:36] = 60
    write_exr(tmp_path / "room.exr", dict.fromkeys("RGB", image))
    write_set(closed_room_set(tmp_path / "room.exr"), tmp_path / "room.json")
    return tmp_path / "room.json"


def test_it_measures_for_its_parent_and_ends_when_told(room, tmp_path):
    zipped, user, script = tmp_path / "plain.zip", tmp_path / "user", tmp_path / "parent.py"
    build_zips.build(build_zips.ROOT, zipped)
    blender(user, "extension", "install-file", "-r", "user_default", "--enable", str(zipped))
    script.write_text(PARENT.format(set_path=str(room)), encoding="utf-8")
    done = subprocess.run(
        [*shlex.split(BLENDER), "--background", "--python-exit-code", "9", "--python", str(script)],
        capture_output=True,
        text=True,
        env={**os.environ, "BLENDER_USER_RESOURCES": str(user)},
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(next(line for line in done.stdout.splitlines() if line.startswith("FOUND"))[6:])
    assert found["unchanged"]
    assert found["lamps"] >= 1
    assert found["irradiance"] > 0.5
    assert (found["cancelled_at"], found["has_ended"], found["folder"]) == ("irradiance", True, False)
