"""Seconds and peak memory of `calibrate` and `depth` on a panorama of 16384 × 8192 pixels and on a small one.

The panoramas are half-float EXRs of noise with the set of the closed room, made in out/bench/ and removed
afterwards (1 GiB of disk). Writes docs/charts/large_panorama.json. Memory is the largest resident set of each
command's process; seconds are given as ratios to the small panorama's, taken in the same run.
"""

import json
import multiprocessing
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
CHARTS, CACHE = ROOT / "docs" / "charts", ROOT / "out" / "bench"
SIZES = ((2048, 1024), (16384, 8192))
SEED = 16


def main():
    """Measure both sizes and write the figures."""
    CACHE.mkdir(parents=True, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory(dir=CACHE) as folder:
        for size in SIZES:
            rows.append(measure(pathlib.Path(folder), size))
            print(rows[-1])
    small, large = (row["seconds"] for row in rows)
    document = {
        "caption": "Half-float EXR panoramas of noise, the set of the closed room; largest resident set of "
        "each command's process, and the seconds of the large panorama as ratios to the small one's",
        "cores": os.cpu_count(),
        "rows": rows,
        "seconds_ratio": {verb: round(large[verb] / small[verb], 1) for verb in large},
    }
    (CHARTS / "large_panorama.json").write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


def measure(folder, size):
    """Figures of both commands on a panorama of `size` (width, height) [px]."""
    image, set_path, depth = (folder / name for name in ("panorama.exr", "room.json", "depth.exr"))
    # A process of its own: what it needs, this one must not have, for a child starts with its parent's peak.
    maker = multiprocessing.get_context("spawn").Process(target=make_panorama, args=(image, set_path, size))
    maker.start()
    maker.join()
    if maker.exitcode:
        raise RuntimeError(f"{image}: making it ended with status {maker.exitcode}")
    file_bytes = image.stat().st_size
    seconds, peak = {}, {}
    for verb, options in (("calibrate", ()), ("depth", ("-o", depth))):
        seconds[verb], peak[verb] = run(verb, set_path, *options)
    return {
        "size": list(size),
        "file_gib": gib(file_bytes),
        "image_float_gib": gib(12 * size[0] * size[1]),
        "depth_file_gib": gib(depth.stat().st_size),
        "seconds": {verb: round(value, 1) for verb, value in seconds.items()},
        "peak_gib": {verb: gib(value) for verb, value in peak.items()},
    }


def make_panorama(image, set_path, size):
    """Write a panorama of noise and the closed room's set beside it."""
    import numpy as np

    from expanded_panoramas.ibl_toolkit.images import write_exr
    from expanded_panoramas.ibl_toolkit.panorama_set import write_set
    from expanded_panoramas.sample_scenes.closed_room_set import closed_room_set

    width, height = size
    rng = np.random.default_rng(SEED)
    channels = {name: np.empty((height, width), np.float16) for name in "RGB"}
    for channel in channels.values():
        for row in range(height):  # 8 bits of noise: as large a file as a photograph's
            channel[row] = 0.5 + rng.integers(0, 256, width, dtype=np.uint8) / 256
    write_exr(image, channels)
    write_set(closed_room_set(image), set_path)


def run(verb, *arguments):
    """Run one verb of the command line; (seconds, peak memory [bytes])."""
    command = [sys.executable, "-m", "expanded_panoramas.cli", verb, *map(str, arguments), "--json"]
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, cwd=ROOT)
    _, status, used = os.wait4(process.pid, 0)  # usage of this child alone; subprocess gives that of all
    seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise RuntimeError(f"{verb} ended with status {process.returncode}")
    return seconds, used.ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def gib(count):
    """Bytes as GiB."""
    return round(count / 2**30, 3)


if __name__ == "__main__":
    main()
