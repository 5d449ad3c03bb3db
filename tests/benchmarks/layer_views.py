"""Views of the sample room in layers by each method, against Cycles and the bound; their cost.

Methods x views of Table 8.1 and C1; resolutions; kinds of layers; distances from the centre until beyond the
radius. Writes docs/charts/layer_views.json and .png, and C1's pictures, layer_views_c1.jpg. Captures and
truths are kept in out/bench/layers/. With --resolutions only C1 is seen again, in layers of every width; the
other rows stay. With --toy all is tiny and goes to out/bench/layers_toy/. Seconds are the processor's; memory
is what the process takes beside its panorama, and needs Linux.
"""

import ctypes
import json
import os
import pathlib
import sys
import time

import _layer_cases as cases
import _layer_charts as charts
import flip_evaluator
import numpy as np

from expanded_panoramas import cycles_integration
from expanded_panoramas.ibl_toolkit import metrics
from expanded_panoramas.ibl_toolkit.layers.files.atlas import atlas_of
from expanded_panoramas.ibl_toolkit.layers.making.continuous_pieces import cut_at_jumps
from expanded_panoramas.ibl_toolkit.layers.meshes.bounded_mesh import bounded_mesh
from expanded_panoramas.ibl_toolkit.layers.meshes.layer_mesh import quadtree_mesh, quadtree_of
from expanded_panoramas.ibl_toolkit.layers.raster.mesh_view import mesh_view
from expanded_panoramas.ibl_toolkit.layers.views.view_methods import METHODS
from expanded_panoramas.sample_scenes.layered_room.bound import bound_view
from expanded_panoramas.sample_scenes.layered_room.views import C0, C1, pinhole

BOUND = "bound"
DEFINITIONS = {
    "width": "pixels: layers of the usual width are captured, narrower ones are their mip levels; of wider "
    "ones depth is captured, and light where C1 looks; elsewhere it is interpolated, and C1 doesn't show it",
    "psnr": "dB of sRGB display values against Cycles, holes black",
    "flip": "mean of NVIDIA's LDR-FLIP, 67 pixels per degree",
    "holes": "pixels",
    "prepare_seconds": "processor seconds of making meshes, which serve all views",
    "seconds": "processor seconds of a view, from layers or prepared meshes",
    "prepare_memory": "by how much the resident set of the process grew at most [bytes] while making meshes",
    "memory": "by how much it was larger at most than before them [bytes] while drawing a view",
    BOUND: "the true surfaces at the pixels' centres, in the layers' colours",
}


def main():
    """Measure, and write figures and charts."""
    settings = cases.TOY if "--toy" in sys.argv else cases.FULL
    settings.folder.mkdir(parents=True, exist_ok=True)
    again = "--resolutions" in sys.argv
    planned = [(cases.TWO, width, [C1]) for width in settings.widths] if again else plan(settings)
    rows = [row for kind, width, seen in planned for row in measured(settings, kind, width, seen)]
    if again:
        rows = with_others(settings, rows)
    document = {
        "cores": os.cpu_count(),
        "size": settings.size,
        "truth_samples": settings.truth_samples,
        "capture_samples": settings.capture_samples,
        "kinds": cases.KINDS,
        "definitions": DEFINITIONS,
        "usual": settings.usual,
        "kinds_width": settings.kinds_width,
        "summary": summary(settings, rows),
        "rows": rows,
    }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (settings.charts / "layer_views.json").write_text(text + "\n", encoding="utf-8")
    charts.draw(document, settings.charts / "layer_views.png")
    if not again:
        charts.sheet(c1_pictures(settings), settings.charts / "layer_views_c1.jpg")
    print(json.dumps(document["summary"], indent=1))


def plan(settings):
    """Kinds, widths, and the views to be seen of each."""
    far = [cases.aside(distance) for distance in settings.distances]
    views = {settings.usual: [*settings.table, *far], settings.kinds_width: settings.compared}
    for width in settings.widths:
        yield cases.TWO, width, views.get(width, [C1])
    for kind in (cases.ONE, cases.MADE, cases.SURFACES):
        yield kind, settings.kinds_width, settings.compared


def with_others(settings, rows):
    """Rows, and those of other layers and views that were measured before."""
    told = [[row[key] for key in ("kind", "width", "view")] for row in rows]
    before = json.loads((settings.charts / "layer_views.json").read_text(encoding="utf-8"))["rows"]
    rows = [row for row in before if [row[key] for key in ("kind", "width", "view")] not in told] + rows
    order = [(kind, width) for kind, width, _ in plan(settings)]
    known = [row for row in rows if (row["kind"], row["width"]) in order]
    return sorted(known, key=lambda row: order.index((row["kind"], row["width"])))


def measured(settings, kind, width, seen):
    """Rows of one panorama: the bound, and each method, in all these views."""
    panorama = cases.panorama(settings, kind, width)
    for view in seen:
        camera, (_, distance) = pinhole(view, *settings.size), cases.truth(settings, view)
        found = bound_view(panorama, camera, distance)
        yield figures(settings, view, found) | {"kind": kind, "width": width, "method": BOUND}
    for method in METHODS:
        held = forget_memory()
        start = time.process_time()
        render = prepared(method, panorama)
        prepare_seconds, prepare_memory = time.process_time() - start, memory("VmHWM") - held
        for view in seen:
            forget_memory()
            start = time.process_time()
            found = render(pinhole(view, *settings.size))
            seconds = time.process_time() - start
            yield figures(settings, view, found) | {
                "kind": kind,
                "width": width,
                "method": method,
                "prepare_seconds": round(prepare_seconds, 2),
                "seconds": round(seconds, 2),
                "prepare_memory": prepare_memory,
                "memory": memory("VmHWM") - held,
                "triangles": found.triangles,
            }
        print(f"layer_views: {kind}, {width} px, {method}", file=sys.stderr, flush=True)


def prepared(method, panorama):
    """A function of a camera that has its meshes already, if the method has any to keep."""
    if method == "quadtree":
        meshes = [quadtree_mesh(layer, quadtree_of(layer)) for layer in panorama.layers]
        return lambda camera: mesh_view(panorama, camera, meshes, cut=False)
    if method == "mesh":
        parts = cut_at_jumps(panorama)
        meshes = [bounded_mesh(layer, parts.radius) for layer in parts.layers]
        return lambda camera: mesh_view(parts, camera, meshes)
    return lambda camera: METHODS[method](panorama, camera)


def figures(settings, view, found):
    """How far a view is from the truth."""
    radiance, _ = cases.truth(settings, view)
    shown = [metrics.display_values(picture).astype(np.float32) for picture in (radiance, found.radiance)]
    return {
        "view": view.name,
        "from_centre": round(float(np.linalg.norm(np.subtract(view.eye, cases.sizes.ORIGIN))), 3),
        "psnr": round(metrics.psnr(found.radiance, radiance), 2),
        "flip": round(float(flip_evaluator.evaluate(*shown, "LDR", applyMagma=False)[1]), 4),
        "holes": int(np.count_nonzero(found.holes)),
    }


def c1_pictures(settings):
    """Display values (H, W, 3) by title: C1 as it is, and as methods show it; the centre's view."""
    camera = pinhole(C1, *settings.size)
    two = cases.panorama(settings, cases.TWO, settings.usual)
    made = cases.panorama(settings, cases.MADE, settings.kinds_width)
    found = {method: METHODS[method](two, camera).radiance for method in ("adaptive", "quadtree", "mesh")}
    pictures = {
        "Cycles": cases.truth(settings, C1)[0],
        **{f"{method}, two layers": picture for method, picture in found.items()},
        "mesh, layers made of one RGB-D": METHODS["mesh"](made, camera).radiance,
        "what the centre sees": METHODS["mesh"](two, pinhole(C0, *settings.size)).radiance,
    }
    return {title: metrics.display_values(picture) for title, picture in pictures.items()}


def summary(settings, rows):
    """What was to be reached at C1, with the usual layers."""
    at_c1 = {
        row["method"]: row
        for row in rows
        if (row["kind"], row["width"], row["view"]) == (cases.TWO, settings.usual, C1.name)
    }
    best = max(METHODS, key=lambda method: at_c1[method]["psnr"])
    shares = {
        method: round(at_c1[method]["triangles"] / at_c1["grid"]["triangles"], 5)
        for method in ("quadtree", "mesh")
    }
    widest = {row["method"]: row for row in rows if row["width"] == settings.widths[-1]}
    return {
        "best_method": best,
        "best_below_bound_db": round(at_c1[BOUND]["psnr"] - at_c1[best]["psnr"], 2),
        "best_holes": at_c1[best]["holes"],
        "object_atlas_share": round(objects_share(settings), 4),
        "triangles_of_grid": shares,
        "quadtree_below_grid_db": round(at_c1["grid"]["psnr"] - at_c1["quadtree"]["psnr"], 2),
        "mesh_below_quadtree_db": round(at_c1["quadtree"]["psnr"] - at_c1["mesh"]["psnr"], 2),
        "widest": settings.widths[-1],
        "widest_below_bound_db": {
            method: round(widest[BOUND]["psnr"] - widest[method]["psnr"], 2) for method in METHODS
        },
        "widest_adaptive_seconds": widest["adaptive"]["seconds"],
        "widest_prepare": {
            method: [widest[method]["prepare_seconds"], widest[method]["prepare_memory"]]
            for method in ("quadtree", "mesh")
        },
    }


def objects_share(settings):
    """Area of the objects' atlas, of their map's."""
    objects = cases.panorama(settings, cases.TWO, settings.usual).layers[1]
    return atlas_of(objects.mask, objects.mapping).share


def forget_memory():
    """Give freed memory back, begin anew to look for the largest resident set; the present one [bytes]."""
    ctypes.CDLL("libc.so.6").malloc_trim(0)
    pathlib.Path("/proc/self/clear_refs").write_text("5")
    return memory("VmRSS")


def memory(name):
    """The resident set [bytes], VmRSS, or the largest since `forget_memory`, VmHWM."""
    status = pathlib.Path("/proc/self/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith(name)).split()[1]) * 1024


if __name__ == "__main__":
    cycles_integration.register()
    main()
