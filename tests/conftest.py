"""What every test shares: a user folder of its own for Blender, and a fresh Blender file per test."""

import os
import pathlib
import sys
import tempfile

import pytest

TESTS = pathlib.Path(__file__).parent

# Blender reads this once, when bpy is first imported: the user's own extensions and settings stay untouched.
assert "bpy" not in sys.modules, "bpy was imported before its user folder could be redirected"
_blender_user_folder = tempfile.TemporaryDirectory(prefix="expanded_panoramas_blender_")
os.environ["BLENDER_USER_RESOURCES"] = _blender_user_folder.name


@pytest.fixture
def fresh_blend():
    """An empty Blender file with factory settings and the package registered; gives bpy."""
    bpy = pytest.importorskip("bpy")
    import expanded_panoramas

    bpy.ops.wm.read_factory_settings(use_empty=True)
    expanded_panoramas.register()
    yield bpy
    expanded_panoramas.unregister()


def pytest_collection_modifyitems(items):
    """Tests with a window need a Blender with one."""
    if os.environ.get("BLENDER"):
        return
    skip = pytest.mark.skip(reason="needs a Blender with a window: BLENDER=/path/to/blender ./run test")
    for item in items:
        if TESTS / "gui" in item.path.parents:
            item.add_marker(skip)
