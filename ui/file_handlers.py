"""What may be dropped from a File Browser or the desktop on a 3D View or an Image Editor.

Where several handlers take a file, Blender asks by a small menu which one is meant, so an HDR image may
become the panorama or, by Blender's own handlers, an Empty or a plain image. No handler can decide that: each
is told where something is dropped, but not what.
"""

import bpy

EDITORS = ("VIEW_3D", "IMAGE_EDITOR")


class _OnPanorama:
    """A file dropped where the panorama is shown."""

    @classmethod
    def poll_drop(cls, context):
        """Over the main part of an editor that shows the panorama."""
        area, region = context.area, context.region
        return area is not None and area.type in EDITORS and region is not None and region.type == "WINDOW"


class PANORAMA_FH_image(_OnPanorama, bpy.types.FileHandler):
    """An HDR panorama, with or without depth."""

    bl_idname = "PANORAMA_FH_image"
    bl_label = "HDR panorama"
    bl_import_operator = "panorama.drop_image"
    bl_file_extensions = ".exr;.hdr"


class PANORAMA_FH_set(_OnPanorama, bpy.types.FileHandler):
    """A panorama set."""

    bl_idname = "PANORAMA_FH_set"
    bl_label = "Panorama set"
    bl_import_operator = "panorama.import_set"
    bl_file_extensions = ".json"


classes = (PANORAMA_FH_image, PANORAMA_FH_set)
