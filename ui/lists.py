"""The lists of picks and shapes with the selected one's fields, for sidebar and Image Editor."""

import bpy

from ..operators.conversion import pick_label, point_labels
from ..operators.picking import GROWS_BY
from .texts import figure, paragraph

PICK_ICONS = {"RECTANGLE": "MESH_PLANE", "PARALLELS": "ALIGN_JUSTIFY", "VERTICAL": "EMPTY_SINGLE_ARROW"}
PICK_ENTRIES = (
    ("Floor Rectangle", "RECTANGLE", {"plane": "FLOOR"}),
    ("Ceiling Rectangle", "RECTANGLE", {"plane": "CEILING"}),
    ("Wall Rectangle", "RECTANGLE", {"plane": "WALL"}),
    ("Floor Lines along X", "PARALLELS", {"axis": "X"}),
    ("Floor Lines along Y", "PARALLELS", {"axis": "Y"}),
    ("Verticals", "VERTICAL", {}),
    ("Known Length", "LENGTH", {}),
)
SHAPE_ICONS = {
    "walls": "MOD_BUILD",
    "box": "MESH_CUBE",
    "cylinder": "MESH_CYLINDER",
    "circle": "MESH_CIRCLE",
}


class PANORAMA_UL_picks(bpy.types.UIList):
    """What each pick is, and whether its points are all there."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0):
        """One row."""
        layout.label(text=pick_label(item, index), icon=PICK_ICONS.get(item.kind, "DRIVER_DISTANCE"))
        _mark_missing(layout, item.points)


class PANORAMA_UL_shapes(bpy.types.UIList):
    """Each shape's name and role, and whether its points are all there."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0):
        """One row."""
        layout.prop(item, "name", text="", emboss=False, icon=SHAPE_ICONS.get(item.kind, "MESH_PLANE"))
        _mark_missing(layout, item.points)


class PANORAMA_MT_add_shape(bpy.types.Menu):
    """The kinds of shapes."""

    bl_label = "Add Shape"

    def draw(self, context):
        """All kinds, the flat ones first."""
        self.layout.operator_enum("panorama.add_shape", "kind")


class PANORAMA_MT_add_pick(bpy.types.Menu):
    """The kinds of picks."""

    bl_label = "Add Pick"

    def draw(self, context):
        """All kinds; each begins to be picked on the panorama."""
        self.layout.operator_context = "INVOKE_REGION_WIN"  # a menu on a key of one's own would execute
        for text, kind, choice in PICK_ENTRIES:
            icon = PICK_ICONS.get(kind, "DRIVER_DISTANCE")
            button = self.layout.operator("panorama.pick_points", text=text, icon=icon)
            button.kind = kind
            for name, value in choice.items():
                setattr(button, name, value)


def draw_picks(layout, state, from_cursor=False):
    """The list of picks and the selected one."""
    _draw_list(layout, state, "PANORAMA_UL_picks", "picks", "active_pick", "PICK", "PANORAMA_MT_add_pick")
    if not 0 <= state.active_pick < len(state.picks):
        return
    pick = state.picks[state.active_pick]
    column = layout.column()
    fields = {"RECTANGLE": "plane", "PARALLELS": "axis", "LENGTH": "metres"}
    if pick.kind in fields:
        column.row().prop(pick, fields[pick.kind], expand=pick.kind != "LENGTH")
    column.operator("panorama.pick_points", text="Pick in View", icon="RESTRICT_SELECT_OFF").kind = "SELECTED"
    _draw_points(layout, pick, "PICK", from_cursor)


def draw_shapes(layout, context, state, from_cursor=False):
    """The list of shapes and the selected one."""
    names = ("PANORAMA_UL_shapes", "shapes", "active_shape", "SHAPE", "PANORAMA_MT_add_shape")
    _draw_list(layout, state, *names)
    if not 0 <= state.active_shape < len(state.shapes):
        return
    shape = state.shapes[state.active_shape]
    figure(layout, "Kind", shape.bl_rna.properties["kind"].enum_items[shape.kind].name)
    _draw_shape_fields(layout.column(), state, shape)
    _draw_points(layout, shape, "SHAPE", from_cursor)
    if shape.kind in ("walls", "box", "cylinder") and not shape.has_height:
        _draw_point(layout, shape.top, "Top", "SHAPE", -1, from_cursor)
    if shape.is_built:
        size = " × ".join(f"{length:.2f}" for length in shape.size if length > 0)
        figure(layout, "Size", f"{size} m")
        figure(layout, "Residual", f"{1000 * shape.residual:.1f} mm")
        for warning in shape.warnings.splitlines():
            paragraph(layout, context, warning, "ERROR")


def _draw_shape_fields(column, state, shape):
    column.use_property_split = True
    column.use_property_decorate = False
    column.prop(shape, "role")
    if shape.role == "SUPPORT":
        column.prop(shape, "reflectivity")
        if shape.reflectivity > 0:
            column.prop(shape, "roughness")
    if shape.kind == "walls":
        column.prop_search(shape, "of", state, "shapes")
        column.prop(shape, "ceiling")
    if shape.kind in ("walls", "box", "cylinder"):
        column.prop(shape, "has_height")
        if shape.has_height:
            column.prop(shape, "height")


def _draw_list(layout, state, list_type, items, active, target, menu):
    row = layout.row()
    row.template_list(list_type, "", state, items, state, active, rows=4)
    side = row.column(align=True)
    side.menu(menu, icon="ADD", text="")
    side.operator("panorama.remove_item", icon="REMOVE", text="").target = target
    for step, icon in ((-1, "TRIA_UP"), (1, "TRIA_DOWN")):
        move = side.operator("panorama.move_item", icon=icon, text="")
        move.target, move.step = target, step


def _draw_points(layout, item, target, from_cursor):
    column = layout.column(align=True)
    for index, (point, label) in enumerate(zip(item.points, point_labels(item), strict=True)):
        _draw_point(column, point, label, target, index, from_cursor)
    if item.kind in GROWS_BY:
        row = column.row(align=True)
        thing = "Line" if item.kind == "PARALLELS" else "Point"
        for grow, verb, icon in ((True, "Add", "ADD"), (False, "Remove", "REMOVE")):
            button = row.operator("panorama.resize_item", text=f"{verb} {thing}", icon=icon)
            button.target, button.grow = target, grow


def _draw_point(layout, point, label, target, index, from_cursor):
    split = layout.split(factor=0.3, align=True)
    split.label(text=label, icon="NONE" if point.picked else "ERROR")
    row = split.row(align=True)
    row.prop(point, "uv", text="")
    if from_cursor:
        button = row.operator("panorama.set_point", text="", icon="PIVOT_CURSOR")
        button.target, button.index = target, index


def _mark_missing(layout, points):
    missing = sum(not point.picked for point in points)
    if missing:
        layout.label(text=f"{missing} to set", icon="ERROR")


classes = (PANORAMA_UL_picks, PANORAMA_UL_shapes, PANORAMA_MT_add_shape, PANORAMA_MT_add_pick)
