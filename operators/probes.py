"""Operators that add what a first look at a place needs: sample balls on the floor, and a camera."""

import bmesh
import bpy
from mathutils import Matrix, Vector

from ..cycles_integration.node_trees import add
from ..cycles_integration.place import place_of
from . import progress
from .reporting import Reporting, possible

BALLS = (
    ("MIRROR", "Mirror Ball", "A perfect mirror: shows what is reflected, and where"),
    ("MATTE", "Matte Ball", "Grey and diffuse, albedo 0.5: shows where light comes from, and its colour"),
)
DISPLAY_SIZE = 0.2
"""Of a camera [m]: it often stands where the view's eye is."""


class PANORAMA_OT_add_ball(Reporting, bpy.types.Operator):
    """Stand a sample ball on the floor, below or above the 3D cursor"""

    bl_idname = "panorama.add_ball"
    bl_label = "Add Ball"

    kind: bpy.props.EnumProperty(name="Kind", description="What the ball shows", items=BALLS)
    radius: bpy.props.FloatProperty(
        name="Radius",
        description="Radius of the ball; it touches the floor",
        default=0.15,
        min=0.001,
        soft_max=1,
        unit="LENGTH",
    )

    @classmethod
    def poll(cls, context):
        """There must be a floor."""
        return possible(cls, progress.calibration_missing(context.scene))

    def work(self, context):
        """Add the ball and select it alone."""
        ball = new_ball(self.kind, self.radius)
        x, y, _ = context.scene.cursor.location
        ball.location = (x, y, self.radius)
        _add_selected(context, ball)
        return f"{ball.name}, {200 * self.radius:.0f} cm wide, at ({x:.2f}, {y:.2f}) m"


class PANORAMA_OT_add_camera(Reporting, bpy.types.Operator):
    """Put a camera where the panorama was captured, looking at the selected object or the 3D cursor"""

    bl_idname = "panorama.add_camera"
    bl_label = "Add Camera"

    @classmethod
    def poll(cls, context):
        """There must be an origin."""
        return possible(cls, progress.calibration_missing(context.scene))

    def work(self, context):
        """Add the camera and make it the scene's."""
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        active = context.active_object
        aimed_at = active if active in context.selected_objects else None
        target = aimed_at.matrix_world.translation if aimed_at else context.scene.cursor.location
        camera.location = place_of(context.scene).origin.matrix_world.translation
        camera.data.lens, camera.data.clip_start = 24, 0.01
        camera.data.display_size = DISPLAY_SIZE
        camera.rotation_euler = (target - camera.location).to_track_quat("-Z", "Y").to_euler()
        _add_selected(context, camera)
        context.scene.camera = camera
        return f"Camera looks at {aimed_at.name if aimed_at else 'the 3D cursor'}"


class PANORAMA_OT_camera_from_view(Reporting, bpy.types.Operator):
    """Put a camera where this 3D View looks from, with its angle of view; or keep it where the panorama was
    captured, from where alone the photograph fits without gaps"""

    bl_idname = "panorama.camera_from_view"
    bl_label = "Camera from View"

    at_origin: bpy.props.BoolProperty(
        name="Stay at the Point of Capture",
        description="Take the view's direction only: the camera stays where the panorama was captured",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        """There must be an origin, and a view to look from."""
        reason = progress.calibration_missing(context.scene)
        in_view = context.space_data is not None and context.space_data.type == "VIEW_3D"
        return possible(cls, reason or ("" if in_view else "Only in a 3D View"))

    def work(self, context):
        """Add the camera and make it the scene's."""
        space = context.space_data
        view = space.region_3d
        if view.view_perspective != "PERSP":
            raise ValueError("this view is orthographic or a camera's: turn it to perspective (Numpad 5)")
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        back = view.view_rotation @ Vector((0, 0, view.view_distance))
        camera.matrix_world = Matrix.LocRotScale(view.view_location + back, view.view_rotation, None)
        if self.at_origin:
            camera.location = place_of(context.scene).origin.matrix_world.translation
        # A view is cut out of twice the film of a camera: its lens of 50 mm sees what one of 25 mm does.
        camera.data.lens, camera.data.clip_start = space.lens / 2, 0.01
        camera.data.display_size = DISPLAY_SIZE
        _add_selected(context, camera)
        context.scene.camera = camera
        return (
            f"Camera of {space.lens / 2:.3g} mm at {'the point of capture' if self.at_origin else 'the view'}"
        )


def new_ball(kind, radius) -> bpy.types.Object:
    """A sample ball of a radius [m] that no scene shows yet."""
    name = f"{kind.title()} Ball"
    ball = bpy.data.objects.new(name, _sphere(name, radius))
    ball.data.materials.append(_material(kind))
    return ball


def _sphere(name, radius):
    mesh = bpy.data.meshes.new(name)
    shape = bmesh.new()
    bmesh.ops.create_uvsphere(shape, u_segments=64, v_segments=32, radius=radius)
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
    return mesh


def _material(kind):
    material = bpy.data.materials.new(f"{kind.title()} Ball")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    if kind == "MIRROR":
        shader = add(tree, "ShaderNodeBsdfAnisotropic", {"Color": (1, 1, 1), "Roughness": 0})
    else:
        shader = add(tree, "ShaderNodeBsdfDiffuse", {"Color": (0.5, 0.5, 0.5)})
    add(tree, "ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return material


def _add_selected(context, thing):
    context.scene.collection.objects.link(thing)
    select_alone(context, thing)


def select_alone(context, thing):
    """Make an object the only selected one, and the active one."""
    for other in context.selected_objects:
        other.select_set(False)
    if thing.name in context.view_layer.objects:  # else in a collection that is left out of it
        thing.select_set(True)
        context.view_layer.objects.active = thing


classes = (PANORAMA_OT_add_ball, PANORAMA_OT_add_camera, PANORAMA_OT_camera_from_view)
