"""Long work in a child process: what becomes of its result, its errors and its end, and of the scene."""

import os
import pickle
import sys
import time
from types import SimpleNamespace

import numpy as np
import panoramas
import pytest
from room_job import built, write_room

PATIENCE_S = 20
"""A child that takes longer has hung."""
RESULTS = {
    "succeeds": "os.replace('ready.pickle', 'result.pickle'); input()",
    "dies": "print('out of memory'); sys.exit(3)",
    "waits": "sys.stdin.read()",
    "hangs": "time.sleep(60)",
}


@pytest.fixture
def long_work(fresh_blend):
    from expanded_panoramas.operators import long_work

    yield long_work
    long_work.stop()


@pytest.fixture
def fake(long_work, monkeypatch):
    """fake(behaviour, result) makes an operator whose child does that, and its context."""
    from expanded_panoramas.operators.child import start
    from expanded_panoramas.operators.child.job import Result

    def make(behaviour, result=None):
        def command(folder):
            with open(f"{folder}/ready.pickle", "wb") as file:
                pickle.dump(Result(value=7) if result is None else Result(refusal=result), file)
            lines = '{"step": "depth"}\n{"samples": [3, 8]}\n{"st'  # the last one half written
            tell = f"open('progress.jsonl', 'a').write({lines!r})"
            code = f"import os, sys, time; os.chdir({folder!r}); {tell}; {RESULTS[behaviour]}"
            return [sys.executable, "-c", code]

        monkeypatch.setattr(start, "command", command)
        return operator(long_work), window_context()

    return make


def operator(long_work):
    """The shared half of every long operator, without Blender's half."""

    class Fake(long_work.LongWork):
        bl_label = "Fake Work"
        long_part = staticmethod(os.getcwd)

        def __init__(self):
            self.reported, self.applied = [], []

        def report(self, kind, text):
            self.reported.append((*kind, text))

        @staticmethod
        def depends_on(scene):
            return scene["room"]

        def apply(self, scene, found):
            self.applied.append((scene.name, found))
            return f"found {found}"

    return Fake()


def window_context():
    import bpy

    scene, manager = bpy.context.scene, bpy.context.window_manager
    scene["room"] = "as it was"
    window = manager.windows[0]
    half = SimpleNamespace(event_timer_add=manager.event_timer_add, modal_handler_add=lambda _: 0)
    return SimpleNamespace(scene=scene, window=window, workspace=window.workspace, window_manager=half)


def event(kind, value="NOTHING"):
    return SimpleNamespace(type=kind, value=value)


def until_answered(operator, context):
    """Feed it timer events until it lets no more pass."""
    end = time.monotonic() + PATIENCE_S
    while (answer := operator.modal(context, event("TIMER"))) == {"PASS_THROUGH"}:
        assert time.monotonic() < end
        time.sleep(0.01)
    return answer


def child_of(long_work):
    child = long_work._running.child
    return child.process, child.path


def is_gone(process, folder):
    end = time.monotonic() + PATIENCE_S
    while (process.poll() is None or folder.exists()) and time.monotonic() < end:
        time.sleep(0.01)
    return process.poll() is not None and not folder.exists()


def test_success_is_applied_once(long_work, fake):
    work, context = fake("succeeds")
    assert work.begin(context) == {"RUNNING_MODAL"}
    child = child_of(long_work)
    assert until_answered(work, context) == {"FINISHED"}
    assert work.applied == [(context.scene.name, 7)]
    assert work.reported == [("INFO", "found 7")]
    assert is_gone(*child)
    assert long_work.running() == ""


@pytest.mark.parametrize(
    ("behaviour", "refusal", "said"),
    [
        ("succeeds", "the place has no surfaces", "the place has no surfaces"),
        ("dies", None, "ended with status 3: out of memory"),
    ],
)
def test_an_error_of_the_child_is_reported(long_work, fake, behaviour, refusal, said):
    work, context = fake(behaviour, refusal)
    work.begin(context)
    assert until_answered(work, context) == {"CANCELLED"}
    assert work.applied == []
    assert work.reported[0][0] == "ERROR"
    assert work.reported[0][1].endswith(said)
    assert long_work.running() == ""


def test_a_button_ends_the_child_from_any_window(fresh_blend, long_work, fake):
    work, context = fake("waits")
    with pytest.raises(RuntimeError, match="No long work is running"):
        fresh_blend.ops.panorama.cancel_work()
    work.begin(context)
    child = child_of(long_work)
    assert fresh_blend.ops.panorama.cancel_work() == {"FINISHED"}
    assert is_gone(*child)
    assert work.modal(context, event("A", "PRESS")) == {"CANCELLED", "PASS_THROUGH"}


@pytest.mark.parametrize("behaviour", ["waits", "hangs"])
def test_escape_ends_the_child(long_work, fake, behaviour):
    work, context = fake(behaviour)
    work.begin(context)
    child = child_of(long_work)
    assert work.modal(context, event("A", "PRESS")) == {"PASS_THROUGH"}
    assert work.modal(context, event("ESC", "RELEASE")) == {"PASS_THROUGH"}
    assert work.modal(context, event("ESC", "PRESS")) == {"CANCELLED"}
    assert is_gone(*child)
    assert work.applied == []
    assert long_work.running() == ""


def test_the_end_of_blender_or_another_file_ends_the_child(long_work, fake):
    work, context = fake("waits")
    work.begin(context)
    child = child_of(long_work)
    work.cancel(context)
    assert is_gone(*child)


def test_unregistering_ends_the_child(long_work, fake):
    import expanded_panoramas

    work, context = fake("waits")
    work.begin(context)
    child = child_of(long_work)
    expanded_panoramas.unregister()
    expanded_panoramas.register()
    assert is_gone(*child)
    assert work.modal(context, event("A", "PRESS")) == {"CANCELLED", "PASS_THROUGH"}


def test_progress_is_shown(long_work, fake):
    work, context = fake("waits")
    work.begin(context)
    end = time.monotonic() + PATIENCE_S
    while long_work._running.child.samples is None and time.monotonic() < end:
        work.modal(context, event("TIMER"))
    assert long_work._running.text().startswith("Fake Work: depth, sample 3 of 8, 0:0")


def test_a_changed_place_gets_no_old_result(long_work, fake):
    work, context = fake("succeeds")
    work.begin(context)
    context.scene["room"] = "rebuilt"
    assert until_answered(work, context) == {"CANCELLED"}
    assert work.applied == []
    assert "changed meanwhile" in work.reported[0][1]


def test_a_renamed_scene_is_found_and_a_removed_one_is_not(fresh_blend, long_work, fake):
    work, context = fake("succeeds")
    work.begin(context)
    context.scene.name = "other"
    fresh_blend.data.scenes.new("Scene")
    assert until_answered(work, context) == {"FINISHED"}
    assert work.applied == [("other", 7)]
    work.begin(context)
    fresh_blend.data.scenes.remove(context.scene)
    assert until_answered(work, context) == {"CANCELLED"}
    assert "its scene is gone" in work.reported[-1][1]


def test_one_at_a_time(fresh_blend, long_work, fake, tmp_path):
    built(fresh_blend, tmp_path)
    work, context = fake("waits")
    assert fresh_blend.ops.panorama.prepare.poll()
    work.begin(context)
    for name in ("prepare", "light_from_infinity", "export_depth", "render_panorama", "restore_light"):
        with pytest.raises(RuntimeError, match="Fake Work is running: wait, or cancel it with Esc"):
            getattr(fresh_blend.ops.panorama, name)()


@pytest.fixture
def start_child(fresh_blend, monkeypatch):
    """Starts the real child, as the Python of the wheel."""
    from expanded_panoramas.operators.child import start

    blender = start.command
    monkeypatch.setattr(start, "command", lambda folder: [sys.executable, "-c", blender(folder)[-1]])
    return start.start_child


def wait_for(child):
    end = time.monotonic() + PATIENCE_S
    while not child.is_done():
        assert time.monotonic() < end
        time.sleep(0.01)
    child.read_progress()


def test_the_child_measures_what_is_in_no_file(fresh_blend, start_child, tmp_path):
    """The file was never saved, pixels of the panorama were painted; the child's light is that of here."""
    from expanded_panoramas.cycles_integration import place_digest, preparation
    from expanded_panoramas.operators import light

    bpy = fresh_blend
    scene, here = panoramas.room_place(bpy, panoramas.smooth_panorama(tmp_path / "smooth.exr"))
    painted = np.array(here.image.pixels[:], np.float32).reshape(32, 64, 4)
    painted[24:26, 20:24] = 40  # a lamp on the wall
    here.image.pixels.foreach_set(painted.ravel())
    bpy.context.view_layer.update()
    before = place_digest.digest_of_place(scene)
    child = start_child(light.measure_light, scene, {"most": 2})
    wait_for(child)
    found = child.value()
    child.stop().join()
    assert (bpy.data.filepath, place_digest.digest_of_place(scene)) == ("", before)
    assert here.irradiance is None
    assert child.step == "irradiance"
    here.image.pack()  # without a window, a render drops what is painted
    here_and_now = preparation.measure(scene, 2)
    assert len(found.lamps.split.lamps) == len(here_and_now.lamps.split.lamps) > 0
    assert np.allclose(found.irradiance, here_and_now.irradiance, rtol=1e-3)


def test_a_child_without_parent_ends_and_cleans_up(fresh_blend, start_child, tmp_path):
    """To the child, a parent that was killed looks as one that closes the pipe."""
    from expanded_panoramas.operators import pictures

    built(fresh_blend, tmp_path)
    fresh_blend.context.scene.panorama_set.job.samples = 4096
    inputs = {"path": str(tmp_path / "whole.exr"), "width": 4096}
    child = start_child(pictures.render_panorama, fresh_blend.context.scene, inputs)
    child.process.stdin.close()
    assert child.process.wait(PATIENCE_S) == 1
    assert not child.path.exists()
    assert not list(tmp_path.glob("*whole*"))
    child.stop().join()


def test_a_refusal_of_the_child_is_its_own_words(fresh_blend, start_child, tmp_path):
    from expanded_panoramas.operators import clipped_light

    fresh_blend.ops.panorama.import_set(filepath=str(write_room(tmp_path)))
    fresh_blend.ops.panorama.calibrate()
    inputs = {"path": str(tmp_path / "restored.exr"), "known": "IRRADIANCE", "value": 1.0}
    child = start_child(clipped_light.restore_light, fresh_blend.context.scene, inputs)
    wait_for(child)
    with pytest.raises(ValueError, match="clipped"):
        child.value()
    child.stop().join()
    assert not (tmp_path / "restored.exr").exists()
