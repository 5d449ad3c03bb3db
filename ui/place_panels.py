"""The sidebar's steps from an image to a rebuilt place, each saying what is missing."""

from pathlib import Path

import bpy

from ..operators import progress
from .lists import draw_picks, draw_shapes
from .shape_buttons import draw_buttons
from .steps import InSidebar, Step
from .texts import figure, paragraph


class PANORAMA_PT_job(InSidebar, bpy.types.Panel):
    """What to do next."""

    bl_label = "Panorama"

    def draw(self, context):
        """The next step in one line."""
        paragraph(self.layout, context, progress.next_step(context.scene), "FORWARD")


class PANORAMA_PT_image(Step, bpy.types.Panel):
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
        column.operator("panorama.load_rgbd", text="Open RGB-D Panorama...", icon="FILE_3D")
        row = column.row(align=True)
        row.operator("panorama.import_set", text="Import Set...", icon="IMPORT")
        row.operator("panorama.export_set", text="Export Set...", icon="EXPORT")
        if not state.image_path:
            column.operator("panorama.load_sample", icon="HOME")


class PANORAMA_PT_calibration(Step, bpy.types.Panel):
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
        self.draw_pick_button(state)
        self.layout.operator("panorama.calibrate", icon="ORIENTATION_GIMBAL")
        if not state.result.is_solved:
            return
        if state.calibration_is_old:
            self.say(context, "The picks have changed: calibrate again", "FILE_REFRESH")
        self.draw_result(context, state.result, by_length)

    def draw_pick_button(self, state):
        """Begin with a floor rectangle, or go on with what is picked."""
        begin = "SELECTED" if state.picks else "RECTANGLE"
        text = "Pick Points" if state.picks else "Pick Floor Rectangle"
        button = self.layout.operator("panorama.pick_points", text=text, icon="RESTRICT_SELECT_OFF")
        button.kind, button.plane = begin, "FLOOR"

    def draw_result(self, context, result, by_length):
        """The figures, with one standard deviation for half a pixel of click error."""
        box = self.layout.box().column(align=True)
        if not result.condition:  # it came with the file
            figure(box, "Tilt", f"{result.tilt_deg:.2f}°, as the file says")
            figure(box, "Camera height", f"{result.camera_height:.3f} m")
            return
        figure(box, "Tilt", f"{result.tilt_deg:.2f}° ± {result.uncertainty_tilt_deg:.2f}°")
        if by_length:
            figure(box, "Camera height", f"{result.camera_height:.3f} m")
        figure(box, "Scale", f"± {result.uncertainty_scale_percent:.1f} %")
        figure(box, "Residual", f"{result.residual_deg:.3f}°")
        figure(box, "Condition", f"{result.condition:.1f} (1 is best)")
        for warning in result.warnings.splitlines():
            paragraph(box, context, warning, "ERROR")


class PANORAMA_PT_picks(InSidebar, bpy.types.Panel):
    """The picks of step 2."""

    bl_label = "Picks"
    bl_parent_id = "PANORAMA_PT_calibration"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """The list."""
        paragraph(self.layout, context, "The list's + begins a pick in the view. Points can be typed, too")
        draw_picks(self.layout, context.scene.panorama_set)


class PANORAMA_PT_shapes(Step, bpy.types.Panel):
    """Step 3."""

    bl_label = "3  Shapes"

    def is_done(self, scene):
        """Built, and nothing changed since."""
        state = scene.panorama_set
        return any(shape.is_built for shape in state.shapes) and not state.shapes_are_old

    def draw(self, context):
        """The button, and how it went."""
        state = context.scene.panorama_set
        self.say(context, progress.drawing_missing(context.scene) or progress.shapes_missing(context.scene))
        draw_buttons(self.layout, context)
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


class PANORAMA_PT_shape_list(InSidebar, bpy.types.Panel):
    """The shapes of step 3."""

    bl_label = "Shape List"
    bl_parent_id = "PANORAMA_PT_shapes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """The list, and what is left out of it."""
        hint = "What no shape covers shows at infinity. To remove a real thing, leave it out here"
        paragraph(self.layout, context, f"{hint} and cover it with a new object")
        draw_shapes(self.layout, context, context.scene.panorama_set)


classes = (
    PANORAMA_PT_job,
    PANORAMA_PT_image,
    PANORAMA_PT_calibration,
    PANORAMA_PT_picks,
    PANORAMA_PT_shapes,
    PANORAMA_PT_shape_list,
)
