"""Presets of render quality: three shipped, more of the user's own, where Blender keeps them."""

from pathlib import Path

import pytest

FOLDER = "expanded_panoramas/render"


def presets(bpy):
    return {
        path.stem: path for folder in bpy.utils.preset_paths(FOLDER) for path in Path(folder).glob("*.py")
    }


def use(bpy, path):
    return bpy.ops.script.execute_preset(filepath=str(path), menu_idname="PANORAMA_PT_render_presets")


def test_shipped_presets_are_found_and_differ(fresh_blend):
    bpy = fresh_blend
    job = bpy.context.scene.panorama_set.job
    found = presets(bpy)
    assert set(found) == {"Preview", "Standard", "Final"}
    samples = []
    for name in ("Preview", "Standard", "Final"):
        job.method, job.samples = "single", 7
        assert use(bpy, found[name]) == {"FINISHED"}
        assert job.method == "catcher"
        samples.append(job.samples)
    assert samples == sorted(set(samples))
    assert not job.denoise  # the final one smooths nothing


def test_own_presets_are_kept_used_and_removed(fresh_blend):
    bpy = fresh_blend
    job = bpy.context.scene.panorama_set.job
    job.method, job.samples, job.denoise = "difference", 33, True
    assert bpy.ops.panorama.render_preset_add(name="Night work") == {"FINISHED"}
    path = presets(bpy)["Night_work"]
    assert path.is_relative_to(bpy.utils.user_resource("SCRIPTS"))
    try:
        job.method, job.samples, job.denoise = "single", 1, False
        use(bpy, path)
        assert (job.method, job.samples, job.denoise) == ("difference", 33, True)
    finally:
        bpy.ops.panorama.render_preset_add(name="Night_work", remove_name=True)
    assert "Night_work" not in presets(bpy)


def test_a_name_that_is_taken_is_refused(fresh_blend):
    bpy = fresh_blend
    before = presets(bpy)
    assert bpy.ops.panorama.render_preset_add(name="Final") == {"CANCELLED"}
    assert presets(bpy) == before


def test_the_folder_goes_with_the_extension(fresh_blend):
    import expanded_panoramas

    expanded_panoramas.unregister()
    left = presets(fresh_blend)
    expanded_panoramas.register()
    assert left == {}


def test_presets_are_packaged():
    tomllib = pytest.importorskip("tomllib")
    root = Path(__file__).parents[2]
    pyproject = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = pyproject["tool"]["setuptools"]["package-data"]["expanded_panoramas.ui"]
    packaged = {path for pattern in patterns for path in (root / "ui").glob(pattern)}
    assert set((root / "ui" / "presets").rglob("*.py")) <= packaged
