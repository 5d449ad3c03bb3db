"""Jobs in which something ends a tool or long work: Esc, a file, the add-on, Blender. Runs in Blender."""

import addon_utils
import bpy
import hotel
import look
from jobs_flow import FLOOR_RECTANGLE, click_at, is_idle, package, press, state, view, wait
from waiting import Until
from watch import Watch


def sample(stage):
    """The sample room, calibrated and built, seen from the point of capture; the sidebar open."""
    bpy.ops.panorama.load_sample()
    bpy.ops.panorama.calibrate()
    bpy.ops.panorama.build()
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.ops.ed.undo_push(message="The sample room")
    yield from look.open_sidebar(stage.hand, view())
    with look.override(view()):
        bpy.ops.panorama.look_around()
    yield


def tool():
    """The label of the tool that runs, "" where none does."""
    found = package("operators.tools").active_tool()
    return found.label if found else ""


def escape(stage):
    """Click points with either tool, then give up: the scene is as before, and Ctrl Z does what it did."""
    yield from sample(stage)
    before, ran = state(), []
    for words in (("panorama.pick_points",), ("draw_shape", "room")):
        yield from press(stage, *words)
        yield from click_at(stage, FLOOR_RECTANGLE[1])
        yield from click_at(stage, FLOOR_RECTANGLE[2])
        ran.append(tool())
        yield from stage.hand.key("ESC")
        yield
    stage.note(before=before, ran=ran, after=state(), still=tool())


def another_file(stage):
    """Load a file while a tool runs; then begin again in it."""
    yield from sample(stage)
    yield from press(stage, "panorama.pick_points")
    yield from click_at(stage, FLOOR_RECTANGLE[1])
    ran = tool()
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield
    stage.note(ran=ran, after_loading=tool())
    yield from sample(stage)
    yield from press(stage, "panorama.pick_points")
    stage.note(again=tool())
    yield from stage.hand.key("ESC")
    yield


def another_scene(stage):
    """Change the scene while a tool runs, and come back."""
    yield from sample(stage)
    first = bpy.context.scene
    yield from press(stage, "draw_shape", "room")
    ran = tool()
    bpy.context.window_manager.windows[0].scene = bpy.data.scenes.new("Other")
    yield from stage.hand.move(*look.middle(look.region(view())))
    yield
    bpy.context.window_manager.windows[0].scene = first
    yield from stage.hand.move(*look.middle(look.region(view())), steps=3)
    yield from stage.hand.key("ESC")
    yield
    stage.note(ran=ran, still=tool())


def add_on_switched_off(stage):
    """Disable the add-on while a tool and long work run, count what is left, and enable it again."""
    name = hotel.addon().__name__
    addon_utils.disable(name)
    watch = Watch()
    addon_utils.enable(name)
    yield
    yield from sample(stage)
    yield from press(stage, "panorama.prepare")
    yield from wait(5)
    is_working = not is_idle()
    yield from press(stage, "panorama.pick_points")
    yield from stage.hand.move(*look.middle(look.region(view())))
    yield from wait(5)
    stage.note(ran=tool(), is_working=is_working, during=watch.left())
    addon_utils.disable(name)
    yield from wait(5)
    yield from stage.hand.move(*look.middle(look.region(view())), steps=3)
    stage.note(left=watch.left())
    watch.end()
    addon_utils.enable(name)
    yield
    stage.note(keeps_picks=len(bpy.context.scene.panorama_set.picks))


def long_work_cancelled(stage):
    """Begin to prepare the light, press Esc: the scene is as before."""
    yield from sample(stage)
    before = state()
    yield from press(stage, "panorama.prepare")
    yield from wait(10)
    ran = not is_idle()
    yield from stage.hand.move(*look.middle(look.region(view())))
    yield from stage.hand.key("ESC")
    yield Until(is_idle, "an end")
    yield
    stage.note(ran=ran, before=before, after=state())


def quit_in_the_middle(stage):
    """Leave a tool and long work running; the driver quits Blender next."""
    yield from sample(stage)
    yield from press(stage, "panorama.prepare")
    yield from wait(5)
    is_working = not is_idle()
    yield from press(stage, "panorama.pick_points")
    yield from click_at(stage, FLOOR_RECTANGLE[1])
    stage.note(ran=tool(), is_working=is_working)


JOBS = (escape, another_file, another_scene, add_on_switched_off, long_work_cancelled, quit_in_the_middle)
