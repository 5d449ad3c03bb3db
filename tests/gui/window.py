"""A Blender in a window of its own: a display, a user folder with the zip installed, and a played job."""

import contextlib
import json
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import time

import build_zips
import cv2
import numpy as np

INSIDE = pathlib.Path(__file__).parent / "inside"
WIDTH, HEIGHT = 1280, 960
"""Of the window [px]: high enough for most of the sidebar."""
QUALITY = 85
SECONDS = 1200
"""After which a Blender is given up."""


class NoWindowError(RuntimeError):
    """This machine or this BLENDER shows no window; says why."""


class Display:
    """A virtual display of its own, so that nobody's windows are in the way, whose pixels are in a file."""

    def __init__(self, folder):
        """Start it. Raises NoWindowError where that cannot be."""
        if shutil.which("Xvfb") is None:
            raise NoWindowError("needs Xvfb, a virtual display (Debian: apt-get install xvfb)")
        command = ["Xvfb", "-displayfd", "1", "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir", folder]
        self._folder = folder
        self._server = subprocess.Popen(
            [*map(str, command), "+extension", "GLX", "-nolisten", "tcp", "-nocursor"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        )  # fmt: skip
        self.name = f":{self._server.stdout.readline().strip()}"

    def pixels(self):
        """What it shows: (height, width, 3), blue first, as OpenCV has it."""
        data = (self._folder / "Xvfb_screen0").read_bytes()
        header = np.frombuffer(data, ">u4", 25)  # an X window dump; "ncolors" entries of 12 bytes follow it
        size, width, height, line, colours = header[[0, 4, 5, 12, 19]]
        rows = np.frombuffer(data, np.uint8, line * height, size + 12 * colours).reshape(height, line)
        return np.ascontiguousarray(rows[:, : 4 * width].reshape(height, width, 4)[..., :3])

    def end(self):
        """Stop it."""
        self._server.terminate()
        self._server.wait()


def install(blender, user):
    """Build the zip without wheels and install it into the user folder as an artist would, switched on."""
    zipped = user / "expanded_panoramas.zip"
    build_zips.build(build_zips.ROOT, zipped)
    command = ["--background", "--command", "extension", "install-file", "-r", "user_default", "--enable"]
    with started(blender, user, user / "install.txt", [*command, zipped]) as process:
        process.wait(SECONDS)
    if process.returncode:
        raise RuntimeError(f"the zip was not installed: {(user / 'install.txt').read_text()[-3000:]}")


def play(blender, user, display, jobs, folder):
    """Play inside/`jobs` in a window -> its notes: {"jobs": …, "pictures": …, "printed": …}.

    Raises NoWindowError where BLENDER opens none; RuntimeError with what it printed where it ended too early.
    """
    printed, written = folder / "printed.txt", folder / "notes.json"
    # The driver comes first: in the background Blender refuses what is about a window, and stops there.
    arguments = ["--python", INSIDE / "driver.py", "--window-geometry", 0, 0, WIDTH, HEIGHT]
    arguments += ["--enable-event-simulate", "--", INSIDE / jobs, folder]
    with started(blender, user, printed, arguments, display.name) as process:
        late = time.monotonic() + SECONDS
        while process.poll() is None and time.monotonic() < late:
            take_pictures(display, folder)
            time.sleep(0.05)
        on_time = process.poll() is not None
    text = printed.read_text(encoding="utf-8", errors="replace")
    notes = json.loads(written.read_text(encoding="utf-8")) if written.exists() else {"jobs": {"none": {}}}
    if not notes["jobs"]:
        raise NoWindowError("this BLENDER runs in the background and opens no window")
    if not on_time or "complete" not in list(notes["jobs"].values())[-1]:
        raise RuntimeError(f"{jobs}: Blender ended early or late after {list(notes['jobs'])}: {text[-3000:]}")
    if process.returncode:
        raise RuntimeError(f"{jobs}: Blender ended with {process.returncode}: {text[-3000:]}")
    return {**notes, "printed": text}


@contextlib.contextmanager
def started(blender, user, printed, arguments, display=None):
    """Run Blender with a user folder of its own, its output in a file; at the end it is gone."""
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(user)}
    if display:
        environment["DISPLAY"] = display
    command = [*shlex.split(blender), *map(str, arguments)]
    with printed.open("w") as output:
        process = subprocess.Popen(
            command, env=environment, stdout=output, stderr=subprocess.STDOUT, start_new_session=True
        )
        try:
            yield process
        finally:
            if process.poll() is None:  # with the wrapper that may have started it
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def take_pictures(display, folder):
    """Take the pictures that the jobs inside wait for."""
    for wanted in folder.glob("*.wanted"):
        cv2.imwrite(str(wanted.with_suffix(".png")), display.pixels())
        wanted.unlink()


def crop(source, target, box):
    """Write what matters of a window's picture as a JPEG; `box` has its origin at the bottom left [px]."""
    picture = cv2.imread(str(source))
    if box is not None:
        left, bottom, width, height = (max(round(value), 0) for value in box)
        below = picture.shape[0] - bottom
        picture = picture[max(below - height, 0) : below, left : left + width]
    target.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(target), picture, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
