"""The operator that writes a scene's shadows for a phone: a page for its browser, or glTF."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from ..cycles_integration.place import place_in
from ..cycles_integration.shadow_page import page_scene
from ..cycles_integration.shadow_preview import KINDS, settings_of
from ..ibl_toolkit.images.atomic import refuse_unwritable
from ..ibl_toolkit.mobile.page_files import write_page_file
from ..ibl_toolkit.mobile.shadow_maps import METHODS, settings_with
from ..ibl_toolkit.mobile.shadow_scene import MOST_LIGHTS
from .reporting import Reporting, possible
from .shadow_lights import NO_LIGHT

FORMATS = (
    (
        ".html",
        "Web Page (.html)",
        "One file for any browser with WebGL 2, a phone's too; it loads nothing else",
    ),
    (".glb", "glTF (.glb)", "The meshes, with lights and kinds of shadow map in the scene's extras"),
)
SOURCES = (
    ("auto", "Automatic", "The scene's own lights, or without any those of its panorama"),
    ("scene", "Scene", "The lights that renders show"),
    ("panorama", "Panorama", "Suns and lamps that are found in the panorama"),
    ("both", "Both", "Those of the panorama, and the scene's own but for suns that were picked from it"),
)
_NARROWEST = 3  # window of a filter


class PANORAMA_OT_export_shadow_page(Reporting, ExportHelper, bpy.types.Operator):
    """Write a page that draws the scene's shadows as a phone does, over its panorama or its camera's image,
    with the kind of shadow map chosen here. New things have one colour each; all visible lights shine"""

    bl_idname = "panorama.export_shadow_page"
    bl_label = "Export Shadow Page"
    bl_options = set()

    file_format: EnumProperty(name="Format", description="Kind of file that is written", items=FORMATS)
    light_from: EnumProperty(name="Lights", description="Where the lights come from", items=SOURCES)
    most: IntProperty(
        name="Most Lights",
        description="Lights that throw shadows, the strongest; each costs the phone a map and a look-up in "
        "every pixel. Others only brighten [number of lights]",
        default=MOST_LIGHTS,
        min=1,
        max=MOST_LIGHTS,
    )
    compare: BoolProperty(
        name="All Methods",
        description="Give the page a menu that has the other methods too, in the same resolution and storage",
        default=False,
    )
    filter_glob: StringProperty(default="*.html;*.glb", options={"HIDDEN"})

    @property
    def filename_ext(self) -> str:
        """What the file browser ends names with."""
        return self.file_format

    @classmethod
    def poll(cls, context):
        """There is something to see, from somewhere, in some light."""
        return possible(cls, page_missing(context.scene))

    def work(self, context):
        """Take the scene as it is, and write it."""
        path = bpy.path.ensure_ext(bpy.path.abspath(self.filepath), self.file_format)
        refuse_unwritable(path)
        kinds = kinds_of(context.scene.panorama_shadow_preview, self.compare)
        depsgraph = context.evaluated_depsgraph_get()
        found = page_scene(context.scene, depsgraph, kinds, self.light_from, self.most)
        write_page_file(path, found.scene, kinds, found.background, found.camera, Path(path).stem)
        for warning in found.warnings:
            self.report({"WARNING"}, warning[0].upper() + warning[1:])
        lights = ", ".join(f"'{name}'" for name in found.light_names)
        return f"Wrote {path}: {Path(path).stat().st_size / 1e6:.3g} MB, lit by {lights}"


def kinds_of(preview, compare: bool) -> list:
    """The kind of shadow map of a scene's preview, and to ``compare`` those of all other methods."""
    own = settings_of(preview)
    others = [method for method in METHODS if compare and method != own.method]
    window = max(own.window, _NARROWEST)
    return [own, *(settings_with(window, own.resolution, own.storage, method) for method in others)]


def page_missing(scene) -> str:
    """What Export Shadow Page needs."""
    place = place_in(scene)
    if not any(thing.type in KINDS or thing.instance_type != "NONE" for thing in scene.objects):
        return "Add an object of the role Synthetic: it throws the shadow"
    if scene.camera is None and place is None:
        return "Add a camera: the page looks from there"
    if place is None and not any(
        thing.type == "LIGHT" or thing.instance_type == "COLLECTION" for thing in scene.objects
    ):
        return NO_LIGHT
    return ""


classes = (PANORAMA_OT_export_shadow_page,)
