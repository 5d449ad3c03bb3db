"""A set goes through a scene, and through a .blend, and comes back the same."""

from pathlib import Path

import pytest
from room_job import write_room

from expanded_panoramas.ibl_toolkit.panorama_set import read_set, set_from_dict, set_to_dict

HOTEL = Path(__file__).parents[2] / "sample_scenes" / "hotel_room.json"
EVERY_KEY = {
    "version": 1,
    "image": "room.exr",
    "calibration": {
        "rectangles": [
            {"points": [[0.41, 0.71], [0.55, 0.72], [0.6, 0.9], [0.33, 0.88]], "plane": "CEILING"}
        ],
        "parallels": [
            {"axis": "Y", "lines": [[[0.1, 0.6], [0.2, 0.7]], [[0.3, 0.6], [0.25, 0.72]]]},
            {"axis": "X", "lines": [[[0.1, 0.61], [0.2, 0.7]]]},
        ],
        "verticals": [[[0.12, 0.3], [0.12, 0.62]]],
        "length": {"points": [[0.1, 0.8], [0.2, 0.8]], "metres": 2.13},
    },
    "shapes": [
        {
            "name": "floor",
            "kind": "polygon",
            "points": [[0.1, 0.6], [0.4, 0.6], [0.7, 0.6]],
            "role": "SUPPORT",
        },
        {
            "name": "walls",
            "kind": "walls",
            "of": "floor",
            "height": 2.7,
            "ceiling": True,
            "role": "ENVIRONMENT",
        },
        {
            "name": "table",
            "kind": "box",
            "points": [[0.1, 0.7], [0.2, 0.7], [0.2, 0.8]],
            "top": [0.3, 0.5],
            "role": "SUPPORT",
            "reflectivity": 0.04,
            "roughness": 0.3,
        },
    ],
    "objects": "objects.blend",
}


def through_scene(bpy, panorama_set):
    from expanded_panoramas.operators import conversion

    state = bpy.context.scene.panorama_set
    conversion.state_from_set(state, panorama_set)
    return conversion.set_from_state(state)


@pytest.mark.parametrize(
    "given", [set_from_dict(EVERY_KEY, Path("/a")), read_set(HOTEL)], ids=("all", "hotel")
)
def test_round_trip_is_exact(fresh_blend, given):
    assert set_to_dict(through_scene(fresh_blend, given), "/a") == set_to_dict(given, "/a")


def test_an_exported_set_is_the_imported_one(fresh_blend, tmp_path):
    bpy = fresh_blend
    source = write_room(tmp_path)
    bpy.ops.panorama.import_set(filepath=str(source))
    bpy.ops.panorama.export_set(filepath=str(tmp_path / "again.json"))
    first, second = (set_to_dict(read_set(path), tmp_path) for path in (source, tmp_path / "again.json"))
    assert first.pop("image") == second.pop("image")
    for one, other in zip(_numbers(first), _numbers(second), strict=True):
        assert one == pytest.approx(other, abs=1e-7) if isinstance(one, float) else one == other


def test_it_lives_in_the_blend(fresh_blend, tmp_path):
    bpy = fresh_blend
    given = set_from_dict(EVERY_KEY, tmp_path)
    through_scene(bpy, given)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    from expanded_panoramas.operators import conversion

    found = conversion.set_from_state(bpy.context.scene.panorama_set)
    assert set_to_dict(found, tmp_path) == set_to_dict(given, tmp_path)


def _numbers(value):
    if isinstance(value, dict):
        value = [part for item in sorted(value.items()) for part in item]
    if isinstance(value, list):
        return [leaf for part in value for leaf in _numbers(part)]
    return [value]
