"""`batch`: a bad set doesn't stop the others, and the exit status says so."""

import json
import shutil

from .conftest import change_set


def test_it_goes_on_after_a_bad_set_and_says_so(fresh_blend, room, panorama):
    for name in ("second", "third"):
        shutil.copy(room / "room.json", room / f"{name}.json")
    change_set(room / "second.json", image="none.exr")
    sets = [room / f"{name}.json" for name in ("room", "second", "third")]
    status, out, err = panorama("batch", "depth", *sets, "--into", room / "maps", "--width", 64, "--json")
    assert status == 2
    assert len(err) == 1
    assert err[0].startswith(f"panorama batch depth: {room / 'second.json'}: image: ")
    summary = json.loads(out)
    assert summary["verb"] == "depth"
    assert [item["set"] for item in summary["done"]] == [str(sets[0]), str(sets[2])]
    assert summary["done"][0]["result"]["size"] == [64, 32]
    assert [item["set"] for item in summary["failed"]] == [str(sets[1])]
    assert sorted(path.name for path in (room / "maps").iterdir()) == ["room_depth.exr", "third_depth.exr"]


def test_without_failures_the_status_is_0(room, panorama):
    status, out, _ = panorama("batch", "calibrate", room / "room.json", "--into", room / "out")
    assert status == 0
    assert out.splitlines()[-1] == "1 of 1 sets done"
    assert json.loads((room / "out" / "room_calibration.json").read_text())["camera_height"] == 1.5


def test_sets_of_one_name_are_refused_before_any_work(room, panorama):
    (room / "other").mkdir()
    shutil.copy(room / "room.json", room / "other" / "room.json")
    status, _, err = panorama(
        "batch", "build", room / "room.json", room / "other" / "room.json", "--into", room / "o"
    )
    assert status == 2
    assert "would both write" in err[0]
    assert not (room / "o").exists()
