import json

import pytest

from expanded_panoramas.ibl_toolkit.panorama_set import (
    SetError,
    read_set,
    set_from_dict,
    set_to_dict,
    write_set,
)


def document():
    """A set that uses every key but `length`."""
    return {
        "version": 1,
        "image": "images/room.exr",
        "calibration": {
            "rectangles": [
                {"points": [[0.41, 0.71], [0.55, 0.72], [0.6, 0.9], [0.33, 0.88]], "plane": "FLOOR"}
            ],
            "parallels": [{"axis": "X", "lines": [[[0.1, 0.6], [0.2, 0.7]], [[0.3, 0.6], [0.25, 0.72]]]}],
            "verticals": [[[0.12, 0.3], [0.12, 0.62]]],
            "camera_height": 1.5,
        },
        "shapes": [
            {
                "name": "floor",
                "kind": "polygon",
                "points": [[0.1, 0.6], [0.5, 0.7], [0.9, 0.6]],
                "role": "SUPPORT",
            },
            {"name": "tile", "kind": "square", "points": [[0.4, 0.8], [0.5, 0.9]], "role": "SUPPORT"},
            {
                "name": "walls",
                "kind": "walls",
                "of": "floor",
                "height": 2.8,
                "ceiling": True,
                "role": "ENVIRONMENT",
            },
            {
                "name": "table",
                "kind": "box",
                "points": [[0.4, 0.7], [0.5, 0.7], [0.5, 0.65]],
                "top": [0.4, 0.6],
                "role": "SUPPORT",
                "reflectivity": 0.3,
                "roughness": 0.05,
            },
            {
                "name": "column",
                "kind": "cylinder",
                "points": [[0.7, 0.7], [0.72, 0.71], [0.74, 0.7]],
                "top": [0.7, 0.2],
                "role": "ENVIRONMENT",
            },
        ],
        "objects": "objects.blend",
    }


def changed(path, value):
    """The document with the key at `path` set, or taken out where value is ...."""
    whole = document()
    part = whole
    for key in path[:-1]:
        part = part[key]
    if value is ...:
        del part[path[-1]]
    else:
        part[path[-1]] = value
    return whole


def test_round_trip_keeps_everything(tmp_path):
    first = set_from_dict(document(), tmp_path)
    assert first.image == tmp_path / "images/room.exr"
    assert first.shapes[3].reflectivity == 0.3
    assert set_to_dict(first, tmp_path) == document()
    write_set(first, tmp_path / "room.json")
    assert json.loads((tmp_path / "room.json").read_text()) == document()
    assert set_to_dict(read_set(tmp_path / "room.json"), tmp_path) == document()
    assert [path.name for path in tmp_path.iterdir()] == ["room.json"]


def test_paths_follow_the_file(tmp_path):
    (tmp_path / "sets").mkdir()
    write_set(set_from_dict(document(), tmp_path), tmp_path / "sets" / "room.json")
    assert json.loads((tmp_path / "sets" / "room.json").read_text())["image"] == "../images/room.exr"
    assert read_set(tmp_path / "sets" / "room.json").image.resolve() == tmp_path / "images/room.exr"


def test_known_length_instead_of_height(tmp_path):
    length = {"points": [[0.4, 0.7], [0.5, 0.7]], "metres": 2.0}
    given = changed(["calibration", "camera_height"], ...)
    given["calibration"]["length"] = length
    assert set_to_dict(set_from_dict(given, tmp_path), tmp_path) == given
    with pytest.raises(SetError, match=r"^calibration\.length is given beside camera_height"):
        set_from_dict(changed(["calibration", "length"], length), tmp_path)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (["version"], 2, "version is 2, must be 1: written by a newer program"),
        (["version"], ..., "version is missing"),
        (["version"], True, "version is True, must be a whole number"),
        (["imagee"], "x", "imagee is an unknown key"),
        (["image"], "", "image is '', must be text"),
        (["image"], 3, "image is 3, must be text"),
        (["objects"], None, "objects is None, must be text"),
        (["shapes"], {}, "shapes is {}, must be a list"),
        (["shapes", 1], 7, r"shapes\[1\] is 7, must be an object"),
        (["shapes", 3, "topp"], [0, 0], r"shapes\[3\]\.topp is an unknown key"),
        (["shapes", 3, "top"], ..., r"shapes\[3\]\.top and shapes\[3\]\.height: neither given"),
        (["shapes", 3, "height"], 1.0, r"shapes\[3\]\.top and shapes\[3\]\.height: both given"),
        (["shapes", 3, "points"], [[0, 0]], r"shapes\[3\]\.points has 1 points, must have 3"),
        (["shapes", 0, "points"], [[0, 0], [1, 1]], r"shapes\[0\]\.points has 2 points, must have 3 or more"),
        (["shapes", 0, "points", 1], [0.5], r"shapes\[0\]\.points\[1\] is \[0\.5\], must be a pick"),
        (["shapes", 0, "points", 1], [0.5, 1.2], r"shapes\[0\]\.points\[1\] is .*, must lie in the image"),
        (["shapes", 0, "points", 1], [0.5, True], r"shapes\[0\]\.points\[1\] is .*, must be a pick"),
        (["shapes", 0, "top"], [0.5, 0.5], r"shapes\[0\]\.top is an unknown key"),
        (
            ["shapes", 0, "role"],
            "SYNTHETIC",
            r"shapes\[0\]\.role is 'SYNTHETIC', must be one of SUPPORT, ENVIRONMENT",
        ),
        (["shapes", 0, "kind"], "sphere", r"shapes\[0\]\.kind is 'sphere', must be one of polygon"),
        (["shapes", 1, "name"], "floor", r"shapes\[1\]\.name is 'floor', which an earlier shape has"),
        (["shapes", 2, "of"], "table", r"shapes\[2\]\.of is 'table', must name a polygon"),
        (["shapes", 2, "of"], "flor", r"shapes\[2\]\.of is 'flor', must name a polygon"),
        (["shapes", 2, "height"], 0, r"shapes\[2\]\.height is 0, must be above 0"),
        (["shapes", 2, "ceiling"], 1, r"shapes\[2\]\.ceiling is 1, must be true or false"),
        (["shapes", 2, "reflectivity"], 0.5, r"shapes\[2\]\.reflectivity is an unknown key"),
        (["shapes", 3, "reflectivity"], 1.5, r"shapes\[3\]\.reflectivity is 1\.5, must be from 0 to 1"),
        (["calibration", "camera_height"], "1.5", r"calibration\.camera_height is '1\.5', must be a number"),
        (["calibration", "rectangles", 0, "plane"], "ROOF", r"calibration\.rectangles\[0\]\.plane is 'ROOF'"),
        (["calibration", "rectangles", 0, "pts"], 0, r"calibration\.rectangles\[0\]\.pts is an unknown key"),
        (["calibration", "parallels", 0, "axis"], "Z", r"calibration\.parallels\[0\]\.axis is 'Z'"),
        (
            ["calibration", "parallels", 0, "lines", 1],
            [[0, 0]],
            r"calibration\.parallels\[0\]\.lines\[1\] has 1 points",
        ),
        (["calibration", "verticals", 0], 3, r"calibration\.verticals\[0\] is 3, must be a list"),
    ],
)
def test_refusals_name_the_key(path, value, message, tmp_path):
    with pytest.raises(SetError, match="^" + message):
        set_from_dict(changed(path, value), tmp_path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "Expecting property name"),
        ("[1]", r"the set is \[1\], must be an object"),
        ('{"version": 1, "version": 1}', "key 'version' stands twice"),
        ('{"version": NaN}', "NaN is not a number"),
        ("\ufeff{}", "BOM"),
    ],
)
def test_files_that_are_no_set_are_refused_with_their_name(text, message, tmp_path):
    path = tmp_path / "bad.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SetError, match=f"bad.json: .*{message}"):
        read_set(path)


def test_an_invalid_set_is_not_written_over_a_good_one(tmp_path):
    path = tmp_path / "room.json"
    good = set_from_dict(document(), tmp_path)
    write_set(good, path)
    bad = set_from_dict(document(), tmp_path)
    object.__setattr__(bad.shapes[0], "points", bad.shapes[0].points[:2])
    with pytest.raises(SetError, match=r"shapes\[0\]\.points"):
        write_set(bad, path)
    assert json.loads(path.read_text()) == document()
