"""`sun`: what it prints, what it warns of, and what it refuses."""

import json

import numpy as np
import pytest

RIO = ["--latitude", "-22.95", "--longitude", "-43.17"]
NOON = ["--time", "2026-12-21T12:00:00-03:00"]


def test_the_published_value_of_nrel_in_json(panorama):
    """Golden, Colorado: azimuth 194.34024°, zenith 50.11162°, which refraction lessens by 0.0163°."""
    status, out, err = panorama(
        "sun", "--latitude", 39.742476, "--longitude", -105.1786, "--time", "2003-10-17T12:30:30-07:00",
        "--method", "psa2001", "--json",
    )  # fmt: skip
    assert (status, err) == (0, [])
    result = json.loads(out)
    assert result["azimuth_deg"] == pytest.approx(194.34024, abs=0.01)
    assert result["altitude_deg"] == pytest.approx(90 - 50.11162 - 0.0163, abs=0.005)
    azimuth, altitude = np.radians([result["azimuth_deg"], result["altitude_deg"]])
    level = np.cos(altitude)
    assert result["direction"] == pytest.approx(
        [level * np.sin(azimuth), level * np.cos(azimuth), np.sin(altitude)]
    )
    assert result["time"] == "2003-10-17T12:30:30-07:00"
    assert (result["method"], result["warnings"]) == ("psa2001", [])


def test_lines_for_people(panorama):
    status, out, err = panorama("sun", *RIO, *NOON)
    assert (status, err) == (0, [])
    lines = out.splitlines()
    assert [line.split()[0] for line in lines] == ["azimuth", "altitude", "direction"]
    highest = 90 - (23.44 - 22.95)  # at the solstice, half a degree from the tropic
    assert 87 < float(lines[1].split()[1].rstrip("°")) < highest
    assert json.loads(panorama("sun", *RIO, *NOON, "--json")[1])["method"] == "psa2020"


def test_below_the_horizon_is_a_warning(panorama):
    night = ["--time", "2026-12-21T00:00:00-03:00"]
    status, _, err = panorama("sun", *RIO, *night)
    assert status == 0
    assert len(err) == 1
    assert err[0].startswith("panorama sun: warning: the sun is 4")
    assert err[0].endswith("° below the horizon")
    status, out, err = panorama("sun", *RIO, *night, "--json")
    assert (status, err) == (0, [])
    assert "below the horizon" in json.loads(out)["warnings"][0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*RIO, "--time", "2026-12-21T12:00:00"], "has no zone; add Z for UTC"),
        ([*RIO, "--time", "yesterday"], "time 'yesterday': must be ISO 8601"),
        (["--latitude", "91", "--longitude", "0", *NOON], "latitude 91: must be a number from −90 to 90"),
        (
            ["--latitude", "0", "--longitude", "200", *NOON],
            "longitude 200: must be a number from −180 to 180",
        ),
        (["--latitude", "nan", "--longitude", "0", *NOON], "argument --latitude: 'nan': must be a number"),
        (["--latitude", "north", "--longitude", "0", *NOON], "'north': must be a number"),
        ([*RIO, *NOON, "--method", "spa"], "invalid choice: 'spa'"),
        (RIO, "required: --time"),
    ],
)
def test_bad_input_is_one_line(panorama, arguments, message):
    status, out, err = panorama("sun", *arguments)
    assert (status, out, len(err)) == (2, "", 1)
    assert err[0].startswith("panorama sun: ")
    assert message in err[0]


def test_it_is_no_verb_for_a_batch(panorama, tmp_path):
    status, _, err = panorama("batch", "sun", "x.json", "--into", tmp_path)
    assert status == 2
    assert "invalid choice: 'sun'" in err[0]
