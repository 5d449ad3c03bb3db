"""What only an installed extension has: presets found in its folder, and a folder of its own for assets."""

import json
import os
import shlex
import subprocess

import build_zips
import pytest

BLENDER = os.environ.get("BLENDER")

pytestmark = pytest.mark.skipif(not BLENDER, reason="needs BLENDER=/path/to/blender ./run test")

SCRIPT = """
import json, pathlib, bpy
def presets():
    folders = bpy.utils.preset_paths("expanded_panoramas/render")
    return sorted(path.stem for folder in folders for path in pathlib.Path(folder).glob("*.py"))
scene = bpy.context.scene
bpy.ops.panorama.load_sample()
bpy.ops.panorama.calibrate()
job = scene.panorama_set.job
shipped = presets()
job.samples = 33
bpy.ops.panorama.render_preset_add(name="Mine")
removed = bpy.ops.panorama.render_preset_add(name="Final", remove_name=True)
reports = [bpy.ops.panorama.add_asset_library() for _ in range(2)]
libraries = [(one.name, one.path) for one in bpy.context.preferences.filepaths.asset_libraries]
folder = pathlib.Path(libraries[-1][1])
print("FOUND", json.dumps({
    "image": pathlib.Path(scene.panorama_set.image_path).name, "shipped": shipped, "presets": presets(),
    "removed": list(removed), "libraries": libraries,
    "files": sorted(path.name for path in folder.iterdir()),
}))
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("extension")
    build_zips.build(build_zips.ROOT, folder / "plain.zip")
    (folder / "script.py").write_text(SCRIPT)
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(folder / "user")}
    blender = [*shlex.split(BLENDER), "--background"]
    install = ["--command", "extension", "install-file", "-r", "user_default", "--enable"]
    subprocess.run([*blender, *install, str(folder / "plain.zip")], env=environment, check=True)
    done = subprocess.run(
        [*blender, "--python-exit-code", "3", "--python", str(folder / "script.py")],
        env=environment, capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(next(line for line in done.stdout.splitlines() if line.startswith("FOUND"))[6:])


def test_the_sample_room_is_in_the_zip(found):
    assert found["image"] == "interior.exr"


def test_presets_of_the_extension_and_of_the_user(found):
    assert found["shipped"] == ["Final", "Preview", "Standard"]
    assert found["presets"] == ["Final", "Mine", "Preview", "Standard"]
    assert found["removed"] == ["CANCELLED"]  # the extension's own stay


def test_assets_lie_in_the_extensions_own_folder(found):
    ours = [path for name, path in found["libraries"] if name == "Expanded Panoramas"]
    assert len(ours) == 1
    assert "/.user/user_default/expanded_panoramas/assets" in ours[0].replace("\\", "/")
    assert found["files"] == ["Panorama interior.blend", "Sample Balls.blend", "blender_assets.cats.txt"]
