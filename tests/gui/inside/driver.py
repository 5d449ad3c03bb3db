"""Plays jobs in a Blender window, one event at a time, and writes what they noted. Runs in Blender:

    blender --enable-event-simulate --python driver.py -- JOBS.py FOLDER

JOBS.py has a tuple JOBS of generator functions that take a Stage. A generator waits by `yield`: of nothing,
until Blender has handled its events and drawn; of what waiting.py has, as that says. FOLDER/notes.json gets,
for each job, what it noted and, where it failed, "error".
"""

import importlib.util
import json
import pathlib
import sys
import time
import traceback

import bpy

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from hand import Hand
from waiting import AT_ONCE, Until

TURNS = 2
"""Rounds of Blender's main loop between two steps: in the first it handles events and draws."""
FAILURES = (
    ArithmeticError, AssertionError, AttributeError, LookupError, NameError, OSError, ReferenceError,
    RuntimeError, TypeError, ValueError,
)  # fmt: skip


class Stage:
    """What a job plays with: a hand, and the notes it takes."""

    def __init__(self, folder):
        self.folder, self.hand, self.notes, self.pictures = folder, Hand(), {}, {}

    def note(self, **facts):
        """Keep facts for the tests outside."""
        self.notes.update(facts)

    def picture(self, name, box=None):
        """Have a picture taken of the window; `box` (left, bottom, width, height) [px] is what matters.

        It is taken outside: Blender's own screenshots are black where the graphics card is software.
        """
        for _ in range(3):
            yield
        self.pictures[name] = box
        wanted = self.folder / f"{name}.wanted"
        wanted.touch()
        yield Until(lambda: not wanted.exists(), f"picture {name}")


def fresh_file():
    """Begin with Blender's own startup file; the add-on stays on."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)


def settle_preferences(folder):
    """A window without what comes by itself: splash, tool tips, animated regions, other windows."""
    view = bpy.context.preferences.view
    view.show_splash = view.show_tooltips = False
    view.filebrowser_display_type = view.render_display_type = "SCREEN"
    view.smooth_view = 0
    # Others draw the view eight times after each change.
    bpy.context.preferences.system.viewport_aa = "FXAA"
    bpy.context.preferences.filepaths.temporary_directory = str(folder)
    bpy.context.preferences.use_preferences_save = False


def play(jobs, stage):
    """Play one job after the other, each from a fresh file; a generator."""
    everything = {}
    for job in jobs:
        stage.notes = everything[job.__name__] = {}
        print("PLAY", job.__name__, flush=True)
        began = time.monotonic()
        try:
            fresh_file()
            yield
            yield from job(stage)
        except FAILURES:
            stage.note(error=traceback.format_exc())
            yield from on_failure(stage, job.__name__)
        stage.note(seconds=round(time.monotonic() - began, 2))
        write(stage.folder, everything, stage.pictures)
    stage.note(complete=True)
    write(stage.folder, everything, stage.pictures)


def on_failure(stage, name):
    """A picture of what was there, then out of every tool and menu."""
    print(stage.notes["error"], flush=True)
    yield from stage.picture(f"failed_{name}")
    for _ in range(3):
        yield from stage.hand.key("ESC")


def write(folder, notes, pictures):
    """Write the notes so far: what a crash leaves tells where it was."""
    text = json.dumps({"jobs": notes, "pictures": pictures}, indent=1)
    (folder / "notes.json").write_text(text, encoding="utf-8")


class Pump:
    """Blender's timer: gives a generator its turns."""

    def __init__(self, steps):
        self.steps, self.turns, self.wanted, self.began = steps, TURNS, None, time.monotonic()
        self.__name__ = "Pump"

    def __call__(self):
        """One round of the main loop; 0 asks for the next, None ends."""
        if not self.is_ready():
            return 0.0
        try:
            self.wanted = next(self.steps)
        except StopIteration:
            bpy.ops.wm.quit_blender()
            return None
        self.turns, self.began = TURNS, time.monotonic()
        if self.wanted == AT_ONCE:
            self.turns, self.wanted = 1, None
        return 0.0

    def is_ready(self):
        """Whether what the generator waits for is there."""
        self.turns -= 1
        if self.turns > 0:
            return False
        if self.wanted is None or self.wanted.condition():
            return True
        if time.monotonic() - self.began > self.wanted.seconds:
            problem = TimeoutError(f"not after {self.wanted.seconds} s: {self.wanted.what}")
            self.wanted = self.steps.throw(problem)
            self.turns, self.began = TURNS, time.monotonic()
        return False


def main():
    """Play the jobs that the command line names."""
    path, folder = map(pathlib.Path, sys.argv[sys.argv.index("--") + 1 :][:2])
    if bpy.app.background:
        write(folder, {}, {})
        return
    spec = importlib.util.spec_from_file_location(path.stem, path)
    jobs = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(jobs)
    settle_preferences(folder)
    bpy.app.timers.register(Pump(play(jobs.JOBS, Stage(folder))), first_interval=1, persistent=True)


if __name__ == "__main__":
    main()
