"""The sun's position: published values, a reference algorithm, geometry that needs none, and refusals."""

from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest
import sunposition

from expanded_panoramas.ibl_toolkit.mobile.sun_position import (
    METHODS,
    SunPosition,
    north_of,
    sun_position,
    time_from_iso,
    warnings_of,
    world_direction,
)

NOON = datetime(2026, 3, 20, 12, tzinfo=UTC)
ARCSECOND = 1 / 3600
PARALLAX = 8.8 * ARCSECOND
OBLIQUITY = 23.44
BOUNDS = {  # largest error [arc seconds] by the charts, and a little
    ("psa2020", 2020, 2050): 30,
    ("psa2020", 1950, 2050): 45,
    ("psa2001", 1999, 2015): 30,
    ("psa2001", 1950, 2050): 37,
}

OTHER_PROGRAM = {  # solposx 1.0.1, psa(): azimuth and elevation of `psa2020`, then of `psa2001` [degrees]
    ("1955-02-03T06:10:20Z", 52.52, 13.405): (109.9951384, -5.8631676, 109.9936766, -5.8621642),
    ("1988-11-23T15:00:00Z", -22.95, -43.17): (296.1896774, 84.5765471, 296.1755560, 84.5759064),
    ("2003-10-17T19:30:30Z", 39.742476, -105.1786): (194.3351034, 39.8713874, 194.3387913, 39.8700516),
    ("2026-06-21T12:00:00Z", 0.0, 0.0): (1.0504301, 66.5569241, 1.0515789, 66.5591943),
    ("2049-08-30T01:45:00Z", -66.5, 140.0): (14.1685292, 13.9317461, 14.1652101, 13.9306956),
}


def angle_deg(a, b):
    return np.degrees(2 * np.arcsin(np.linalg.norm(a - b, axis=-1) / 2))


def refraction_deg(altitude_deg, millibar, celsius):
    """Eq. 42 of the source below, at an altitude without refraction."""
    bent = 1.02 / (60 * np.tan(np.radians(altitude_deg + 10.3 / (altitude_deg + 5.11))))
    return millibar / 1010 * 283 / (273 + celsius) * bent


@pytest.mark.parametrize("method", METHODS)
def test_the_published_value_of_nrel(method):
    """I. Reda and A. Andreas, NREL/TP-560-34302 (2008), Table A5.1: seen from Golden, Colorado."""
    time = datetime(2003, 10, 17, 12, 30, 30, tzinfo=timezone(timedelta(hours=-7)))
    with_air = 90 - 50.11162
    altitude = with_air - refraction_deg(39.872, 820, 11)
    found = sun_position(time, 39.742476, -105.1786, method)
    assert angle_deg(found.direction, world_direction(194.34024, altitude)) < 20 * ARCSECOND
    assert angle_deg(found.direction, world_direction(194.34024, with_air)) > 40 * ARCSECOND


@pytest.mark.parametrize(("method", "first", "last"), BOUNDS)
def test_against_the_reference_algorithm(method, first, last):
    """NREL's SPA, in years and places at random, without air. ΔT, good to 20 s here, matters by 1″."""
    random = np.random.default_rng(6)
    start, end = (datetime(year, 1, 1, tzinfo=UTC).timestamp() for year in (first, last + 1))
    stamps = np.round(random.uniform(start, end, 150))
    latitude = np.degrees(np.arcsin(random.uniform(-1, 1, stamps.size)))
    longitude = random.uniform(-180, 180, stamps.size)
    times = [datetime.fromtimestamp(stamp, UTC) for stamp in stamps]
    azimuth, zenith, *_ = sunposition.sunposition(
        stamps, latitude, longitude, elevation=0.0, pressure=0.0, delta_t=55.0
    )
    found = sun_position(times, latitude, longitude, method)
    errors = angle_deg(found.direction, world_direction(azimuth, 90 - zenith)) / ARCSECOND
    assert errors.max() < BOUNDS[method, first, last]
    assert errors.max() > 10  # what bounds it is this algorithm, not that both are one


@pytest.mark.parametrize(("case", "wanted"), OTHER_PROGRAM.items())
def test_another_program_with_the_same_coefficients(case, wanted):
    """Every coefficient, the small ones too, over a whole turn of the moon's node."""
    time, latitude, longitude = case
    for method, azimuth, altitude in zip(METHODS, wanted[::2], wanted[1::2], strict=True):
        found = sun_position(time_from_iso(time), latitude, longitude, method)
        assert found.azimuth_deg == pytest.approx(azimuth, abs=2e-7)
        assert found.altitude_deg == pytest.approx(altitude, abs=2e-7)


def test_the_sun_over_the_year():
    """At the north pole its altitude is its declination: 0 at the equinox of 2026, 23.44° at the solstice."""
    equinox = datetime(2026, 3, 20, 14, 46, tzinfo=UTC)
    solstice = datetime(2026, 6, 21, 8, 25, tzinfo=UTC)
    assert sun_position(equinox, 90, 0).altitude_deg == pytest.approx(-PARALLAX, abs=0.01)
    assert sun_position(solstice, 90, 0).altitude_deg == pytest.approx(OBLIQUITY, abs=0.01)
    assert sun_position(solstice, -90, 0).altitude_deg == pytest.approx(-OBLIQUITY, abs=0.01)


def test_east_in_the_morning_west_in_the_evening():
    morning, evening = (sun_position(NOON + timedelta(hours=h), 0, 0) for h in (-5, 5))
    assert morning.direction[0] > 0.9
    assert evening.direction[0] < -0.9
    northern, southern = (sun_position(NOON, latitude, 0) for latitude in (50, -50))
    assert northern.direction[1] < -0.7  # at noon it stands in the south of the north
    assert southern.direction[1] > 0.7


def test_many_times_are_as_one_at_a_time():
    times = [NOON + timedelta(hours=7 * k) for k in range(6)]
    latitudes = np.array([[-80.0], [0.0], [52.5]])
    found = sun_position(times, latitudes, 13.4)
    assert found.azimuth_deg.shape == found.altitude_deg.shape == (3, 6)
    assert found.direction.shape == (3, 6, 3)
    assert np.allclose(np.linalg.norm(found.direction, axis=-1), 1)
    one = sun_position(times[4], 52.5, 13.4)
    assert np.ndim(one.azimuth_deg) == 0
    assert one.direction == pytest.approx(found.direction[2, 4])


def test_overhead_and_at_the_poles():
    """The sun seen from the north pole tells over which place it stands."""
    from_pole = sun_position(NOON, 90, 0)
    overhead = sun_position(NOON, from_pole.altitude_deg + PARALLAX, 180 - from_pole.azimuth_deg)
    assert overhead.altitude_deg == pytest.approx(90, abs=1e-4)
    elsewhere = sun_position(NOON, 90, 77.0)
    assert elsewhere.azimuth_deg == pytest.approx((from_pole.azimuth_deg + 77) % 360)
    assert sun_position(NOON, -90, 0).altitude_deg == pytest.approx(
        -from_pole.altitude_deg - 2 * PARALLAX, abs=1e-5
    )


def test_one_moment_in_any_zone():
    times = (
        NOON,
        datetime(2026, 3, 20, 13, tzinfo=timezone(timedelta(hours=1))),
        time_from_iso("2026-03-20T09:00-03:00"),
        time_from_iso("20260320T120000Z"),
    )
    found = [sun_position(time, -22.95, -43.2) for time in times]
    assert len({(one.azimuth_deg, one.altitude_deg) for one in found}) == 1


@pytest.mark.parametrize(
    ("north_deg", "azimuth_deg", "wanted"),
    [
        (0, 0, (0, 1, 0)),
        (0, 90, (1, 0, 0)),
        (90, 0, (-1, 0, 0)),  # north is −x, so east is +y
        (90, 90, (0, 1, 0)),
        (-30, 0, (0.5, 3**0.5 / 2, 0)),
    ],
)
def test_north_turns_the_world_counter_clockwise(north_deg, azimuth_deg, wanted):
    assert world_direction(azimuth_deg, 0.0, north_deg) == pytest.approx(wanted)
    up = world_direction(azimuth_deg, 60.0, north_deg)
    assert up == pytest.approx((*(np.array(wanted[:2]) / 2), 3**0.5 / 2))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"time": datetime(2026, 3, 20, 12)}, "2026-03-20 12:00:00: has no zone; add Z"),
        ({"time": [NOON, datetime(2026, 3, 20, 12)]}, "has no zone"),
        ({"time": np.array(["2026-03-20T12:00"], "datetime64[s]")}, "has no zone"),
        ({"time": "2026-03-20T12:00:00Z"}, "has no zone"),
        ({"latitude_deg": 90.01}, "latitude 90.01: must be a number from −90 to 90 degrees"),
        ({"latitude_deg": [0, -91]}, "latitude -91"),
        ({"latitude_deg": np.nan}, "latitude nan"),
        ({"longitude_deg": 180.5}, "longitude 180.5: must be a number from −180 to 180"),
        ({"longitude_deg": -np.inf}, "longitude -inf"),
        ({"method": "spa"}, "method 'spa': must be one of psa2020, psa2001"),
    ],
)
def test_bad_input_is_named(change, message):
    given = {"time": NOON, "latitude_deg": 50.0, "longitude_deg": 8.0, **change}
    with pytest.raises(ValueError, match=message):
        sun_position(**given)


@pytest.mark.parametrize("north_deg", [-170, 0, 35, 180])
def test_north_from_what_is_seen(north_deg):
    seen = world_direction(250.0, 40.0, north_deg)
    assert (north_of(seen, 250.0) - north_deg + 180) % 360 == pytest.approx(180)


def test_a_north_that_is_no_number():
    with pytest.raises(ValueError, match="north nan: must be a finite number of degrees"):
        world_direction(0.0, 0.0, np.nan)


@pytest.mark.parametrize("text", ["2026-03-20T12:00:00", "2026-03-20", "2026-03-20 12:00"])
def test_a_text_without_zone(text):
    with pytest.raises(ValueError, match="has no zone; add Z for UTC"):
        time_from_iso(text)


@pytest.mark.parametrize("text", ["noon", "2026-02-30T12:00:00Z", "20/03/2026 12:00Z", ""])
def test_a_text_that_is_no_time(text):
    with pytest.raises(ValueError, match="must be ISO 8601, such as 2026-03-20T12:00:00Z"):
        time_from_iso(text)


def test_warnings():
    assert warnings_of(NOON, SunPosition(180.0, 0.1)) == []
    assert warnings_of(NOON, SunPosition(0.0, -0.26)) == ["the sun is 0.3° below the horizon"]
    for year in (1950, 2050):
        assert warnings_of(datetime(year, 7, 1, tzinfo=UTC), SunPosition(180.0, 5.0)) == []
    old = datetime(1850, 1, 1, 12, tzinfo=UTC)
    assert warnings_of(old, SunPosition(180.0, 5.0)) == [
        "year 1850: the accuracy is known for 1950 to 2050 only"
    ]
