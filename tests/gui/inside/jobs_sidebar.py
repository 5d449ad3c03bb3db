"""Jobs of the sidebar: import, calibrate and build by its buttons, undo and redo by keys. Runs in Blender."""

import bpy
import hotel
import look
from waiting import Until


def state():
    """How far the scene is."""
    scene = bpy.context.scene
    found, place = scene.panorama_set, scene.panorama_place
    return {
        "picks": len(found.picks),
        "solved": found.result.is_solved,
        "tilt_deg": found.result.tilt_deg,
        "built": sum(shape.is_built for shape in found.shapes),
        "surfaces": len(place.surfaces.all_objects) if place.surfaces else 0,
        "balls": sum("Ball" in thing.name for thing in scene.objects),
    }


def choose_file(stage, path):
    """Give a path to the file browser that fills the window, and press Enter."""
    yield Until(lambda: browser() is not None, "a file browser")
    area = browser()
    area.spaces.active.params.directory = str(path.parent).encode()
    area.spaces.active.params.filename = path.name
    yield
    yield from stage.hand.move(*look.middle(look.region(area)))
    yield from stage.hand.key("RET")
    yield Until(lambda: browser() is None, "the file browser closed")


def browser():
    """The file browser in the window, or None."""
    areas = bpy.context.window_manager.windows[0].screen.areas
    return next((a for a in areas if a.type == "FILE_BROWSER"), None)


def import_set(stage):
    """Import the hotel room's set by its button."""
    view = look.area("VIEW_3D")
    sidebar = yield from look.open_sidebar(stage.hand, view)
    yield from look.click_button(stage.hand, sidebar, "panorama.import_set")
    yield from choose_file(stage, hotel.picked_set(stage.folder))
    yield Until(lambda: len(bpy.context.scene.panorama_set.picks), "picks of the set")


def by_buttons_and_back(stage):
    """Import, calibrate, build, add a ball; undo it all; redo it all."""
    yield from import_set(stage)
    stages = [state()]
    for words in (("panorama.calibrate",), ("panorama.build",), ("panorama.add_ball", "MATTE")):
        sidebar = look.region(look.area("VIEW_3D"), "UI")
        yield from look.click_button(stage.hand, sidebar, *words)
        yield
        stages.append(state())
    yield from stage.picture("sidebar_built", look.box(look.area("VIEW_3D")))
    view = look.area("VIEW_3D")
    yield from stage.hand.move(*look.middle(look.region(view)))
    back, again = [], []
    for _ in stages:
        yield from stage.hand.key("Z", ctrl=True)
        back.append(state())
    for _ in stages:
        yield from stage.hand.key("Z", ctrl=True, shift=True)
        again.append(state())
    stage.note(stages=stages, back=back, again=again)


JOBS = (by_buttons_and_back,)
