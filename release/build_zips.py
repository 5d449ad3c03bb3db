"""Build the extension's zips into dist/: one without wheels, and one per platform and Python with them.

Blender's own tool, which comes with bpy, builds and validates each.
"""

import importlib.util
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parents[1]
DIST = ROOT / "dist"
WHEELS = ROOT / "wheels"
BUNDLED = ("OpenEXR", "opencv-contrib-python-headless", "xatlas")  # numpy comes with Blender

# What a platform's Blender can load. Blender's builds need glibc 2.28 and macOS 11, but
# OpenCV's for macOS start at 13 or 14: its users need that version too.
PLATFORMS = {
    "linux-x64": ["manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux2014_x86_64"],
    "windows-x64": ["win_amd64"],
    "macos-arm64": ["macosx_14_0_arm64"],
    "macos-x64": ["macosx_14_0_x86_64"],
}


@dataclass(frozen=True)
class Python:
    """A Python that some Blenders have: those Blenders [min, max), their platforms, and newer libraries."""

    version: str
    blender_min: str
    blender_max: str | None
    platforms: tuple[str, ...]
    newer: dict[str, str]

    @property
    def tag(self):
        """Short name, as in a zip's file name."""
        return "py" + self.version.replace(".", "")

    def libraries(self):
        """Return the pinned requirements to bundle: those that the tests run with, or newer."""
        pyproject = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
        tested = dict(pin.split("==") for pin in pyproject["project"]["optional-dependencies"]["dev"])
        return [f"{name}=={self.newer.get(name, tested[name])}" for name in BUNDLED]


# Python 3.11 in Blender goes with numpy 1.26, which OpenCV from 4.12 on refuses. Blender 5 left Intel Macs.
PYTHONS = (
    Python("3.11", "4.5.0", "5.1.0", tuple(PLATFORMS), {}),
    Python("3.13", "5.1.0", None, ("linux-x64", "windows-x64", "macos-arm64"),
           {"opencv-contrib-python-headless": "4.13.0.92"}),
)


class NoWheelError(ValueError):
    """A library has no wheel for that platform and Python."""


def blender_scripts():
    """Return the folder of Blender's scripts beside bpy, without importing bpy."""
    (scripts,) = pathlib.Path(importlib.util.find_spec("bpy").origin).parent.glob("*/scripts")
    return scripts


def blender_tool(verb, *arguments):
    """Run one verb of Blender's extension tool, with the tags that Blender knows."""
    tool = blender_scripts() / "addons_core/bl_pkg/cli/blender_ext.py"
    tags = blender_scripts() / "modules/_bpy_internal/extensions/tags.py"
    done = subprocess.run([sys.executable, tool, verb, f"--valid-tags={tags}", *arguments],
                          capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"blender_ext {verb} {arguments}: {done.stdout}{done.stderr}")


def build(source, target):
    """Build and validate the zip `target` from the folder `source`."""
    blender_tool("build", f"--source-dir={source}", f"--output-filepath={target}")
    blender_tool("validate", str(target))


def download(platform, python, folder):
    """Fetch the wheels of one platform and Python into `folder` and return their names.

    Raises NoWheelError naming the library that has none.
    """
    shutil.rmtree(folder, ignore_errors=True)
    for library in python.libraries():
        done = subprocess.run(
            [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:",
             "--implementation=cp", f"--python-version={python.version}",
             *(f"--platform={tag}" for tag in PLATFORMS[platform]), f"--dest={folder}", library],
            capture_output=True, text=True)
        if "No matching distribution" in done.stderr:
            raise NoWheelError(f"{library} has no wheel for {platform} and Python {python.version}")
        if done.returncode:
            raise RuntimeError(done.stderr)
    return sorted(wheel.name for wheel in folder.glob("*.whl"))


def manifest_with_wheels(manifest, platform, python, wheels):
    """Return the manifest's text with the platform, the wheels and the Blenders that one Python serves."""
    lines = [f'platforms = ["{platform}"]', "wheels = ["]
    lines += [f'  "./wheels/{wheel}",' for wheel in wheels]
    lines += ["]"]
    if python.blender_max:
        lines.insert(0, f'blender_version_max = "{python.blender_max}"')
    oldest = f'blender_version_min = "{tomllib.loads(manifest)["blender_version_min"]}"'
    manifest = manifest.replace(oldest, f'blender_version_min = "{python.blender_min}"')
    head, table, tail = manifest.partition("[permissions]")
    return head + "\n".join(lines) + "\n\n" + table + tail


def build_with_wheels(plain_zip, platform, python, target):
    """Build `target` from what `plain_zip` holds and the wheels of one platform and Python."""
    with tempfile.TemporaryDirectory() as folder:
        staging = pathlib.Path(folder)
        zipfile.ZipFile(plain_zip).extractall(staging)
        cache = WHEELS / f"{platform}-{python.tag}"
        wheels = download(platform, python, cache)
        shutil.copytree(cache, staging / "wheels")
        manifest = staging / "blender_manifest.toml"
        text = manifest_with_wheels(manifest.read_text(encoding="utf-8"), platform, python, wheels)
        manifest.write_text(text, encoding="utf-8")
        build(staging, target)


def main():
    """Build every zip and print the table of names and sizes."""
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    stem = f"{manifest['id']}-{manifest['version']}"
    shutil.rmtree(DIST, ignore_errors=True)
    DIST.mkdir()
    plain = DIST / f"{stem}-nowheels.zip"
    build(ROOT, plain)
    report(plain)
    for python in PYTHONS:
        for platform in python.platforms:
            target = DIST / f"{stem}-{platform}-{python.tag}.zip"
            try:
                build_with_wheels(plain, platform, python, target)
            except NoWheelError as error:
                print(f"{target.name:52} -- {error}")
            else:
                report(target)


def report(target):
    """Print one zip's line of the table."""
    print(f"{target.name:52} {target.stat().st_size / 1e6:8.2f} MB, valid", flush=True)


if __name__ == "__main__":
    main()
