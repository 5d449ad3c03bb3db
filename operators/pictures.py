"""Operators that render: a frame through the scene's camera, or the whole panorama."""

import contextlib

import bpy

from ..cycles_integration.place import place_of
from ..cycles_integration.rendering import Picture, panorama_camera, render_picture, set_up_picture
from . import progress, render_job
from .long_work import LongExport
from .reporting import Reporting, possible


class _ThroughCamera(Reporting):
    """An operator on a picture through the scene's camera."""

    @classmethod
    def poll(cls, context):
        """There must be maps and a camera, and no render of what would be set up anew."""
        return possible(cls, render_job.running() or progress.camera_missing(context.scene))


class PANORAMA_OT_set_up_picture(_ThroughCamera, bpy.types.Operator):
    """Set render layers and compositor up, so that F12 gives the finished picture"""

    bl_idname = "panorama.set_up_picture"
    bl_label = "Set Up for F12"

    def work(self, context):
        """Set up without rendering."""
        picture = frame(context.scene)
        with resolution_kept(context.scene):
            set_up_picture(context.scene, context.scene.camera, picture)
        return f"F12 renders {picture.width} × {picture.height} by the method {picture.method}"


class PANORAMA_OT_render_frame(_ThroughCamera, bpy.types.Operator):
    """Render the new objects into the photograph through the scene's camera. Esc cancels and takes the set-up
    of render layers and compositor back"""

    bl_idname = "panorama.render_frame"
    bl_label = "Render Frame"

    filepath: bpy.props.StringProperty(
        name="File", description="Float OpenEXR file to write; none: the Render Result", subtype="FILE_PATH"
    )

    def work(self, context):
        """Set up and render: in the render window where there is one, else here and now."""
        scene = context.scene
        picture = frame(scene)
        if self.filepath:
            with resolution_kept(scene):
                render_picture(scene, scene.camera, picture, bpy.path.abspath(self.filepath))
            return f"Wrote {self.filepath}"
        with resolution_kept(scene):
            set_up_picture(scene, scene.camera, picture)
        if bpy.app.background:
            bpy.ops.render.render()
        else:
            render_job.start(self.bl_idname)
        return f"{picture.width} × {picture.height}, {picture.samples} samples, method {picture.method}"


def render_panorama(scene, tell, path, width):
    """The long part of Render Panorama -> what was written; the scene is set up for its own camera again."""
    tell("rendering")
    own_camera, own_picture = scene.camera, frame(scene)
    width = width or place_of(scene).image.size[0]
    with resolution_kept(scene):
        try:
            with panorama_camera(scene) as camera:
                render_picture(scene, camera, picture_of(scene, width, width // 2), path)
        finally:
            scene.camera = own_camera
        if own_camera is not None:
            set_up_picture(scene, own_camera, own_picture)
    return f"Wrote {path}: {width} × {width // 2}"


class PANORAMA_OT_render_panorama(LongExport, bpy.types.Operator):
    """Render the whole panorama with the new objects to a float OpenEXR file, while you can go on working.
    Esc cancels"""

    bl_idname = "panorama.render_panorama"
    bl_label = "Render Panorama"

    width: bpy.props.IntProperty(
        name="Width",
        description="Width of the panorama [pixels], its height is half of it; 0: as wide as the photograph",
        default=0,
        min=0,
        soft_max=16384,
        step=2,
    )

    long_part = staticmethod(render_panorama)
    missing = staticmethod(progress.maps_missing)

    def inputs(self, context):
        """File and size."""
        return {"path": self.path(), "width": self.width}

    def apply(self, scene, found):
        """The scene stays."""
        return found


def frame(scene) -> Picture:
    """The picture in the scene's own resolution."""
    render = scene.render
    sides = (render.resolution_x, render.resolution_y)
    return picture_of(scene, *(side * render.resolution_percentage // 100 for side in sides))


def picture_of(scene, width, height) -> Picture:
    """The picture of some size by the scene's settings."""
    job = scene.panorama_set.job
    return Picture(width, height, job.samples, job.seed, job.method, job.denoise)


@contextlib.contextmanager
def resolution_kept(scene):
    """Give the scene its resolution back, whose percentage the artist changes between test and final."""
    names = ("resolution_x", "resolution_y", "resolution_percentage")
    kept = [getattr(scene.render, name) for name in names]
    try:
        yield
    finally:
        for name, value in zip(names, kept, strict=True):
            setattr(scene.render, name, value)


classes = (PANORAMA_OT_set_up_picture, PANORAMA_OT_render_frame, PANORAMA_OT_render_panorama)
