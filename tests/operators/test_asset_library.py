"""The asset library: marked and described, written once however often it is asked for."""

import numpy as np
import pytest
from room_job import calibrated


@pytest.fixture
def libraries(fresh_blend):
    """The preferences' asset libraries, as they were afterwards."""
    found = fresh_blend.context.preferences.filepaths.asset_libraries
    before = len(found)
    yield found
    while len(found) > before:
        found.remove(found[-1])


def assets_in(bpy, path):
    """Marked objects and node groups of a .blend, linked."""
    with bpy.data.libraries.load(str(path), link=True, assets_only=True) as (there, ours):
        ours.objects, ours.node_groups = there.objects, there.node_groups
    return {block.name: block for block in (*ours.objects, *ours.node_groups)}


def test_balls_and_lookup_are_assets(fresh_blend, tmp_path, libraries):
    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    bpy.ops.panorama.add_ball(kind="MATTE")  # of the same name
    own = bpy.data.objects["Matte Ball"]
    folder = tmp_path / "library"
    before = len(bpy.data.objects), len(bpy.data.node_groups), len(bpy.data.materials), len(bpy.data.meshes)
    bpy.ops.panorama.add_asset_library(directory=str(folder))
    after = len(bpy.data.objects), len(bpy.data.node_groups), len(bpy.data.materials), len(bpy.data.meshes)
    assert after == (before[0], before[1] + 1, *before[2:])  # the place's own look-up is built anew
    assert own.name == "Matte Ball"
    found = assets_in(bpy, folder / "Sample Balls.blend") | assets_in(bpy, folder / "Panorama room.blend")
    assert set(found) == {"Mirror Ball", "Matte Ball", "Panorama room"}
    for asset in found.values():
        assert len(asset.asset_data.description) > 20
        assert "panorama" in asset.asset_data.tags
        assert min(asset.preview.image_size) > 0
        pixels = np.empty(4 * np.prod(asset.preview.image_size), np.float32)
        asset.preview.image_pixels_float.foreach_get(pixels)
        assert pixels.reshape(-1, 4)[:, :3].std() > 0.05


def test_asked_twice_it_is_there_once(fresh_blend, tmp_path, libraries):
    bpy = fresh_blend
    count = len(libraries)
    for _ in range(2):
        bpy.ops.panorama.add_asset_library(directory=str(tmp_path))
    assert len(libraries) == count + 1
    assert libraries[-1].name == "Expanded Panoramas"
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "Sample Balls.blend",
        "blender_assets.cats.txt",
    ]


def test_catalogs_of_the_folder_stay(fresh_blend, tmp_path, libraries):
    catalogs = tmp_path / "blender_assets.cats.txt"
    other = "0b8a1e2c-1111-4222-8333-944455556666:Chairs:Chairs"
    catalogs.write_text(f"VERSION 1\n\n{other}\n", encoding="utf-8")
    for _ in range(2):
        fresh_blend.ops.panorama.add_asset_library(directory=str(tmp_path))
    lines = [
        line.partition(":")[2] for line in catalogs.read_text(encoding="utf-8").splitlines() if ":" in line
    ]
    assert lines == ["Chairs:Chairs", "Panorama:Panorama"]


def test_a_package_that_is_no_extension_asks_for_a_folder(fresh_blend, libraries):
    count = len(libraries)
    with pytest.raises(RuntimeError, match="only an installed extension has one; give a folder"):
        fresh_blend.ops.panorama.add_asset_library()
    assert len(libraries) == count


def test_a_folder_that_cannot_be_written_to(fresh_blend, tmp_path, libraries):
    count = len(libraries)
    (tmp_path / "file").touch()
    with pytest.raises(RuntimeError, match="file"):
        fresh_blend.ops.panorama.add_asset_library(directory=str(tmp_path / "file" / "library"))
    assert len(libraries) == count
    assert not fresh_blend.data.objects
