"""`panorama sun --latitude DEG --longitude DEG --time ISO8601`: where the sun stands."""

from ..ibl_toolkit.mobile.sun_position import METHODS, sun_position, time_from_iso, warnings_of
from .options import finite

SUMMARY = "tell where the sun stands, seen from a place at a time"


def add_options(parser):
    """Add the verb's own options."""
    add = parser.add_argument
    add("--latitude", metavar="DEG", type=finite, required=True, help="-90 to 90, positive to the north")
    add("--longitude", metavar="DEG", type=finite, required=True, help="-180 to 180, positive to the east")
    add("--time", metavar="ISO8601", required=True, help="with its zone: 2026-03-20T12:00:00Z or …+01:00")
    add("--method", choices=METHODS, default=METHODS[0], help=f"(default: {METHODS[0]})")


def run(options, progress):
    """Do the verb -> what `--json` prints."""
    return sun_at(options.latitude, options.longitude, options.time, options.method)


def sun_at(latitude_deg, longitude_deg, time, method=METHODS[0]):
    """The sun's azimuth, altitude and direction (+x east, +y north, +z up), with warnings.

    time: ISO 8601, with its zone. Raises ValueError without it, and for numbers out of range.
    """
    moment = time_from_iso(time)
    position = sun_position(moment, latitude_deg, longitude_deg, method)
    return {
        "azimuth_deg": float(position.azimuth_deg),
        "altitude_deg": float(position.altitude_deg),
        "direction": position.direction.tolist(),
        "time": moment.isoformat(),
        "method": method,
        "warnings": warnings_of(moment, position),
    }


def describe(result):
    """One line for each figure."""
    x, y, z = result["direction"]
    return [
        f"azimuth    {result['azimuth_deg']:.3f}° clockwise from north",
        f"altitude   {result['altitude_deg']:.3f}° above the horizon",
        f"direction  {x:.5f} east, {y:.5f} north, {z:.5f} up",
    ]
