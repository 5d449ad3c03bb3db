"""The sidebar's steps from a rebuilt place to a picture, each saying what is missing."""

import bpy

from ..operators import progress
from ..operators.pictures import frame
from .render_presets import PANORAMA_PT_render_presets
from .steps import Step
from .texts import figure, paragraph


class PANORAMA_PT_objects(Step, bpy.types.Panel):
    """Step 4."""

    bl_label = "4  Objects and Roles"

    def is_done(self, scene):
        """Something new stands in the place."""
        return bool(progress.new_objects(scene)) and not progress.surfaces_missing(scene)

    def draw(self, context):
        """New objects, and the roles of the selected ones."""
        scene, layout = context.scene, self.layout
        self.say(context, progress.surfaces_missing(scene))
        figure(layout, "New objects", str(len(progress.new_objects(scene))))
        for name, count in progress.surface_counts(scene):
            figure(layout, f"{name} surfaces", str(count))
        if progress.own_lights(scene):
            figure(layout, "Lights of your own", str(len(progress.own_lights(scene))))
        around = progress.around_origin(scene)
        if around:
            self.say(context, f"{around} surrounds the point of capture: move or delete it", "ERROR")
        row = layout.row(align=True)
        row.operator("panorama.add_ball", text="Mirror Ball", icon="SHADING_RENDERED").kind = "MIRROR"
        row.operator("panorama.add_ball", text="Matte Ball", icon="SHADING_SOLID").kind = "MATTE"
        layout.operator("panorama.append_objects", text="Append Objects...", icon="APPEND_BLEND")
        layout.operator("panorama.send_to_place", icon="TRACKER")
        row = layout.row(align=True)
        row.operator("panorama.add_sun", text="Add Sun", icon="LIGHT_SUN")
        row.operator("panorama.pick_sun", icon="EYEDROPPER")
        layout.operator("panorama.add_sun_by_time", text="Add Sun by Time...", icon="TIME")
        layout.operator("panorama.add_asset_library", icon="ASSET_MANAGER")
        self.draw_selection(context)

    def draw_selection(self, context):
        """Role and kept picture of what is selected."""
        layout, thing = self.layout, context.active_object
        column = layout.column(align=True)
        column.label(text="Selected meshes are:")
        for role in bpy.types.Object.bl_rna.properties["panorama_role"].enum_items:
            is_it = bool(thing and thing.type == "MESH" and thing.panorama_role == role.identifier)
            column.operator("panorama.set_role", text=role.name, depress=is_it).role = role.identifier
        if progress.is_own_support(thing):
            column = layout.column(align=True)
            column.prop(thing, "panorama_reflectivity")
            column.prop(thing, "panorama_roughness")
        column = layout.column(align=True)
        if progress.is_real(thing):
            kept = "keeps its picture" if progress.keeps_picture(thing) else "shows what lies behind it"
            paragraph(column, context, f"{thing.name} {kept}")
        row = column.row(align=True)
        row.operator("panorama.store_coordinates", icon="PINNED")
        row.operator("panorama.clear_coordinates", icon="UNPINNED")
        column.operator("panorama.write_uv", icon="UV")


class PANORAMA_PT_light(Step, bpy.types.Panel):
    """Step 5."""

    bl_label = "5  Depth and Light"

    def is_done(self, scene):
        """Prepared, and nothing moved since."""
        return not (progress.maps_missing(scene) or scene.panorama_set.maps_are_old)

    def draw(self, context):
        """Settings, the button, and what it found."""
        scene, layout = context.scene, self.layout
        job = scene.panorama_set.job
        column = layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        column.prop(job, "lights")
        if job.lights == "LIMIT":
            column.prop(job, "most_lights")
        self.say(context, progress.surfaces_missing(scene))
        layout.operator("panorama.prepare", icon="LIGHT_AREA")
        if not progress.maps_missing(scene):
            if scene.panorama_set.maps_are_old:
                self.say(context, "The place has changed: prepare again", "FILE_REFRESH")
            box = layout.box().column(align=True)
            paragraph(box, context, f"Lights: {progress.lights_found(scene)}")
            for warning in job.light_warnings.splitlines():
                self.say(context, warning, "ERROR")
            figure(box, "With depth", f"{100 * job.coverage:.0f} % of the sphere")
            figure(box, "Took", f"{job.seconds:.1f} s")
            if job.light_warnings:
                layout.operator("panorama.restore_light", text="Restore Clipped Light...", icon="LIGHT_SUN")
        layout.operator("panorama.light_from_infinity", icon="LIGHT_SUN")
        layout.operator("panorama.export_depth", text="Write RGB-D...", icon="EXPORT")


class PANORAMA_PT_render(Step, bpy.types.Panel):
    """Step 6."""

    bl_label = "6  Render"

    def is_done(self, scene):
        """F12 gives the picture."""
        return not progress.camera_missing(scene) and any(
            layer.name.startswith("Panorama") for layer in scene.view_layers
        )

    def draw_header_preset(self, context):
        """Presets of render quality."""
        PANORAMA_PT_render_presets.draw_panel_header(self.layout)

    def draw(self, context):
        """Settings and buttons."""
        scene, layout = context.scene, self.layout
        column = layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        for name in ("method", "samples", "seed", "denoise"):
            column.prop(scene.panorama_set.job, name)
        column.prop(scene, "camera")
        picture = frame(scene)
        figure(layout, "Picture", f"{picture.width} × {picture.height} pixels")
        row = layout.row(align=True)
        row.operator("panorama.add_camera", icon="CAMERA_DATA")
        row.operator("panorama.camera_from_view", text="From View")
        self.say(context, progress.camera_missing(scene))
        column = layout.column(align=True)
        column.operator("panorama.render_frame", icon="RENDER_STILL")
        column.operator("panorama.set_up_picture", icon="NODE_COMPOSITING")
        column.operator("panorama.render_panorama", text="Render Panorama...", icon="WORLD")


classes = (
    PANORAMA_PT_objects,
    PANORAMA_PT_light,
    PANORAMA_PT_render,
)
