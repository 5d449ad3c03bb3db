"""Where things are in the window: areas, regions, buttons, directions of the panorama. Runs in Blender."""

import bpy
import numpy as np
from mathutils import Vector
from waiting import AT_ONCE

ROW = 10
"""Distance of the rows in which buttons are looked for [px at a UI scale of 1]; a button is 20 high."""
_seen = {}
"""What was copied where, last."""


def area(kind, window=0):
    """The window's largest area of that type."""
    areas = [a for a in bpy.context.window_manager.windows[window].screen.areas if a.type == kind]
    return max(areas, key=lambda a: a.width * a.height)


def region(of, kind="WINDOW"):
    """The first region of that type in an area."""
    return next(r for r in of.regions if r.type == kind)


def middle(of):
    """The centre of an area or region."""
    return of.x + of.width // 2, of.y + of.height // 2


def box(of):
    """Left, bottom, width and height of an area or region."""
    return of.x, of.y, of.width, of.height


def override(of, window=0):
    """What a call needs that an artist gives by where the mouse is."""
    inside = {"window": bpy.context.window_manager.windows[window], "area": of, "region": region(of)}
    return bpy.context.temp_override(**inside)


def find_button(hand, of, *words, columns=(0.3, 0.75)):
    """Look for the button of a region from which Ctrl C copies a text with all these words -> (x, y) or None.

    Over an operator's button Blender copies its call in Python, over a property its value. Disabled buttons
    are found as well. What was found before is tried first.
    """
    for place in [place for place, text in _seen.items() if all(word in text for word in words)]:
        text = yield from text_at(hand, *place)
        if all(word in text for word in words):
            return place
    step = round(ROW * bpy.context.preferences.system.ui_scale)
    for share in columns:
        for y in range(of.y + of.height - 4, of.y + 4, -step):
            place = of.x + of.width * share, y
            text = yield from text_at(hand, *place)
            if text and all(word in text for word in words):
                return place
    return None


def find_in_header(hand, of, *words):
    """The same for a header: one row."""
    for x in range(of.x + 8, of.x + of.width - 8, 12):
        text = yield from text_at(hand, x, of.y + of.height // 2)
        if text and all(word in text for word in words):
            return hand.x, hand.y
    return None


def text_at(hand, x, y):
    """What Ctrl C copies with the mouse there; "" where it copies nothing."""
    manager = bpy.context.window_manager
    manager.clipboard = ""
    hand.hover(x, y)
    hand.tap("C", ctrl=True)
    yield AT_ONCE
    _seen[x, y] = manager.clipboard
    return manager.clipboard


def click_button(hand, of, *words):
    """Click the button with these words in a region, scrolling it where it must. Raises LookupError."""
    for _ in range(3):
        found = yield from find_button(hand, of, *words)
        if found:
            yield from hand.click(*found)
            return
        yield from hand.move(*middle(of))
        yield from hand.wheel("WHEELDOWNMOUSE", 8)
    raise LookupError(f"no button {words} in the region {of.type}")


def open_sidebar(hand, of, category="Panorama"):
    """Press N over an area where its sidebar is hidden, and turn to a tab."""
    if not of.spaces.active.show_region_ui:
        yield from hand.move(*middle(of))
        yield from hand.key("N")
    sidebar = region(of, "UI")
    for _ in range(20):  # it slides in
        yield
    sidebar.active_panel_category = category
    of.tag_redraw()
    yield
    return sidebar


def direction_of(uv):
    """Direction (3,) of a pick (u, v) in the panorama's frame."""
    phi, theta = (0.5 - uv[0]) * 2 * np.pi, (0.5 - uv[1]) * np.pi
    return np.array([np.cos(theta) * np.cos(phi), np.cos(theta) * np.sin(phi), np.sin(theta)])


def world_from_panorama():
    """The scene's orientation of the panorama, as its origin has it; the identity before there is one."""
    origin = bpy.context.scene.panorama_place.origin
    return np.eye(3) if origin is None else np.array(origin.matrix_world)[:3, :3]


def pixel_of(of, direction):
    """Window pixel where a 3D view shows a direction of the panorama, or None behind it or outside."""
    window = region(of)
    world = Vector((*(world_from_panorama() @ np.asarray(direction)), 0))
    x, y, _, w = of.spaces.active.region_3d.perspective_matrix @ world
    if w <= 0 or abs(x) > w or abs(y) > w:
        return None
    return window.x + (x / w + 1) / 2 * window.width, window.y + (y / w + 1) / 2 * window.height
