"""A hand that draws: clicks, keys and moves of a mouse over a flat image or a view of the known room."""

from types import SimpleNamespace

import numpy as np
from known_room import CAMERA_HEIGHT, WORLD_FROM_PANORAMA

from expanded_panoramas.ibl_toolkit.calibration.calibration import Calibration
from expanded_panoramas.ibl_toolkit.drawn_shape import DrawnShape
from expanded_panoramas.ibl_toolkit.stand import Stand
from expanded_panoramas.ibl_toolkit.views import View
from expanded_panoramas.operators.canvas import ImageCanvas, ViewCanvas
from expanded_panoramas.operators.tools.draw_tool import DrawTool
from expanded_panoramas.operators.tools.lengths import Lengths

STAND = Stand(WORLD_FROM_PANORAMA, CAMERA_HEIGHT)
CALIBRATION = Calibration(WORLD_FROM_PANORAMA, CAMERA_HEIGHT, 0, 0, 0, 0, 1, ())
METRES = Lengths("METRIC", "", 1.0)
FLAT = ImageCanvas(np.array([20.0, 40.0]), np.array([4096.0, 2048.0]))


def look_from(eye, target, size=(800, 600)):
    """A ViewCanvas at (3,) that looks at (3,) [m], 90° wide."""
    back = np.subtract(eye, target) / np.linalg.norm(np.subtract(eye, target))
    right = np.cross((0, 0, 1), back)
    right /= np.linalg.norm(right)
    view_from_world = np.eye(4)
    view_from_world[:3, :3] = [right, np.cross(back, right), back]
    view_from_world[:3, 3] = -view_from_world[:3, :3] @ eye
    window = np.array([[1, 0, 0, 0], [0, size[0] / size[1], 0, 0], [0, 0, -1, -0.1], [0, 0, -1, 0]], float)
    return _canvas(window, view_from_world, size)


def elevation(size=(800, 600)):
    """The orthographic ViewCanvas of Blender's front view, 8 m wide, whose plane is y = 0."""
    view_from_world = np.eye(4)[[0, 2, 1, 3]] * [[1], [1], [-1], [1]]
    return _canvas(np.diag([0.25, 0.25 * size[0] / size[1], 0.01, 1]), view_from_world, size)


def _canvas(window, view_from_world, size):
    stand = STAND.world_from_panorama, STAND.camera_height
    return ViewCanvas(View.from_matrices(window, view_from_world, *stand, size))


class Hand:
    """Draws one kind of shape; `answer` is what the tool made of the last event."""

    def __init__(self, kind, on=FLAT, over=(None, None), lengths=METRES, stand=STAND):
        self.tool, self.on = DrawTool(DrawnShape(kind, stand, over), lengths), on
        self.xy, self.answer = None, None

    def event(self, kind, value="PRESS", **modifiers):
        known = {"shift": False, "ctrl": False, "unicode": "", **modifiers}
        on = None if self.xy is None else self.on
        self.answer = self.tool.handle(on, self.xy, SimpleNamespace(type=kind, value=value, **known))
        return self.answer

    def pixels(self, point):
        return self.on.curve_of(self.tool.shape.stand.from_origin(np.array([point], float)))[0]

    def move(self, point, **modifiers):
        """Move the mouse over a point (3,) of the world [m], or (2,) on its floor."""
        self.xy = self.pixels((*point, 0)[:3])
        return self.event("MOUSEMOVE", "NOTHING", **modifiers)

    def click(self, *points, **modifiers):
        for point in points:
            self.move(point, **modifiers)
            self.event("LEFTMOUSE", "PRESS", **modifiers)
            self.event("LEFTMOUSE", "RELEASE", **modifiers)
        return self.answer

    def drag(self, start, end):
        self.move(start)
        self.event("LEFTMOUSE", "PRESS")
        self.move(end)
        return self.event("LEFTMOUSE", "RELEASE")

    def type(self, string, **modifiers):
        for character in string:
            self.event("ANY", unicode=character, **modifiers)

    def enter(self):
        return self.event("RET")
