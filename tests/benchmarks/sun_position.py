"""Error of the sun's position against NREL's SPA, its solar position algorithm: over a century and latitudes.

Writes docs/charts/sun_position.json and sun_position.png.
"""

import json
import pathlib
from datetime import UTC, datetime, timedelta

import matplotlib
import numpy as np
import sunposition

from expanded_panoramas.ibl_toolkit.mobile.sun_position import CHARTED, METHODS, sun_position, world_direction

matplotlib.use("Agg")
import matplotlib.pyplot as plt

CHARTS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "charts"
LATITUDES = (-85, -66, -50, -35, -20, 0, 20, 35, 50, 66, 85)
TIMES = 40
"""Of a year, at each latitude; day and hour run through all of both."""
SITES = {"Rio de Janeiro": (-22.95, -43.17), "Golden, Colorado": (39.742476, -105.1786)}
SITE_YEARS = (2025, 2026)
FITTED = {"psa2020": (2020, 2050), "psa2001": (1999, 2015)}
DELTA_T = {  # [s], every tenth year: as observed, constant from 2020 on
    1950: 29.2, 1960: 33.2, 1970: 40.2, 1980: 50.5, 1990: 56.9, 2000: 63.8, 2010: 66.1, 2020: 69.4,
}  # fmt: skip
ARCSECONDS = 3600


def main():
    """Measure and write both files."""
    years = range(CHARTED[0], CHARTED[1] + 1)
    samples = [sample for year in years for sample in year_of(year)]
    errors = measured(samples)
    document = {
        "definitions": "angle [arc seconds] between directions to the sun, of the algorithm and of NREL's "
        "SPA (package sunposition 1.2.1), both without refraction, where the sun is up; the time is taken "
        f"for UT1; ΔT [s]: {DELTA_T}, linear between, constant after; each year {TIMES} times at each of the "
        f"latitudes {list(LATITUDES)}, longitudes all round; sites: every hour of {SITE_YEARS}",
        "samples": len(errors["psa2020"]),
        "fitted_to": FITTED,
        "spans": {
            f"{first}-{last}": {method: over(errors, method, first, last) for method in METHODS}
            for first, last in (*FITTED.values(), CHARTED)
        },
        "by_year": {
            method: [{"year": year, **over(errors, method, year, year)} for year in years]
            for method in METHODS
        },
        "by_latitude": {
            method: [
                {"latitude": latitude, **over(errors, method, *CHARTED, latitude)} for latitude in LATITUDES
            ]
            for method in METHODS
        },
        "sites_2025_2026": {name: at_site(*place) for name, place in SITES.items()},
    }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (CHARTS / "sun_position.json").write_text(text + "\n", encoding="utf-8")
    draw(document)
    print(text)


def year_of(year):
    """(time, latitude, longitude) over a year: day, hour and longitude take steps that fit nothing else."""
    start = datetime(year, 1, 1, tzinfo=UTC)
    for row, latitude in enumerate(LATITUDES):
        for k in range(TIMES):
            days = 365 * (k + row / len(LATITUDES)) / TIMES
            longitude = 360 * ((k * 0.618034 + row * 0.381966 + year * 0.23607) % 1) - 180
            yield start + timedelta(seconds=round(86400 * days)), latitude, longitude


def measured(samples):
    """Rows (year, latitude, error [arc seconds]) of the samples with the sun up, for each method."""
    times, latitudes, longitudes = (list(column) for column in zip(*samples, strict=True))
    found = {method: sun_position(times, latitudes, longitudes, method) for method in METHODS}
    up = np.flatnonzero(found[METHODS[0]].altitude_deg > 0)
    stamps = np.array([times[k].timestamp() for k in up])
    years = np.array([times[k].year for k in up])
    latitudes, longitudes = np.array(latitudes)[up], np.array(longitudes)[up]
    azimuth, zenith, *_ = sunposition.sunposition(
        stamps,
        latitudes,
        longitudes,
        elevation=0.0,
        pressure=0.0,
        delta_t=np.interp(years, list(DELTA_T), list(DELTA_T.values())),
    )
    reference = world_direction(azimuth, 90 - zenith)
    rows = {}
    for method in METHODS:
        chord = np.linalg.norm(found[method].direction[up] - reference, axis=1)
        rows[method] = np.stack([years, latitudes, np.degrees(2 * np.arcsin(chord / 2)) * ARCSECONDS], 1)
    return rows


def over(errors, method, first, last, latitude=None):
    """Largest and rms error over years from first to last, at all latitudes or at one."""
    rows = errors[method]
    rows = rows[(rows[:, 0] >= first) & (rows[:, 0] <= last)]
    if latitude is not None:
        rows = rows[rows[:, 1] == latitude]
    return {"max": round(rows[:, 2].max(), 1), "rms": round(float(np.sqrt(np.mean(rows[:, 2] ** 2))), 1)}


def at_site(latitude, longitude):
    """Errors over every hour of two years."""
    start, end = datetime(SITE_YEARS[0], 1, 1, tzinfo=UTC), datetime(SITE_YEARS[1] + 1, 1, 1, tzinfo=UTC)
    hours = int((end - start).total_seconds() // 3600)
    errors = measured([(start + timedelta(hours=k), latitude, longitude) for k in range(hours)])
    return {method: over(errors, method, *SITE_YEARS) for method in METHODS}


def draw(document):
    """Error by year, and by latitude."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained", sharey=True)
    for axis, name, key in zip(axes, ("by_year", "by_latitude"), ("year", "latitude"), strict=True):
        for method, colour in zip(METHODS, ("C0", "C1"), strict=True):
            rows = document[name][method]
            label = f"{method[:3].upper()} {method[3:]}"
            for what, style in (("max", "-"), ("rms", "--")):
                axis.plot(
                    [row[key] for row in rows],
                    [row[what] for row in rows],
                    style,
                    color=colour,
                    label=f"{label}, {what}",
                )
            if key == "year":
                axis.axvspan(*FITTED[method], color=colour, alpha=0.12, lw=0)
        axis.grid(alpha=0.3)
    axes[0].set(xlabel="year (shaded: fitted to)", ylabel="error against SPA [arc seconds]", ylim=(0, None))
    axes[1].set(xlabel=f"latitude [°], {CHARTED[0]} to {CHARTED[1]}")
    axes[1].legend(frameon=False, ncols=2, loc="lower center")
    figure.savefig(CHARTS / "sun_position.png", dpi=90)
    plt.close(figure)


if __name__ == "__main__":
    main()
