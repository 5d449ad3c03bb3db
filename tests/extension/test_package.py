"""The frame: the package imports without Blender, registers and unregisters, and its lists agree."""

import pathlib
import subprocess
import sys
import tomllib

import pytest

ROOT = pathlib.Path(__file__).parents[2]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
MANIFEST = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
NOT_SHIPPED = {"tests", "release", "docs", "out", "dist", "build"}


def test_imports_without_bpy():
    code = "import sys; sys.modules['bpy'] = None; import expanded_panoramas as p; print(p.__name__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT.anchor)
    assert (done.returncode, done.stdout.strip()) == (0, "expanded_panoramas"), done.stderr


def test_versions_agree():
    assert PYPROJECT["project"]["version"] == MANIFEST["version"]


def test_pyproject_lists_every_package():
    folders = [f.parent.relative_to(ROOT).parts for f in ROOT.rglob("__init__.py")]
    shipped = [p for p in folders if not (p and (p[0] in NOT_SHIPPED or p[0].startswith(".")))]
    found = sorted(".".join(("expanded_panoramas", *parts)) for parts in shipped)
    assert sorted(PYPROJECT["tool"]["setuptools"]["packages"]) == found


def test_registers_twice(fresh_blend):
    import expanded_panoramas

    expanded_panoramas.unregister()
    expanded_panoramas.register()


def test_user_folder_is_redirected(fresh_blend):
    home = pathlib.Path(fresh_blend.utils.resource_path("USER"))
    assert "expanded_panoramas_blender_" in str(home)


@pytest.mark.parametrize("text", [MANIFEST["tagline"], *MANIFEST["permissions"].values()])
def test_manifest_texts_follow_blenders_rules(text):
    assert len(text) <= 64
    assert not text.endswith(".")
