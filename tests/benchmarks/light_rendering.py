"""Error against time of the ways to light a scene by a map: plain, suns only, pre-sampled, hybrid.

The eight maps that ship with Blender at infinity and three rebuilt rooms, each with a diffuse, a glossy and a
mixed scene; the thesis's Table 3.1 and Fig. 3-5. Writes docs/charts/light_rendering.json,
light_rendering.png and light_rendering_table.png. References are rendered once and kept in out/bench/light/;
with --keep, so are pictures that a run which was cut short has left there.
"""

import json
import os
import pickle
import sys

import _light_cases as cases
import _light_charts as charts
import _light_errors as errors
import numpy as np
from _light_cases import DL, FORCED, HIB, MPA, PLAIN, Case
from _light_references import half_samples, reference

from expanded_panoramas import cycles_integration

ROUNDS, MORE_ROUNDS = 2, {"studio": 4}  # for a steadier clock
COUNTS, SUNS_COUNTS = (4, 64), (4, 16)
PLAIN_ROOM_COUNTS, HYBRID_ROOM_COUNTS = (16, 64, 256), (1, 4, 16, 64, 256)
ROUNDING = 1e-6
TABLE_CASE, TABLE_COUNTS, TABLE_WAYS = (
    Case("studio", "mixed"),
    (4, 16, 64, 256),
    (PLAIN, MPA, HIB),
)


def main():
    """Measure all cases and write figures and charts."""
    cases.CACHE.mkdir(parents=True, exist_ok=True)
    measured = {case: kept(case.slug, lambda case=case: measure(case)) for case in cases.all_cases()}
    of_table = kept("table", lambda: measure(TABLE_CASE, dict.fromkeys(TABLE_WAYS, TABLE_COUNTS)))
    rows = [figures(case, found) for case, found in measured.items()]
    document = {
        "caption": caption(),
        "definitions": errors.DEFINITIONS,
        "cores": os.cpu_count(),
        "blender": cases.bpy.app.version_string,
        "size": [cases.WIDTH, cases.HEIGHT],
        "summary": summary(rows),
        "table": table(figures(TABLE_CASE, of_table)),
        "rows": rows,
    }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (charts.CHARTS / "light_rendering.json").write_text(text + "\n", encoding="utf-8")
    charts.draw(document)
    charts.draw_table(document["table"])
    print(json.dumps(document["summary"], indent=1))


def kept(name, measure_it):
    """What was measured before, with --keep; else measured now, and kept."""
    path = cases.CACHE / f"measured_{name}.pickle"
    if "--keep" in sys.argv and path.exists():
        return pickle.loads(path.read_bytes())
    measured = measure_it()
    path.write_bytes(pickle.dumps(measured))
    print(f"light_rendering: measured {name}", file=sys.stderr, flush=True)
    return measured


def measure(case, counts=None):
    """Pictures and seconds of a case -> {way: (Lights, {samples: [(picture, seconds), …]})}.

    In rounds, a way after the other, so that a busy minute of the machine is nobody's alone.
    """
    ways = counts or {way: counts_of(case, way) for way in case.ways}
    found, order = {}, list(ways)
    for number in range(MORE_ROUNDS.get(case.place, ROUNDS)):
        for way in order:
            lit = cases.light(case, way)
            if way == HIB and not lit.lights.count and FORCED not in ways:
                ways[FORCED] = COUNTS
                order.append(FORCED)
            _, runs = found.setdefault(way, (lit.lights, {}))
            for samples in ways[way]:
                runs.setdefault(samples, []).append(lit.render(samples, 1 + number))
    return found


def counts_of(case, way):
    """At how many samples a way is measured."""
    if case.is_room:
        return PLAIN_ROOM_COUNTS if way == PLAIN else HYBRID_ROOM_COUNTS
    return SUNS_COUNTS if way == DL else COUNTS


def figures(case, measured):
    """A row of the document."""
    halves = reference(case)
    ways = {}
    for way, (lights, runs) in measured.items():
        taken = {"lights": lights.count, "share": errors.rounded(lights.share), "reason": lights.reason}
        ways[way] = {**taken, **errors.curve(runs, halves)}
    plain = ways[PLAIN]
    return {
        "place": case.place,
        "kind": case.kind,
        "reference_samples": 2 * half_samples(case),
        "ratios": {way: errors.time_ratio(plain, ways[way]) for way in ways if way != PLAIN},
        "flip_ratios": {way: errors.time_ratio(plain, ways[way], "flip") for way in ways if way != PLAIN},
        "left_alone": not measured[HIB][0].count,
        "same_pictures": same_pictures(measured[PLAIN][1], measured[HIB][1]),
        "ways": ways,
    }


def same_pictures(runs, others):
    """Whether both ways render the same in all rounds, but for the rounding of sums in another order."""
    return runs.keys() == others.keys() and all(
        np.abs(one - other).mean() < ROUNDING * one.mean()
        for samples in runs
        for (one, _), (other, _) in zip(runs[samples], others[samples], strict=True)
    )


def summary(rows):
    """What was to be reached, by place and over all."""
    by_place = {}
    for row in rows:
        by_place.setdefault(row["place"], []).append(row)
    places = {name: place_summary(of_place) for name, of_place in by_place.items()}
    taken = [row["ratios"][HIB] for row in rows if row["place"] not in cases.ROOMS and not row["left_alone"]]
    lit = [place for place in places.values() if not place["left_alone"]]
    rooms = [places[name] for name in cases.ROOMS]
    maps = [places[name] for name in places if name not in cases.ROOMS]
    return {
        "rooms_time_ratio": errors.geometric_mean([place["time_ratio"] for place in rooms]),
        "maps_time_ratio": errors.geometric_mean([place["time_ratio"] for place in maps]),
        "least_map_time_ratio": min([1.0, *taken]),
        "white_dots": total_dots([place["white_dots"] for place in lit]),
        "largest_bias_percent": max((place["bias_percent"] for place in lit), key=abs),
        "places": places,
    }


def place_summary(rows):
    """Of the hybrid in one place, over its kinds of scene.

    Where it leaves a map alone, its scene is the plain one and renders the same pictures; what was measured
    of its time tells the clock's noise.
    """
    hybrids = [row["ways"][HIB] for row in rows]
    forced = [row["ratios"][FORCED] for row in rows if FORCED in row["ratios"]]
    count, left_alone = len(hybrids), all(row["left_alone"] for row in rows)
    measured = errors.geometric_mean([row["ratios"][HIB] for row in rows])
    return {
        "lights": hybrids[0]["lights"],
        "share": hybrids[0]["share"],
        "reason": hybrids[0]["reason"],
        "left_alone": left_alone,
        "same_pictures": all(row["same_pictures"] for row in rows),
        "time_ratio": 1.0 if left_alone else measured,
        "measured_time_ratio": measured,
        "flip_time_ratio": errors.geometric_mean([row["flip_ratios"][HIB] for row in rows]),
        "forced_time_ratio": errors.geometric_mean(forced) if forced else None,
        "cost_ratio": errors.geometric_mean(
            [
                row["ways"][PLAIN]["per_sample_seconds"] / row["ways"][HIB]["per_sample_seconds"]
                for row in rows
            ]
        ),
        "bias_percent": errors.rounded(sum(h["bias_percent"] for h in hybrids) / count),
        "bias_standard_error": errors.rounded(
            sum(h["bias_standard_error"] ** 2 for h in hybrids) ** 0.5 / count
        ),
        "white_dots": total_dots([h["white_dots"] for h in hybrids]),
        "white_dots_plain": total_dots([row["ways"][PLAIN]["white_dots"] for row in rows]),
    }


def total_dots(counts):
    """Sums of white dots, by samples."""
    return {samples: sum(dots.get(samples, 0) for dots in counts) for samples in errors.DOTS_AT}


def table(row):
    """Table 3.1 for one map and scene: time as a share of the plain set-up's at its most samples."""
    longest = row["ways"][PLAIN]["points"][-1]["seconds"]
    lines = [
        {
            "way": "IS" if way == PLAIN else way,
            "samples": point["samples"],
            "time": errors.rounded(point["seconds"] / longest),
            "mse": point["mse"],
            "flip": point["flip"],
            "lights": row["ways"][way]["lights"],
            "share": row["ways"][way]["share"],
        }
        for way in TABLE_WAYS
        for point in row["ways"][way]["points"]
    ]
    return {
        "place": row["place"],
        "kind": row["kind"],
        "reference_samples": row["reference_samples"],
        "pre_samples": cases.PRE_SAMPLES,
        "ratios": row["ratios"],
        "lines": lines,
    }


def caption():
    """What was measured."""
    return (
        "Ways to light a scene. plain: the map as Cycles samples it, in rooms as the emission of the "
        f"textured mesh. {DL}: {cases.DIRECTIONAL_LIGHTS} constant suns by variance cut, as wide as their "
        f"regions. {MPA}: a pre-sampling map of {cases.PRE_SAMPLES} regions, {cases.PRE_WIDTH} pixels wide, "
        f"lights; camera, glossy and transmission rays see the map. {HIB}: the default of this project. "
        f"{FORCED}: {cases.MOST_LIGHTS[FORCED]} lights or fewer where the default leaves a map alone. Rooms: "
        "method single, supports made grey, so that no bake enters. References: the whole map, without a "
        "split; in rooms on a mesh of faces so small that Cycles can aim at its bright ones"
    )


if __name__ == "__main__":
    cycles_integration.register()
    main()
