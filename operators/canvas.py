"""Where Blender's editors show the panorama: mouse positions to image points and back.

A 3D View shows it as its background, an Image Editor as the flat image. Both are a canvas: what is picked or
drawn on one is drawn on all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..ibl_toolkit.equirectangular import direction_from_uv, uv_from_direction
from ..ibl_toolkit.views import View

UNCALIBRATED = np.eye(3), 1.5
"""How the panorama is shown before it is calibrated: upright, from so high above the floor [m]."""
FAR = 1e4
"""How far before its own plane an orthographic view's rays start [m]: it shows what is behind that, too."""
EDITORS = ("VIEW_3D", "IMAGE_EDITOR")
OUTSIDE = 50
"""How far outside of an image its scale is measured [sizes of the image]."""
NAVIGATION_SIZE = {"VIEW_3D": (95, 245), "IMAGE_EDITOR": (55, 85)}
"""Of the corner with the buttons that move the view [px at a UI scale of 1]."""


@dataclass(frozen=True, eq=False)
class ViewCanvas:
    """A 3D View's region."""

    view: View

    def uv_at(self, xy):
        """The image point (2,) shown at (2,) [region px]; None where none is."""
        if self.view.runs_along_floor:
            return None
        direction = self.view.directions_at(np.asarray(xy, np.float64) + 0.5)
        return uv_from_direction(direction) if direction.any() else None

    def pixels_of(self, uv):
        """Where image points (..., 2) are shown (..., 2) [region px]; NaN where they are not."""
        return self.view.pixels_of(direction_from_uv(uv)) - 0.5

    def ray_at(self, xy):
        """The ray that is seen at (2,) [region px]: its start [m] and direction, (3,) of the panorama frame.

        In a view from beside the panorama it starts there, so it isn't the ray of the picture shown.
        """
        start, direction = self.view.rays_at(np.asarray(xy, np.float64) + 0.5)
        if self.view.is_perspective:
            return start, direction
        return start - FAR * direction / np.linalg.norm(direction), direction

    @property
    def has_floor_in_place(self):
        """Whether the picture shows the floor where rays meet it."""
        return self.view.has_floor_in_place

    def curve_of(self, points):
        """A curve's pixels (n, 2) through points (n, 3) of the panorama frame [m]; NaN breaks it."""
        return self.view.pixels_of_points(points) - 0.5


@dataclass(frozen=True, eq=False)
class ImageCanvas:
    """An Image Editor's region that shows the panorama: corner and size (2,) of the image [region px]."""

    corner: np.ndarray
    size: np.ndarray
    has_floor_in_place = True

    def uv_at(self, xy):
        """The image point (2,) shown at (2,) [region px]; None outside of the image."""
        u, v = (np.asarray(xy, np.float64) + 0.5 - self.corner) / self.size
        return np.array([u, 1 - v]) if 0 <= u <= 1 and 0 <= v <= 1 else None

    def pixels_of(self, uv):
        """Where image points (..., 2) are shown (..., 2) [region px]."""
        u, v = np.moveaxis(np.asarray(uv, np.float64), -1, 0)
        return np.stack([u, 1 - v], axis=-1) * self.size + self.corner - 0.5

    def ray_at(self, xy):
        """The ray (start [m], direction), (3,) of the panorama frame, at (2,) [region px]; None outside."""
        uv = self.uv_at(xy)
        return None if uv is None else (np.zeros(3), direction_from_uv(uv))

    def curve_of(self, points):
        """A curve's pixels (m, 2) through points (n, 3) of the panorama frame [m]; NaN at the seam."""
        uv = uv_from_direction(points)
        cuts = np.flatnonzero(np.abs(np.diff(uv[:, 0])) > 0.5) + 1
        return np.insert(self.pixels_of(uv), cuts, np.nan, axis=0)


def canvas_of(context, area, region) -> ViewCanvas | ImageCanvas | None:
    """The canvas of an editor's main region; None where it shows no panorama."""
    state = context.scene.panorama_set
    if region.type != "WINDOW" or state.image is None:
        return None
    if area.type == "VIEW_3D":
        matrices = region.data.window_matrix, region.data.view_matrix
        return ViewCanvas(
            View.from_matrices(*matrices, *calibration_of(context.scene), (region.width, region.height))
        )
    if area.type == "IMAGE_EDITOR" and area.spaces.active.image == state.image:
        return _image_canvas(region.view2d)
    return None


def _image_canvas(view2d):
    """Blender tells whole pixels only, so they are asked for far outside of the image."""
    low, high = (np.array(view2d.view_to_region(u, u, clip=False), float) for u in (-OUTSIDE, 1 + OUTSIDE))
    size = (high - low) / (1 + 2 * OUTSIDE)
    return ImageCanvas(low + OUTSIDE * size, size)


def canvas_under(context, event):
    """The (canvas, area, region, xy) under the mouse, in any editor of the window; None where none is.

    xy (2,) [region px].
    """
    for area in context.window.screen.areas:
        if area.type not in EDITORS:
            continue
        covered = [r for r in area.regions if r.type != "WINDOW" and _contains(r, event)]
        for region in area.regions:
            if region.type == "WINDOW" and _contains(region, event) and not covered:
                canvas = canvas_of(context, area, region)
                xy = np.array([event.mouse_x - region.x, event.mouse_y - region.y], float)
                if on_navigation(context, area, region, xy):
                    return None
                return canvas and (canvas, area, region, xy)
    return None


def on_navigation(context, area, region, xy) -> bool:
    """Whether Blender's own buttons to turn, zoom and pan the view are at (2,) [px]: they go on working."""
    space = area.spaces.active
    if not (space.show_gizmo and space.show_gizmo_navigate):
        return False
    size = np.array(NAVIGATION_SIZE[area.type]) * (context.preferences.system.ui_scale or 1)
    return bool((np.subtract(free_area(area, region)[1], xy) < size).all())


def free_area(area, region):
    """Lower left and upper right corner ((2,), (2,)) [px] of what no toolbar, sidebar or header covers."""
    low, high = [0, 0], [region.width, region.height]
    for other in area.regions:
        if other.type == "WINDOW" or min(other.width, other.height) <= 1:
            continue
        if other.alignment == "LEFT":
            low[0] = max(low[0], other.x + other.width - region.x)
        elif other.alignment == "RIGHT":
            high[0] = min(high[0], other.x - region.x)
        elif other.alignment == "BOTTOM":
            low[1] = max(low[1], other.y + other.height - region.y)
        elif other.alignment == "TOP":
            high[1] = min(high[1], other.y - region.y)
    return low, high


def redraw(context):
    """Have all editors that may show the panorama drawn again."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in EDITORS:
                area.tag_redraw()


def calibration_of(scene):
    """The rotation world_from_panorama (3, 3) and camera height [m] with which the panorama is shown."""
    place = scene.panorama_place
    if place.origin is None or not scene.panorama_set.result.is_solved:
        return UNCALIBRATED
    matrix = np.array(place.origin.matrix_world, np.float64)
    rotation = np.linalg.qr(matrix[:3, :3])[0]  # the artist may have scaled the Empty, or turned it further
    rotation = rotation * np.sign((rotation * matrix[:3, :3]).sum(axis=0))
    return rotation, float(matrix[2, 3])


def _contains(region, event):
    return 0 <= event.mouse_x - region.x < region.width and 0 <= event.mouse_y - region.y < region.height
