"""Jobs of the tools: the flat image, undo within, areas that change, typed lengths. Runs in Blender."""

import bpy
import look
from jobs_flow import FLOOR_RECTANGLE, ROOM, click_at, package, press, state, view
from jobs_interrupted import sample, tool

BOX = (0.35, 0.8), (0.25, 0.8), (0.25, 0.72)
"""Picks of the floor: a corner of a box, and the sides on which its next ones are."""

VERTICALS = ((0.10741, 0.72), (0.10754, 0.30434)), ((0.9866, 0.69387), (0.98647, 0.38175))
"""Picks of both ends of upright edges of the room."""


def fresh(stage):
    """The sample room with its calibration alone."""
    yield from sample(stage)
    bpy.context.scene.panorama_set.shapes.clear()
    bpy.ops.ed.undo_push(message="Calibrated")


def points():
    """The points that are picked so far, of the pick that is being filled."""
    editing = package("operators.tools").active_tool().editing
    return [list(point.uv) for point in editing.copied.picks[editing.target].points if point.picked]


def flat_pixel(area, uv):
    """Where an Image Editor shows a pick [window px]."""
    region = look.region(area)
    near, far = (region.view2d.view_to_region(u, u, clip=False) for u in (-99, 99))  # whole pixels
    x, y = (a + (b - a) * (u + 99) / 198 for a, b, u in zip(near, far, (uv[0], 1 - uv[1]), strict=True))
    return region.x + x - 0.5, region.y + y - 0.5


def on_the_flat_image(stage):
    """Begin to pick in the 3D View, turn it into an Image Editor, and click the points there."""
    bpy.ops.panorama.load_sample()
    scene = bpy.context.scene
    scene.panorama_set.picks.clear()
    yield from look.open_sidebar(stage.hand, view())
    yield from press(stage, "panorama.pick_points")
    area = view()
    area.type = "IMAGE_EDITOR"
    area.spaces.active.image = scene.panorama_set.image
    yield
    yield from stage.hand.move(*look.middle(look.region(area)))
    yield from stage.hand.key("HOME")
    yield
    yield from stage.hand.move(*look.middle(look.region(area)))
    yield from stage.hand.key("S")
    for uv in FLOOR_RECTANGLE:
        yield from stage.hand.click(*flat_pixel(area, uv))
    yield from stage.picture("flat_image", look.box(area))
    stage.note(clicked=points(), width=abs(flat_pixel(area, (1, 0))[0] - flat_pixel(area, (0, 0))[0]))
    yield from stage.hand.key("RET")
    yield
    stage.note(solved=scene.panorama_set.result.is_solved, still=tool())


def undo_within(stage):
    """Click three points, undo two, redo one: only the tool's own clicks."""
    yield from fresh(stage)
    before = state()
    yield from press(stage, "draw_shape", "room")
    drawing, counts = package("operators.tools").active_tool(), []
    for uv in ROOM[:3]:
        yield from click_at(stage, uv)
    counts.append(len(drawing.shape.points))
    for shift in (False, False, True):
        yield from stage.hand.key("Z", ctrl=True, shift=shift)
        counts.append(len(drawing.shape.points))
    yield from stage.hand.key("ESC")
    yield
    stage.note(counts=counts, before=before, after=state())


def area_fills_the_window(stage):
    """Set a point, let the area fill the window and come back (Ctrl Space), set another."""
    bpy.ops.panorama.load_sample()
    bpy.context.scene.panorama_set.picks.clear()
    yield from look.open_sidebar(stage.hand, view())
    yield from press(stage, "panorama.pick_points")
    yield from click_at(stage, FLOOR_RECTANGLE[1])
    for _ in range(2):
        yield from stage.hand.move(*look.middle(look.region(view())))
        yield from stage.hand.key("SPACE", ctrl=True)
        yield
    yield from click_at(stage, FLOOR_RECTANGLE[2])
    stage.note(ran=tool(), points=len(points()))
    yield from stage.hand.key("ESC")
    yield


def typed_box(stage):
    """Draw a box: one side by two clicks, the other typed, the height typed."""
    yield from fresh(stage)
    yield from look.click_button(
        stage.hand, look.region(view(), "UI"), "PANORAMA_MT_draw_shape", columns=(0.75,)
    )
    yield
    yield from stage.hand.key("B")
    yield
    stage.note(ran=tool())
    first, beside, opposite = BOX
    yield from click_at(stage, first)
    for towards, length in ((beside, "1.5"), (opposite, "80 cm"), (opposite, "0.75")):
        place = yield from look.bring_into_view(stage.hand, view(), look.direction_of(towards))
        yield from stage.hand.move(*place)
        yield from stage.hand.type_text(length)
        yield from stage.hand.key("RET")
        yield
    stage.note(sizes=state()["sizes"], still=tool())


def two_verticals(stage):
    """Choose Verticals from the menu of picks, click both ends of two, confirm."""
    yield from fresh(stage)
    before = len(bpy.context.scene.panorama_set.picks)
    yield from stage.hand.move(*look.middle(look.region(view())))
    with look.override(view()):
        bpy.ops.wm.call_menu(name="PANORAMA_MT_add_pick")
    yield
    yield from stage.hand.key("V")
    yield
    ran = tool()
    for uv in (uv for ends in VERTICALS for uv in ends):
        yield from click_at(stage, uv)
    yield from stage.hand.key("RET")
    yield
    found = bpy.context.scene.panorama_set
    new = [pick.kind for pick in found.picks[before:]]
    stage.note(ran=ran, new=new, tilt_deg=found.result.tilt_deg, still=tool())


JOBS = (two_verticals, on_the_flat_image, undo_within, area_fills_the_window, typed_box)
