"""What a child Blender does for its parent: it opens the copy of the file, works, and writes the result.

It reads its `Job` from a folder and writes there too: `PROGRESS`, a JSON object per line with the step and
how many samples of a render are done, and in the end `RESULT`. Its standard input is a pipe that its parent
holds: once that is closed, also by the parent's own end, it cleans up and ends.
"""

from __future__ import annotations

import json
import os
import pickle
import re
import shutil
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np

from ...ibl_toolkit.images import atomic

JOB, FILE, PROGRESS, RESULT, OUTPUT = "job.pickle", "scene.blend", "progress.jsonl", "result.pickle", "output"
SAMPLES = re.compile(r"Sample (\d+)/(\d+)")
TOLD_EVERY = 0.5
"""Samples are told no more often [s]."""
NICENESS = 5
"""The child has all processors, and the window goes first."""


@dataclass(frozen=True)
class Job:
    """What is to be done."""

    long_part: Callable
    """A function of a module: long_part(scene, tell, **inputs) -> result; tell(step) says what begins."""
    scene: str
    inputs: dict
    edited_images: dict[str, tuple[str, tuple[int, int]]]
    """Of images whose pixels are in no file: name -> their array's file, and their size [px]."""
    use_scripts: bool
    """Whether the file may run its own Python, as drivers do."""


@dataclass(frozen=True)
class Result:
    """What came of it: a value, or why there is none."""

    value: object = None
    refusal: str = ""


def main(folder: str):
    """Do the job in a folder."""
    folder = Path(folder)
    rubbish = (folder, bpy.app.tempdir)
    threading.Thread(target=_end_with_parent, args=rubbish, daemon=True).start()
    if hasattr(os, "nice"):  # Windows is told when the child starts
        os.nice(NICENESS)
    _register()
    job = pickle.loads((folder / JOB).read_bytes())
    bpy.ops.wm.open_mainfile(filepath=str(folder / FILE), load_ui=False, use_scripts=job.use_scripts)
    _take_edited_images(folder, job)
    scene = bpy.data.scenes[job.scene]
    bpy.context.window.scene = scene
    result = _result(job, scene, folder)
    with atomic.replacing(folder / RESULT) as path:
        path.write_bytes(pickle.dumps(result))


def save_edited_images(folder: Path) -> dict[str, tuple[str, tuple[int, int]]]:
    """Write the pixels of images that no file has, not even the .blend -> `Job.edited_images`."""
    found = {}
    for number, image in enumerate(bpy.data.images):
        if image.is_dirty and image.library is None and image.source in {"FILE", "GENERATED"}:
            pixels = np.empty(len(image.pixels), np.float32)
            image.pixels.foreach_get(pixels)
            np.save(folder / f"image_{number}.npy", pixels)
            found[image.name] = f"image_{number}.npy", tuple(image.size)
    return found


def _end_with_parent(*rubbish):
    while os.read(0, 1):
        pass
    atomic.discard_unfinished()
    for folder in rubbish:
        shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)


def _register():
    """Register the extension, unless the user's settings have it enabled."""
    if not hasattr(bpy.types.Scene, "panorama_place"):
        import_module(__package__.rpartition(".")[0].rpartition(".")[0]).register()


def _take_edited_images(folder, job):
    for name, (file, size) in job.edited_images.items():
        image = bpy.data.images[name]
        if tuple(image.size) != size:
            image.scale(*size)
        image.pixels.foreach_set(np.load(folder / file))
        image.pack()  # or the first render drops them


def _result(job, scene, folder) -> Result:
    with (folder / PROGRESS).open("a", encoding="utf-8", buffering=1) as file:
        teller = _Teller(file)
        bpy.app.handlers.render_stats.append(teller.on_render_stats)
        try:
            return Result(job.long_part(scene, teller.tell, **job.inputs))
        except (ValueError, OSError) as error:
            return Result(refusal=str(error))
        finally:
            bpy.app.handlers.render_stats.remove(teller.on_render_stats)


class _Teller:
    def __init__(self, file):
        self.file, self.told = file, 0.0

    def tell(self, step):
        self._write({"step": step})

    def on_render_stats(self, text, *_):
        found = SAMPLES.search(text)
        if found and time.monotonic() >= self.told + TOLD_EVERY:
            self.told = time.monotonic()
            self._write({"samples": [int(found[1]), int(found[2])]})

    def _write(self, what):
        self.file.write(json.dumps(what) + "\n")
