"""Operators that add, remove, order and set picks and shapes."""

import bpy

from . import conversion, tools
from .properties import PICK_KINDS, SHAPE_KINDS
from .reporting import Reporting, possible

LISTS = (("PICK", "Pick", "The calibration's picks"), ("SHAPE", "Shape", "The shapes of the place"))
GROWS_BY = {"PARALLELS": (2, 2), "polygon": (1, 3), "circle": (1, 3), "cylinder": (1, 3)}
"""Kinds with any number of points: how many come at once, and how few they keep."""


class PANORAMA_OT_add_pick(Reporting, bpy.types.Operator):
    """Add something of the image that tells about the camera's orientation or the scale"""

    bl_idname = "panorama.add_pick"
    bl_label = "Add Pick"

    kind: bpy.props.EnumProperty(name="Kind", description="What is to be clicked", items=PICK_KINDS)

    def work(self, context):
        """Append a pick whose points are still to be set."""
        if tools.busy():
            raise ValueError(tools.busy())
        state = context.scene.panorama_set
        if self.kind == "LENGTH" and any(pick.kind == "LENGTH" for pick in state.picks):
            raise ValueError("there is a known length already: the scale needs one only")
        pick = conversion.add_pick(state, self.kind)
        state.active_pick = len(state.picks) - 1
        state.calibration_is_old = True
        return f"Pick {conversion.pick_label(pick, state.active_pick)}: set its {len(pick.points)} points"


class PANORAMA_OT_add_shape(Reporting, bpy.types.Operator):
    """Add a shape of the real place that new objects stand on, are hidden by or are lit by"""

    bl_idname = "panorama.add_shape"
    bl_label = "Add Shape"

    kind: bpy.props.EnumProperty(name="Kind", description="What the shape is", items=SHAPE_KINDS)

    def work(self, context):
        """Append a shape whose points are still to be set; walls stand over the active flat shape."""
        state = context.scene.panorama_set
        shape = conversion.add_shape(state, self.kind, conversion.free_name(state, self.kind))
        if self.kind == "walls":
            flat = [s.name for s in state.shapes if s.kind in ("polygon", "rectangle", "square", "circle")]
            shape.of, shape.ceiling, shape.role = next(iter(flat), ""), True, "ENVIRONMENT"
        state.active_shape = len(state.shapes) - 1
        state.shapes_are_old = True
        return f"Shape '{shape.name}': set its points"


class _OnItem(Reporting):
    """An operator on the active pick or shape."""

    target: bpy.props.EnumProperty(
        name="List", description="The list whose selected item is meant", items=LISTS
    )

    @classmethod
    def poll(cls, context):
        """There must be something in one of the lists, and no tool that edits a copy of them."""
        state = context.scene.panorama_set
        empty = "" if state.picks or state.shapes else "Add a pick or a shape first"
        return possible(cls, tools.busy() or empty)

    def items(self, context):
        """The list, its active index, and that index's property."""
        state = context.scene.panorama_set
        found = (
            (state.picks, state.active_pick, "active_pick")
            if self.target == "PICK"
            else (state.shapes, state.active_shape, "active_shape")
        )
        if not 0 <= found[1] < len(found[0]):
            raise ValueError(f"no {self.target.lower()} is selected in the list")
        return found

    def mark_old(self, context):
        """What was solved no longer fits the picks."""
        state = context.scene.panorama_set
        setattr(state, "calibration_is_old" if self.target == "PICK" else "shapes_are_old", True)


class PANORAMA_OT_remove_item(_OnItem, bpy.types.Operator):
    """Remove the selected pick or shape; a built shape's object goes at the next Build"""

    bl_idname = "panorama.remove_item"
    bl_label = "Remove"

    def work(self, context):
        """Remove it and select the one before it."""
        items, index, active = self.items(context)
        items.remove(index)
        setattr(context.scene.panorama_set, active, max(index - 1, 0))
        self.mark_old(context)
        return f"Removed {self.target.lower()} {index + 1}"


class PANORAMA_OT_move_item(_OnItem, bpy.types.Operator):
    """Move the selected item up or down: the first floor rectangle gives +x, later shapes lie on top"""

    bl_idname = "panorama.move_item"
    bl_label = "Move"

    step: bpy.props.IntProperty(
        name="Step", description="Number of places to move down the list; -1: up", default=1, min=-1, max=1
    )

    def work(self, context):
        """Swap it with its neighbour."""
        items, index, active = self.items(context)
        target = min(max(index + self.step, 0), len(items) - 1)
        items.move(index, target)
        setattr(context.scene.panorama_set, active, target)
        self.mark_old(context)
        return f"Moved to place {target + 1}"


class PANORAMA_OT_resize_item(_OnItem, bpy.types.Operator):
    """Give the selected pick or shape one more point (a whole line for floor lines), or take the last away"""

    bl_idname = "panorama.resize_item"
    bl_label = "More or Fewer Points"

    grow: bpy.props.BoolProperty(
        name="Add", description="Add at the end; otherwise take the last away", default=True
    )

    def work(self, context):
        """Append or remove points at the end."""
        items, index, _ = self.items(context)
        item = items[index]
        if item.kind not in GROWS_BY:
            raise ValueError(f"a {item.kind.lower()} has {len(item.points)} points, no more and no fewer")
        count, fewest = GROWS_BY[item.kind]
        if not self.grow and len(item.points) - count < fewest:
            raise ValueError(f"it has {len(item.points)} points and needs at least {fewest}")
        for _ in range(count):
            item.points.add() if self.grow else item.points.remove(len(item.points) - 1)
        self.mark_old(context)
        return f"{len(item.points)} points"


class PANORAMA_OT_set_point(_OnItem, bpy.types.Operator):
    """Set this point to where the Image Editor's 2D cursor is"""

    bl_idname = "panorama.set_point"
    bl_label = "Set from 2D Cursor"

    index: bpy.props.IntProperty(name="Point", description="Number of the point from 0; -1: top", min=-1)

    @classmethod
    def poll(cls, context):
        """The cursor is an Image Editor's."""
        in_editor = context.space_data is not None and context.space_data.type == "IMAGE_EDITOR"
        reason = "" if in_editor else "Only in the Image Editor, whose 2D cursor marks the point"
        return possible(cls, reason) and super().poll(context)

    def work(self, context):
        """Copy the cursor's place into the point."""
        items, index, _ = self.items(context)
        uv = cursor_pick(context.space_data)
        item = items[index]
        if self.index >= len(item.points):
            raise ValueError(f"point {self.index + 1} is asked for, there are {len(item.points)}")
        if self.index < 0 and self.target == "PICK":
            raise ValueError("only a shape has a top")
        conversion.set_point(item.top if self.index < 0 else item.points[self.index], uv)
        return f"({uv[0]:.5f}, {uv[1]:.5f})"


def cursor_pick(space):
    """Return the pick (u, v), v from the top, under an Image Editor's 2D cursor.

    Raises ValueError where it is outside of the image, or where there is no image.
    """
    if space.image is None:
        raise ValueError("this Image Editor shows no image: show the panorama in it")
    u, v = space.cursor_location
    if space.uv_editor.show_pixel_coords:
        u, v = u / space.image.size[0], v / space.image.size[1]
    if not (0 <= u <= 1 and 0 <= v <= 1):
        raise ValueError(f"the 2D cursor is at ({u:.3f}, {v:.3f}), outside of the image")
    return u, 1 - v


classes = (
    PANORAMA_OT_add_pick,
    PANORAMA_OT_add_shape,
    PANORAMA_OT_remove_item,
    PANORAMA_OT_move_item,
    PANORAMA_OT_resize_item,
    PANORAMA_OT_set_point,
)
