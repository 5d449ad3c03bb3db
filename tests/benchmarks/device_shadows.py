"""The shadows of small devices by the preview's own nodes in the hotel room, beside the one Cycles traces.

After Fig. 12 (shadow mapping, PCF, VSM) and Fig. 9 (resolutions) of *Realistic Shadows for Mobile AR*, with
acne, peter-panning and several lights. Writes docs/images/device_shadows*.jpg and
docs/charts/device_shadows.json. With --quick FOLDER: small and noisy, there.
"""

import json
import pathlib
import sys

import cv2
import numpy as np
from _device_shadow_room import Room
from _device_shadow_sheet import write_sheet

from expanded_panoramas.cli import blender
from expanded_panoramas.cli.progress import Progress
from expanded_panoramas.ibl_toolkit.images.png import srgb_from_linear

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
SIDE, SAMPLES = 360, 32
QUICK_SIDE, QUICK_SAMPLES = 200, 4
EXPOSURE = 1.5
"""Times the photograph's own."""
WHOLE, EDGE, FACE = None, (0.60, 0.14, 0.94, 0.48), (0.06, 0.50, 0.36, 0.80)
FOOT = (0.38, 0.12, 0.90, 0.64)
"""Parts of the view: left, bottom, right, top."""
WINDOW = 9
"""Texels [odd]; the paper's PCF has 8 × 8."""
METHODS = {"hard": "Shadow mapping", "pcf": "PCF 9 × 9", "vsm": "VSM", "evsm": "EVSM"}
RESOLUTIONS = (2048, 1024, 512)
OFFSETS = {
    "no offset: acne": (0.0, 0.0),
    "by itself": None,
    "too large: peter-panning": (0.0, 28000.0),
}


def main():
    """Render the sheets and write the figures."""
    is_quick = sys.argv[1:2] == ["--quick"]
    side, samples = (QUICK_SIDE, QUICK_SAMPLES) if is_quick else (SIDE, SAMPLES)
    folder = pathlib.Path(sys.argv[2]) if is_quick else DOCS
    for part in ("images", "charts"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    progress = Progress()
    with blender.empty_scene(progress), progress.step("pictures"):
        room = Room(side, samples)
        document = {
            "definitions": "rms_255: difference of the picture from the traced one, 8-bit sRGB, in the whole "
            "or a part; mib: the map on the device; window: width of the filter [texels]",
            "lamp_deg": round(np.degrees(room.sun.data.angle), 2),
            "methods": methods(room, folder),
            "resolutions": resolutions(room, folder),
            "offsets": offsets(room, folder),
            "lights": lights(room, folder),
        }
    text = json.dumps(document, indent=1, ensure_ascii=False)
    (folder / "charts" / "device_shadows.json").write_text(text + "\n", encoding="utf-8")
    print(text)


def methods(room, folder):
    """The sheet of the four methods and the truth -> rows of its figures."""
    parts = {"whole": WHOLE, "edge": EDGE, "face": FACE}
    columns, rows = {}, []
    room.take_off()
    traced = {name: display(room, room.traced(part)) for name, part in parts.items()}
    for method, title in METHODS.items():
        room.preview(method=method, resolution=512, window=WINDOW)
        shown = {name: display(room, room.picture(part)) for name, part in parts.items()}
        columns[title] = list(shown.values())
        off = {f"rms_255_{name}": difference(shown[name], traced[name]) for name in parts}
        rows.append({"method": method, "resolution": 512, "window": room.window, "mib": room.mib, **off})
    columns["Traced by Cycles"] = list(traced.values())
    write_sheet(folder / "images" / "device_shadows.jpg", columns)
    return rows


def resolutions(room, folder):
    """The sheet of VSM by resolution -> rows of its figures."""
    columns, rows = {}, []
    for resolution in RESOLUTIONS:
        room.preview(method="vsm", resolution=resolution, window=7)
        columns[f"{resolution} × {resolution}"] = [display(room, room.picture(p)) for p in (EDGE, FACE)]
        rows.append({"method": "vsm", "resolution": resolution, "window": 7, "mib": room.mib})
    write_sheet(folder / "images" / "device_shadows_resolution.jpg", columns)
    return rows


def offsets(room, folder):
    """The sheet of acne, the chosen offset, and peter-panning -> rows of its figures."""
    columns, rows = {}, []
    for title, offset in OFFSETS.items():
        room.preview(method="hard", resolution=512, window=1, offset=offset)
        columns[title] = [display(room, room.picture(FOOT))]
        rows.append({"offset": title, "factor": room.offset[0], "units": room.offset[1]})
    write_sheet(folder / "images" / "device_shadows_offset.jpg", columns)
    return rows


def lights(room, folder):
    """The sheet of one light, another made as strong, and both -> rows of its figures."""
    columns, rows = {}, []
    room.suns[1].data.energy = room.sun.data.energy
    for title, chosen in (("one lamp", [0]), ("another", [1]), ("both", [0, 1])):
        room.shine(chosen)
        room.preview(method="evsm", resolution=1024, window=9)
        columns[title] = [display(room, room.picture(WHOLE))]
        rows.append({"lights": len(chosen), "mib": room.mib})
    write_sheet(folder / "images" / "device_shadows_lights.jpg", columns)
    return rows


def display(room, picture):
    """8-bit sRGB, red first."""
    return np.round(255 * srgb_from_linear(picture * room.exposure * EXPOSURE)).astype(np.uint8)


def difference(shown, traced):
    """Root of the mean squared difference of two pictures."""
    off = cv2.absdiff(shown, traced).astype(np.float64)
    return round(float(np.sqrt((off**2).mean())), 2)


if __name__ == "__main__":
    main()
