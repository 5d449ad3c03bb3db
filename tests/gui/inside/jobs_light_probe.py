"""Jobs of light from a photograph: the button, the file browser with its settings, undo. Runs in Blender."""

import pathlib
import shutil

import bpy
import look
from jobs_sidebar import browser, choose_file
from waiting import Until

PHOTO = pathlib.Path(__file__).parents[3] / "docs" / "images" / "probe_photo.jpg"
SETTINGS = {
    "focal": 50, "has_marker": True, "ball_from": "MARKER", "ball_place": (0.12, 0.02),
}  # fmt: skip
VIEW_SIZE = 7
SETTINGS_HEIGHT = 340
"""What the settings beside the file browser take [px at a UI scale of 1]."""


def suns():
    """Direction [world] and strength of each sun, the strongest first."""
    bpy.context.view_layer.update()
    found = sorted((o for o in bpy.data.objects if o.name.startswith("Probe Light")), key=lambda o: o.name)
    return [[*o.matrix_world.col[2][:3], o.data.energy] for o in found]


def lights_by_button(stage):
    """Open the closed panel in step 4, choose the photo, look at what came; undo."""
    view = look.area("VIEW_3D")
    view.spaces.active.region_3d.view_distance = VIEW_SIZE
    bpy.data.objects["Cube"].scale = (0.3, 0.3, 0.3)
    bpy.data.objects["Cube"].location.z = 0.3
    bpy.ops.ed.undo_push(message="before")
    sidebar = yield from look.open_sidebar(stage.hand, view)
    yield from open_panel(stage, sidebar)
    yield from look.click_button(stage.hand, sidebar, "panorama.lights_of_probe")
    yield from set_up({**SETTINGS, "strength": 3})
    left, bottom, width, height = look.box(look.region(browser(), "TOOL_PROPS"))
    rows = int(SETTINGS_HEIGHT * bpy.context.preferences.system.ui_scale)
    yield from stage.picture("photo_settings", (left, bottom + height - rows, width, rows))
    yield from choose_file(stage, PHOTO)
    yield Until(suns, "suns of the photo")
    stage.note(suns=suns())
    region = look.region(look.area("VIEW_3D"))
    yield from stage.hand.move(*look.middle(region))
    yield from stage.hand.key("ESC")  # the box with the warning
    yield from stage.hand.move(region.x + 200, region.y + 100)
    yield from stage.picture("photo_lights", look.box(look.area("VIEW_3D")))
    yield from stage.hand.key("Z", ctrl=True)
    yield Until(lambda: not suns(), "undo", 10)
    stage.note(after_undo=[thing.name for thing in bpy.context.scene.objects])


def panorama_by_button(stage):
    """Unwrap the ball; look round where it stood."""
    photo = shutil.copy(PHOTO, stage.folder)
    view = look.area("VIEW_3D")
    sidebar = yield from look.open_sidebar(stage.hand, view)
    yield from open_panel(stage, sidebar)
    yield from look.click_button(stage.hand, sidebar, "panorama.panorama_of_ball")
    yield from set_up(SETTINGS)
    yield from choose_file(stage, pathlib.Path(photo))
    found = bpy.context.scene.panorama_set
    yield Until(lambda: found.image_path, "the panorama")
    for _ in range(6):
        yield
    yield from stage.picture("photo_panorama", look.box(look.area("VIEW_3D")))
    stage.note(name=pathlib.Path(found.image_path).name, camera_height=found.result.camera_height)


def set_up(settings):
    """Give settings to the file browser that opens, and let it list the photo's folder."""
    yield Until(lambda: browser() is not None, "a file browser")
    asked = browser().spaces.active.active_operator.properties
    for name, value in settings.items():
        setattr(asked, name, value)
    browser().spaces.active.params.directory = str(PHOTO.parent).encode()
    for _ in range(6):
        yield


def open_panel(stage, sidebar):
    """Click the header below the last button of step 4."""
    yield from look.click_button(stage.hand, sidebar, "panorama.write_uv")
    x, y = stage.hand.x, stage.hand.y
    yield from stage.hand.click(x, y - 30)
    for _ in range(20):  # it unrolls
        yield


JOBS = (lights_by_button, panorama_by_button)
