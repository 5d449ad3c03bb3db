"""Where the sun stands, from place and time, by the algorithm of the Plataforma Solar de Almería (PSA).

The light of an outdoor scene in "Realistic Shadows for Mobile AR", section III.B. Two sets of coefficients:
`psa2001`, fitted to 1999–2015, and `psa2020`, fitted to 2020–2050. The equations are the same.

Sources: M. Blanco-Muriel, D. C. Alarcón-Padilla, T. López-Moratalla and M. Lara-Coira, "Computing the solar
vector", Solar Energy 70(5), 2001; M. J. Blanco, K. Milidonis and A. M. Bonanos, "Updating the PSA sun
position algorithm", Solar Energy 212, 2020.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

CHARTED = 1950, 2050
"""First and last year for which the accuracy was measured."""
DIAMETER_DEG = 0.533
"""Of the sun's disc, in the mean over a year."""
_J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
_EARTH_RADIUS_KM, _ASTRONOMICAL_UNIT_KM = 6371.01, 149597890.0


@dataclass(frozen=True)
class _Fit:
    """Coefficients of one fit: radians, days from J2000, hours of sidereal time; a pair is value and rate."""

    node: tuple[float, float]  # Ω, of the moon's orbit
    mean_longitude: tuple[float, float]  # L
    mean_anomaly: tuple[float, float]  # g
    longitude: tuple[float, float, float, float]  # constant, and of sin g, sin 2g, sin Ω
    obliquity: tuple[float, float, float]  # value, rate, and of cos Ω
    sidereal_time: tuple[float, float]


_FITS = {
    "psa2020": _Fit(
        node=(2.267127827, -9.300339267e-4),
        mean_longitude=(4.895036035, 1.720279602e-2),
        mean_anomaly=(6.239468336, 1.720200135e-2),
        longitude=(-1.544353226e-4, 3.338320972e-2, 3.497596876e-4, -8.689729360e-6),
        obliquity=(4.090904909e-1, -6.213605399e-9, 4.418094944e-5),
        sidereal_time=(6.697096103, 6.570984737e-2),
    ),
    "psa2001": _Fit(
        node=(2.1429, -1.0394594e-3),
        mean_longitude=(4.8950630, 1.7202791698e-2),
        mean_anomaly=(6.2400600, 1.72019699e-2),
        longitude=(-1.134e-4, 3.341607e-2, 3.4894e-4, -2.03e-5),
        obliquity=(4.090928e-1, -6.2140e-9, 3.96e-5),
        sidereal_time=(6.6974243242, 6.57098283e-2),
    ),
}
METHODS = tuple(_FITS)
"""The first is the default."""


@dataclass(frozen=True)
class SunPosition:
    """Where the sun's middle stands, seen from the earth's surface, as if there were no air.

    azimuth_deg: clockwise from north, in [0, 360); altitude_deg: above the horizon. Numbers or arrays (…).
    """

    azimuth_deg: float | np.ndarray
    altitude_deg: float | np.ndarray

    @property
    def direction(self) -> np.ndarray:
        """The unit vectors (…, 3) to the sun: +x east, +y north, +z up."""
        return world_direction(self.azimuth_deg, self.altitude_deg)


def sun_position(
    time: datetime | Sequence[datetime],
    latitude_deg: float | np.ndarray,
    longitude_deg: float | np.ndarray,
    method: str = METHODS[0],
) -> SunPosition:
    """The sun's position at times (…), seen from latitudes and longitudes (…), which broadcast.

    time: with a zone; longitude_deg: positive to the east. Refraction, which lifts the sun by 0.02° at 40°
    and by 0.5° at the horizon, is left out.
    Raises ValueError for a time without a zone, a latitude beyond ±90°, a longitude beyond ±180°, what is not
    finite, and an unknown method.

    >>> noon = datetime(2026, 6, 21, 12, tzinfo=UTC)
    >>> greenwich = sun_position(noon, 51.4779, 0.0)
    >>> round(greenwich.azimuth_deg), round(greenwich.altitude_deg, 1)
    (179, 62.0)
    """
    if method not in _FITS:
        raise ValueError(f"method {method!r}: must be one of {', '.join(METHODS)}")
    latitude = np.radians(_within("latitude", latitude_deg, 90))
    longitude = np.radians(_within("longitude", longitude_deg, 180))
    seconds = _seconds_from_j2000(time)
    sun_from_equator = _right_ascension_and_declination(_FITS[method], seconds / 86400)
    sidereal = _sidereal_angle(_FITS[method], seconds)
    return _seen_from(latitude, sidereal + longitude - sun_from_equator[0], sun_from_equator[1])


def world_direction(azimuth_deg, altitude_deg, north_deg: float = 0.0) -> np.ndarray:
    """The unit vectors (…, 3) in the world (z up) of azimuths (…), clockwise from north, and altitudes (…).

    north_deg: where north lies in the world, counter-clockwise seen from above, from +y: at 0 north is +y
    and east +x; at 90 north is −x. That is Blender's turn about Z which brings +y to the north.
    Raises ValueError for a north that is not finite.

    >>> world_direction(90.0, 0.0).round(3), world_direction(0.0, 0.0, north_deg=90).round(3)
    (array([1., 0., 0.]), array([-1.,  0.,  0.]))
    """
    if not np.isfinite(north_deg):
        raise ValueError(f"north {north_deg}: must be a finite number of degrees")
    bearing = np.radians(np.subtract(azimuth_deg, north_deg))  # clockwise from +y
    altitude = np.radians(altitude_deg)
    level = np.cos(altitude)
    parts = (level * np.sin(bearing), level * np.cos(bearing), np.sin(altitude) + 0 * bearing)
    return np.stack(parts, axis=-1)


def north_of(direction: np.ndarray, azimuth_deg: float) -> float:
    """The `north_deg` of a world in which what lies in a direction (3,) has this azimuth; from −180 to 180.

    >>> north_of(world_direction(120.0, 30.0, north_deg=50.0), 120.0).__round__(6)
    50.0
    """
    bearing_deg = np.degrees(np.arctan2(direction[0], direction[1]))
    return float((azimuth_deg - bearing_deg + 180) % 360 - 180)


def time_from_iso(text: str) -> datetime:
    """The time that an ISO 8601 text says, which must name its zone: a Z, or the offset from UTC.

    Raises ValueError.

    >>> time_from_iso("2026-03-20T13:00:00+01:00") == time_from_iso("2026-03-20T12:00:00Z")
    True
    """
    try:
        time = datetime.fromisoformat(text)
    except ValueError as error:
        raise ValueError(f"time {text!r}: must be ISO 8601, such as 2026-03-20T12:00:00Z") from error
    _refuse_naive(time)
    return time


def warnings_of(time: datetime, position: SunPosition) -> list[str]:
    """What is to be said of one position: the sun has set, or no one measured how accurate it is.

    >>> warnings_of(datetime(2026, 1, 1, tzinfo=UTC), SunPosition(0.0, -12.34))
    ['the sun is 12.3° below the horizon']
    """
    warnings = []
    if position.altitude_deg < 0:
        warnings.append(f"the sun is {-position.altitude_deg:.1f}° below the horizon")
    first, last = CHARTED
    if not first <= time.year <= last:
        warnings.append(f"year {time.year}: the accuracy is known for {first} to {last} only")
    return warnings


def _within(name, value, limit):
    value = np.asarray(value, float)
    wrong = value[~(np.abs(value) <= limit)]  # NaN is wrong, too
    if wrong.size:
        raise ValueError(f"{name} {wrong.flat[0]:g}: must be a number from −{limit} to {limit} degrees")
    return value


def _refuse_naive(time):
    if not isinstance(time, datetime) or time.utcoffset() is None:
        raise ValueError(f"time {time}: has no zone; add Z for UTC, or the offset from UTC, such as +01:00")


def _seconds_from_j2000(time):
    """Universal time (…) since noon of 2000-01-01 [s]."""
    times = np.array(time, dtype=object)
    for one in times.flat:
        _refuse_naive(one)
    return np.array([(one - _J2000).total_seconds() for one in times.flat]).reshape(times.shape)


def _right_ascension_and_declination(fit, days):
    """Section 3.2 of the source of 2001: the sun on the ecliptic, then from the equator [rad]."""
    node = fit.node[0] + fit.node[1] * days
    mean_longitude = fit.mean_longitude[0] + fit.mean_longitude[1] * days
    anomaly = fit.mean_anomaly[0] + fit.mean_anomaly[1] * days
    constant, first, second, nutation = fit.longitude
    longitude = (
        mean_longitude
        + constant
        + first * np.sin(anomaly)
        + second * np.sin(2 * anomaly)
        + nutation * np.sin(node)
    )
    obliquity = fit.obliquity[0] + fit.obliquity[1] * days + fit.obliquity[2] * np.cos(node)
    right_ascension = np.arctan2(np.cos(obliquity) * np.sin(longitude), np.cos(longitude))
    return right_ascension, np.arcsin(np.sin(obliquity) * np.sin(longitude))


def _sidereal_angle(fit, seconds):
    """Greenwich mean sidereal time [rad]."""
    hour = (seconds + 43200) % 86400 / 3600  # of the day of universal time
    hours = fit.sidereal_time[0] + fit.sidereal_time[1] * (seconds / 86400) + hour
    return np.radians(15 * hours)


def _seen_from(latitude, hour_angle, declination):
    """From the equator to the horizon, then from the earth's centre to its surface (parallax).

    Deviation: zenith distance and azimuth are angles of one vector; the printed arc cosine and tangent lose
    digits at the zenith and at the poles.
    """
    towards_pole, equatorial = np.sin(declination), np.cos(declination)
    east = -equatorial * np.sin(hour_angle)
    north = towards_pole * np.cos(latitude) - equatorial * np.cos(hour_angle) * np.sin(latitude)
    up = towards_pole * np.sin(latitude) + equatorial * np.cos(hour_angle) * np.cos(latitude)
    zenith = np.arctan2(np.hypot(east, north), up)
    zenith = zenith + _EARTH_RADIUS_KM / _ASTRONOMICAL_UNIT_KM * np.sin(zenith)
    azimuth_deg = np.degrees(np.arctan2(east, north)) % 360 % 360  # −1e-15 % 360 is 360
    return SunPosition(azimuth_deg[()], (90 - np.degrees(zenith))[()])
