"""What the zips hold, as Blender's own tool builds them."""

import tomllib
import zipfile

import build_zips
import pytest

SHIPPED = {
    "LICENSE",
    "README.md",
    "__init__.py",
    "blender_manifest.toml",
    "cli",
    "cycles_integration",
    "ibl_toolkit",
    "operators",
    "sample_scenes",
    "ui",
}


def test_zip_without_wheels_holds_the_rooms_and_nothing_else(tmp_path):
    target = tmp_path / "plain.zip"
    build_zips.build(build_zips.ROOT, target)
    names = zipfile.ZipFile(target).namelist()
    assert {name.split("/")[0] for name in names} == SHIPPED
    assert not [name for name in names if "__pycache__" in name]
    data = "ibl_toolkit/light/penrose_corrections.npy", "ui/background/background.frag.glsl"
    assert set(data) < set(names)


@pytest.mark.parametrize("python", build_zips.PYTHONS, ids=lambda python: python.tag)
def test_manifest_with_wheels_names_them_and_its_blenders(python):
    plain = (build_zips.ROOT / "blender_manifest.toml").read_text(encoding="utf-8")
    wheels = ["xatlas-0.0.11-py3-none-any.whl"]
    manifest = tomllib.loads(build_zips.manifest_with_wheels(plain, "linux-x64", python, wheels))
    assert manifest["wheels"] == ["./wheels/xatlas-0.0.11-py3-none-any.whl"]
    assert manifest["platforms"] == ["linux-x64"]
    assert manifest["blender_version_min"] == python.blender_min
    assert manifest.get("blender_version_max") == python.blender_max


def test_a_broken_manifest_is_refused(tmp_path):
    (tmp_path / "blender_manifest.toml").write_text('schema_version = "1.0.0"\n', encoding="utf-8")
    with pytest.raises(RuntimeError, match="blender_ext build"):
        build_zips.build(tmp_path, tmp_path / "broken.zip")
