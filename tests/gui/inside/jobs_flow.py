"""The manual's five minutes: a panorama dropped, calibrated, rebuilt and rendered into. Runs in Blender."""

import importlib
import time

import bpy
import hotel
import look
from waiting import Until

FLOOR_RECTANGLE = ((0.56163, 0.72955), (0.10792, 0.74079), (0.93641, 0.66562), (0.72567, 0.66207))
"""Picks of the foot of the curtain, the white wall's corner, and the ends of the floor on either side of the
bed: at (-1.49, -0.21), (1.38, -0.21), (1.38, 1.84), (-1.49, 1.84) m by the sample's own calibration."""
ROOM = (
    (0.46409, 0.68284), (0.15877, 0.62859), (0.09578, 0.64198), (0.10733, 0.74049), (0.93654, 0.66543),
    (0.72564, 0.66195),
)  # fmt: skip
"""Corners of the floor, 4.24 m by 3.24 m; the niche of the bed's head is left out."""
CEILING = (0.00111, 0.27218)
"""A pick of the edge between wall and ceiling."""
BALL = (0.2, 0.8)
"""Where the ball stands: on the floor before the desk, at (0.71, -0.64) m."""
LENS_MM = 24
BELOW_NAMES = 36
"""From the top of a File Browser's list to the middle of its first file, under the columns' names [px]."""


def package(name):
    """A module of the installed add-on."""
    return importlib.import_module(f"{hotel.addon().__name__}.{name}")


def state():
    """What the scene has, in numbers that undo must bring back."""
    scene = bpy.context.scene
    found, place = scene.panorama_set, scene.panorama_place
    return {
        "image": bool(found.image_path),
        "picks": len(found.picks),
        "solved": found.result.is_solved,
        "tilt_deg": round(found.result.tilt_deg, 4),
        "camera_height": round(found.camera_height, 4),
        "sizes": {shape.name: [round(s, 4) for s in shape.size] for shape in found.shapes if shape.is_built},
        "objects": sorted(thing.name for thing in scene.objects),
        "is_prepared": place.irradiance is not None,
        "ball": [round(x, 3) for thing in scene.objects if "Ball" in thing.name for x in thing.location],
        "has_camera": scene.camera is not None,
        "layers": len(scene.view_layers),
    }


def view():
    """The 3D view."""
    return look.area("VIEW_3D")


def click_at(stage, uv, **how):
    """Turn the view to a pick and click it."""
    place = yield from look.bring_into_view(stage.hand, view(), look.direction_of(uv))
    yield from stage.hand.click(*place, **how)


def drop_panorama(stage):
    """Drag the file from a File Browser into the 3D view, and say in the menu what it is."""
    path, right = hotel.panorama(stage.folder), look.area("PROPERTIES")
    right.type = "FILE_BROWSER"
    yield
    right.spaces.active.show_region_toolbar = False
    parameters = right.spaces.active.params
    parameters.directory, parameters.display_type = str(path.parent).encode(), "LIST_VERTICAL"
    yield from wait(20)
    icon = yield from reach_icon(stage, right)
    yield from stage.hand.drag(icon, look.middle(look.region(view())))
    yield
    yield from stage.picture("five_drop", look.box(view()))
    yield from stage.hand.key("O")  # Open as HDR Panorama
    yield Until(lambda: bpy.context.scene.panorama_set.image_path, "the panorama")


def reach_icon(stage, browser):
    """Come from beside to the icon of a File Browser's first file, by which it is dragged -> window pixel."""
    window = look.region(browser)
    x, y = window.x + 17, window.y + window.height - BELOW_NAMES
    yield from stage.hand.move(x + 5, y - 200)
    yield from stage.hand.move(x, y, steps=10)
    return x, y


def wait(steps):
    """Wait some steps, for what slides in."""
    for _ in range(steps):
        yield


def look_around(stage):
    """Stand where the panorama was captured, by the header's pop-over, with a wide lens."""
    yield from look.click_in_header(stage.hand, view(), "PANORAMA_PT_view")
    yield
    header = look.region(view(), "HEADER")
    below = header.x + header.width - 150, header.y - 150, 250, 140
    found = yield from look.find_button(stage.hand, below, "look_around", columns=(0.5,))
    yield from stage.hand.click(*found)
    yield from stage.hand.key("ESC")  # the pop-over stays open
    yield from stage.hand.move(*look.middle(look.region(view())))
    view().spaces.active.lens = LENS_MM
    yield


def press(stage, *words, **where):
    """Click a button of the sidebar."""
    yield from look.click_button(stage.hand, look.region(view(), "UI"), *words, **where)
    yield


def pick(stage):
    """Click four floor points, type the camera's height, confirm."""
    yield from press(stage, "panorama.pick_points")
    yield from stage.hand.move(*look.middle(look.region(view())))
    yield from stage.hand.key("S")  # no snapping: the points are given to a hundredth of a pixel
    for uv in FLOOR_RECTANGLE[:3]:
        yield from click_at(stage, uv)
    yield from stage.picture("five_picking", look.box(view()))
    yield from click_at(stage, FLOOR_RECTANGLE[3])
    yield from stage.hand.type_text("1.32")
    yield
    yield from stage.picture("five_picked", look.box(view()))
    yield from stage.hand.key("RET")
    yield Until(lambda: bpy.context.scene.panorama_set.result.is_solved, "a calibration")


def draw_room(stage):
    """Draw the floor's corners and raise the walls to the ceiling."""
    yield from press(stage, "draw_shape", "room")
    for uv in ROOM:
        yield from click_at(stage, uv)
    yield from stage.picture("five_floor", look.box(view()))
    yield from stage.hand.key("RET")
    place = yield from look.bring_into_view(stage.hand, view(), look.direction_of(CEILING))
    yield from stage.hand.move(*place)
    yield
    yield from stage.picture("five_walls", look.box(view()))
    yield from click_at(stage, CEILING)
    yield Until(lambda: len(state()["sizes"]) == 2, "floor and walls")


def add_ball(stage):
    """Add a ball: it stands on the floor below the 3D cursor."""
    yield from press(stage, "add_ball", "MATTE", columns=(0.75,))


def send_ball(stage):
    """Look at a spot of the photograph's floor, and send it there."""
    yield from look.bring_into_view(stage.hand, view(), look.direction_of(BALL))
    yield from press(stage, "panorama.send_to_place")
    yield from click_at(stage, BALL)
    yield
    yield from stage.picture("five_ball", look.box(view()))


def is_idle():
    """Whether no long work runs."""
    return not package("operators.long_work").running()


def prepare(stage):
    """Prepare the light, looking at the progress."""
    yield from press(stage, "panorama.prepare")
    began = time.monotonic()
    yield Until(lambda: is_idle() or time.monotonic() > began + 6, "progress to be shown")
    yield from stage.picture("five_preparing", (0, 0, look.area("VIEW_3D").width, 330))
    yield Until(is_idle, "the light", 400)
    yield


def add_camera(stage):
    """Add a camera that looks at the ball."""
    yield from press(stage, "panorama.add_camera")


def render(stage):
    """Render a small picture, and come back from where Blender shows it."""
    scene = bpy.context.scene
    scene.panorama_set.job.samples, scene.panorama_set.job.denoise = 16, True
    yield from press(stage, "panorama.render_frame")
    yield from wait(5)
    yield Until(lambda: is_idle() and not bpy.app.is_job_running("RENDER"), "the picture", 400)
    yield from wait(5)
    shown = look.region(look.area("IMAGE_EDITOR"))
    x, y = look.middle(shown)
    yield from stage.picture("five_rendered", (x - 256, y - 176, 512, 352))
    yield from stage.hand.move(x, y)
    yield from stage.hand.key("ESC")
    yield from wait(5)


STEPS = (drop_panorama, pick, draw_room, add_ball, send_ball, prepare, add_camera, render)


def five_minutes(stage):
    """All of it, then back to the start and forth again."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 480, 320
    yield from stage.hand.move(*look.middle(look.region(view())))
    yield from stage.hand.key("A")
    yield from stage.hand.key("DEL")
    stages = [state()]
    for step in STEPS:
        yield from step(stage)
        stages.append(state())
        stage.note(stages=stages)
        if step is drop_panorama:
            look.area("FILE_BROWSER").type = "PROPERTIES"
            yield from look_around(stage)
            yield from look.open_sidebar(stage.hand, view())
            yield from stage.picture("five_look", look.box(view()))
    yield from stage.hand.move(*look.middle(look.region(view())))
    stage.note(back=(yield from repeat(stage, len(STEPS))))
    stage.note(again=(yield from repeat(stage, len(STEPS), shift=True)))


def repeat(stage, times, **how):
    """Press Ctrl Z so many times -> the states after each."""
    states = []
    for _ in range(times):
        yield from stage.hand.key("Z", ctrl=True, **how)
        states.append(state())
    return states


def sample(stage):
    """Load the sample room by its button, and calibrate and build it."""
    yield from look.open_sidebar(stage.hand, view())
    yield from press(stage, "panorama.load_sample")
    yield from press(stage, "panorama.calibrate")
    yield from press(stage, "panorama.build")
    stage.note(**state())


JOBS = (sample, five_minutes)
