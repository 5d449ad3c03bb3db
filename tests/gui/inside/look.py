"""Where things are in the window: areas, regions, buttons, directions of the panorama. Runs in Blender."""

import bpy
import numpy as np
from mathutils import Vector
from waiting import AT_ONCE, Until

ROW = 12
"""Distance of the rows in which buttons are looked for [px at a UI scale of 1]; a button takes 15."""
PAGE = 10
"""Clicks of the wheel that scroll a sidebar by most of its height."""
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


def find_button(hand, box, *words, columns=(0.3, 0.75)):
    """Look for the button in a box from whose text (see `text_at`) all these words come -> (x, y) or None.

    Disabled buttons are found as well. What was found before is tried first.
    """
    left, bottom, width, height = box
    for place in [place for place, text in _seen.items() if all(word in text for word in words)]:
        if not (left <= place[0] <= left + width and bottom <= place[1] <= bottom + height):
            continue
        text = yield from text_at(hand, *place)
        if all(word in text for word in words):
            return place
    step = round(ROW * bpy.context.preferences.system.ui_scale)
    for share in columns:
        for y in range(bottom + height - 4, bottom + 4, -step):
            text = yield from text_at(hand, left + width * share, y)
            if text and all(word in text for word in words):
                return hand.x, hand.y
    return None


def click_in_header(hand, of, *words):
    """Click the button with these words in an area's header, from the right. Raises LookupError."""
    header = region(of, "HEADER")
    for x in range(header.x + header.width - 8, header.x, -12):
        text = yield from text_at(hand, x, header.y + header.height // 2)
        if text and all(word in text for word in words):
            yield from hand.click(hand.x, hand.y)
            return
    raise LookupError(f"no button {words} in the header")


def text_at(hand, x, y):
    """What says which button is there, "" where none is.

    Over a button Ctrl C copies its operator's call in Python, or else its value; Ctrl Shift C the path of
    its property.
    """
    manager = bpy.context.window_manager
    manager.clipboard = ""
    hand.hover(x, y)
    hand.tap("C", ctrl=True)
    hand.tap("C", ctrl=True, shift=True)
    yield AT_ONCE
    _seen[hand.x, hand.y] = manager.clipboard
    return manager.clipboard


def click_button(hand, of, *words, columns=(0.3, 0.75)):
    """Click the button with these words in a region, scrolling it where it must. Raises LookupError."""
    for share in columns:
        for clicks in (0, *(() if _is_at_top(of) else (-40,)), PAGE, PAGE):
            if clicks:
                yield from hand.move(*middle(of))
                yield from hand.wheel("WHEELDOWNMOUSE" if clicks > 0 else "WHEELUPMOUSE", abs(clicks))
                yield
            found = yield from find_button(hand, box(of), *words, columns=(share,))
            if found:
                yield from hand.click(*found)
                return
    raise LookupError(f"no button {words} in the region {of.type}")


def _is_at_top(of):
    return of.view2d.region_to_view(0, of.height)[1] > -1


def open_sidebar(hand, of, category="Panorama"):
    """Press N over an area where its sidebar is hidden, and turn to a tab."""
    if not of.spaces.active.show_region_ui:
        yield from hand.move(*middle(of))
        yield from hand.key("N")
    sidebar = region(of, "UI")
    yield Until(lambda: sidebar.width > 1 and sidebar.active_panel_category != "UNSUPPORTED", "the sidebar")
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
    # A pixel's place is its centre: half a pixel beside its number.
    return window.x + (x / w + 1) / 2 * window.width - 0.5, window.y + (y / w + 1) / 2 * window.height - 0.5


def bring_into_view(hand, of, direction):
    """Turn a 3D view with the middle mouse button until it shows a direction -> its window pixel."""
    degrees_per_pixel = 0.4  # as Blender's preferences have it
    for _ in range(8):
        yield
        place = pixel_of(of, direction)
        if place is not None and _is_free(of, *place):
            return place
        x, y = middle(region(of))
        dx, dy = (np.clip(angle / degrees_per_pixel, -300, 300) for angle in _away(of, direction))
        yield from hand.swing((x, y), (x - dx, y + dy))
        of.tag_redraw()
    raise LookupError(f"the view does not turn: {_away(of, direction)}° are left")


def _is_free(of, x, y):
    """Whether neither sidebar nor toolbar nor headers cover a window pixel of a 3D view."""
    window, sidebar = region(of), region(of, "UI")
    right = sidebar.x if sidebar.width > 1 else window.x + window.width
    return window.x + 80 < x < right - 40 and window.y + 120 < y < window.y + window.height - 100


def _away(of, direction):
    """Yaw and pitch [degrees] from where a view looks to a direction of the panorama."""
    wanted = world_from_panorama() @ np.asarray(direction)
    looked = np.array(of.spaces.active.region_3d.view_rotation @ Vector((0, 0, -1)))
    yaw = np.degrees([np.arctan2(v[1], v[0]) for v in (wanted, looked)])
    pitch = np.degrees([np.arcsin(np.clip(v[2] / np.linalg.norm(v), -1, 1)) for v in (wanted, looked)])
    return (yaw[0] - yaw[1] + 180) % 360 - 180, pitch[0] - pitch[1]
