"""The 3D View's sidebar tab "Panorama": the steps of the work in their order, each saying what is missing."""

from pathlib import Path

import bpy

from ..operators import progress
from ..operators.pictures import frame
from .lists import draw_picks, draw_shapes
from .texts import figure, paragraph


class _InSidebar:
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Panorama"


class PANORAMA_PT_job(_InSidebar, bpy.types.Panel):
    """What to do next."""

    bl_label = "Panorama"

    def draw(self, context):
        """The next step in one line."""
        paragraph(self.layout, context, progress.next_step(context.scene), "FORWARD")


class _Step(_InSidebar):
    """One step: a tick when it is done, what is missing when it cannot be, and its buttons."""

    bl_parent_id = "PANORAMA_PT_job"

    def draw_header(self, context):
        """The tick."""
        done = self.is_done(context.scene)
        self.layout.label(text="", icon="CHECKMARK" if done else "RADIOBUT_OFF")

    def say(self, context, text, icon="INFO"):
        """Show a sentence, if there is one."""
        if text:
            paragraph(self.layout, context, text, icon)


class PANORAMA_PT_image(_Step, bpy.types.Panel):
    """Step 1."""

    bl_label = "1  Image"

    def is_done(self, scene):
        """An image is there."""
        return not progress.image_missing(scene)

    def draw(self, context):
        """Open an image, or a whole set."""
        state = context.scene.panorama_set
        if state.image_path:
            width, height = state.image.size if state.image else (0, 0)
            size = f"{width} × {height}" if width else "not found"
            figure(self.layout, Path(state.image_path).name, size)
        column = self.layout.column(align=True)
        column.operator("panorama.load_image", text="Open Panorama...", icon="FILE_FOLDER")
        row = column.row(align=True)
        row.operator("panorama.import_set", text="Import Set...", icon="IMPORT")
        row.operator("panorama.export_set", text="Export Set...", icon="EXPORT")


class PANORAMA_PT_calibration(_Step, bpy.types.Panel):
    """Step 2."""

    bl_label = "2  Calibrate"

    def is_done(self, scene):
        """Solved, and nothing changed since."""
        return not (progress.calibration_missing(scene) or scene.panorama_set.calibration_is_old)

    def draw(self, context):
        """Scale, the button, and what it found."""
        scene, state = context.scene, context.scene.panorama_set
        column = self.layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        by_length = any(pick.kind == "LENGTH" for pick in state.picks)
        if not by_length:
            column.prop(state, "camera_height")
        missing = progress.picks_missing(scene)
        self.say(context, missing)
        if not missing:
            self.say(context, state.problem, "ERROR")
        self.layout.operator("panorama.calibrate", icon="ORIENTATION_GIMBAL")
        if not state.result.is_solved:
            return
        if state.calibration_is_old:
            self.say(context, "The picks have changed: calibrate again", "FILE_REFRESH")
        self.draw_result(context, state.result, by_length)

    def draw_result(self, context, result, by_length):
        """The figures, with one standard deviation for half a pixel of click error."""
        box = self.layout.box().column(align=True)
        figure(box, "Tilt", f"{result.tilt_deg:.2f}° ± {result.uncertainty_tilt_deg:.2f}°")
        if by_length:
            figure(box, "Camera height", f"{result.camera_height:.3f} m")
        figure(box, "Scale", f"± {result.uncertainty_scale_percent:.1f} %")
        figure(box, "Residual", f"{result.residual_deg:.3f}°")
        figure(box, "Condition", f"{result.condition:.1f} (1 is best)")
        for warning in result.warnings.splitlines():
            paragraph(box, context, warning, "ERROR")


class PANORAMA_PT_picks(_InSidebar, bpy.types.Panel):
    """The picks of step 2."""

    bl_label = "Picks"
    bl_parent_id = "PANORAMA_PT_calibration"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """The list."""
        paragraph(self.layout, context, "Set points in the Image Editor's sidebar, or type them here")
        draw_picks(self.layout, context.scene.panorama_set)


class PANORAMA_PT_shapes(_Step, bpy.types.Panel):
    """Step 3."""

    bl_label = "3  Shapes"

    def is_done(self, scene):
        """Built, and nothing changed since."""
        state = scene.panorama_set
        return any(shape.is_built for shape in state.shapes) and not state.shapes_are_old

    def draw(self, context):
        """The button, and how it went."""
        state = context.scene.panorama_set
        self.say(context, progress.shapes_missing(context.scene))
        self.layout.operator("panorama.build", icon="MESH_CUBE")
        built = [shape for shape in state.shapes if shape.is_built]
        if built:
            worst = max(built, key=lambda shape: shape.residual)
            box = self.layout.box().column(align=True)
            figure(box, "Built", f"{len(built)} of {len(state.shapes)}")
            figure(box, "Largest residual", f"{1000 * worst.residual:.1f} mm")
        if built and state.shapes_are_old:
            self.say(context, "The shapes have changed: build again", "FILE_REFRESH")
        for shape in built:
            for warning in shape.warnings.splitlines():
                self.say(context, f"{shape.name}: {warning}", "ERROR")


class PANORAMA_PT_shape_list(_InSidebar, bpy.types.Panel):
    """The shapes of step 3."""

    bl_label = "Shape List"
    bl_parent_id = "PANORAMA_PT_shapes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """The list, and what is left out of it."""
        hint = "What no shape covers shows at infinity. To remove a real thing, leave it out here"
        paragraph(self.layout, context, f"{hint} and cover it with a new object")
        draw_shapes(self.layout, context, context.scene.panorama_set)


class PANORAMA_PT_objects(_Step, bpy.types.Panel):
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


class PANORAMA_PT_light(_Step, bpy.types.Panel):
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
            figure(box, "Lights", f"{job.light_count} with {100 * job.light_share:.0f} % of the light")
            figure(box, "With depth", f"{100 * job.coverage:.0f} % of the sphere")
            figure(box, "Took", f"{job.seconds:.1f} s")
        layout.operator("panorama.export_depth", text="Write RGB-D...", icon="EXPORT")


class PANORAMA_PT_render(_Step, bpy.types.Panel):
    """Step 6."""

    bl_label = "6  Render"

    def is_done(self, scene):
        """F12 gives the picture."""
        return not progress.camera_missing(scene) and any(
            layer.name.startswith("Panorama") for layer in scene.view_layers
        )

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
        layout.operator("panorama.add_camera", icon="CAMERA_DATA")
        self.say(context, progress.camera_missing(scene))
        column = layout.column(align=True)
        column.operator("panorama.render_frame", icon="RENDER_STILL")
        column.operator("panorama.set_up_picture", icon="NODE_COMPOSITING")
        column.operator("panorama.render_panorama", text="Render Panorama...", icon="WORLD")


classes = (
    PANORAMA_PT_job,
    PANORAMA_PT_image,
    PANORAMA_PT_calibration,
    PANORAMA_PT_picks,
    PANORAMA_PT_shapes,
    PANORAMA_PT_shape_list,
    PANORAMA_PT_objects,
    PANORAMA_PT_light,
    PANORAMA_PT_render,
)
