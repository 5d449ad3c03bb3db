"""What of an editor's region is free for the panorama, and what is left to Blender's own buttons."""

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("bpy")


def a_region(kind, alignment, x, y, width, height):
    return SimpleNamespace(type=kind, alignment=alignment, x=x, y=y, width=width, height=height)


def an_area(show=True):
    window = a_region("WINDOW", "NONE", 100, 50, 1000, 600)
    regions = [
        window,
        a_region("HEADER", "TOP", 100, 620, 1000, 30),
        a_region("TOOLS", "LEFT", 100, 50, 60, 570),
        a_region("UI", "RIGHT", 900, 50, 200, 570),
        a_region("ASSET_SHELF", "BOTTOM", 100, 50, 1000, 1),  # hidden
    ]
    space = SimpleNamespace(show_gizmo=True, show_gizmo_navigate=show)
    area = SimpleNamespace(type="VIEW_3D", regions=regions, spaces=SimpleNamespace(active=space))
    return area, window


def test_what_panels_leave_free():
    from expanded_panoramas.operators.canvas import free_area

    assert free_area(*an_area()) == ([60, 0], [800, 570])


@pytest.mark.parametrize(
    ("xy", "show", "expected"),
    [
        ((750, 500), True, True),
        ((750, 500), False, False),
        ((690, 500), True, False),
        ((750, 300), True, False),
    ],
)
def test_clicks_on_the_navigation_buttons_are_theirs(xy, show, expected):
    from expanded_panoramas.operators.canvas import on_navigation

    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))
    assert on_navigation(SimpleNamespace(preferences=preferences), *an_area(show), xy) is expected


def test_there_is_no_picture_to_pick_in_a_view_along_the_floor():
    from expanded_panoramas.ibl_toolkit.views import View
    from expanded_panoramas.operators.canvas import ViewCanvas

    front = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    above = np.eye(4)
    for view, shows in ((front, False), (above, True)):
        canvas = ViewCanvas(View.from_matrices(np.eye(4), view, np.eye(3), 1.5, (100, 100)))
        assert (canvas.uv_at((30, 40)) is not None) == shows
