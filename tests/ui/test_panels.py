"""Every panel draws in every state of the work, names operators that exist, and says what comes next."""

import numpy as np
from layered_box import layered_box
from room_job import built, calibrated, select

from expanded_panoramas.ibl_toolkit.layers.files.storage import write_layers


class Layout:
    """Takes every call of a panel, notes its texts, and refuses what Blender would not know."""

    def __init__(self, bpy, texts):
        self.bpy, self.texts = bpy, texts

    def _child(self, *arguments, **keywords):
        return Layout(self.bpy, self.texts)

    row = column = box = split = _child

    def label(self, text="", icon="NONE"):
        self._check_icon(icon)
        self.texts.append(text)

    def prop(self, owner, name, icon="NONE", **keywords):
        assert name in owner.bl_rna.properties or hasattr(owner, name), name
        self._check_icon(icon)

    def prop_enum(self, owner, name, value, text="", icon="NONE"):
        assert value in owner.bl_rna.properties[name].enum_items
        self._check_icon(icon)

    def prop_search(self, owner, name, within, search):
        assert hasattr(owner, name)
        assert hasattr(within, search)

    def operator(self, name, text=None, icon="NONE", depress=False):
        self._check_icon(icon)
        room, _, verb = name.partition(".")
        assert verb in dir(getattr(self.bpy.ops, room)), name
        return Properties(getattr(self.bpy.ops, room), verb)

    def operator_enum(self, name, enum):
        assert enum in self.operator(name).known

    def menu(self, name, icon="NONE", text=""):
        assert hasattr(self.bpy.types, name)

    def template_list(self, kind, _, owner, items, active_owner, active, rows):
        draw = getattr(self.bpy.types, kind).draw_item
        for index, item in enumerate(getattr(owner, items)):
            draw(None, self.bpy.context, self, owner, item, 0, active_owner, active, index)

    def _check_icon(self, icon):
        icons = self.bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        assert icon in icons, icon


class Properties:
    """An operator button's properties: only those that the operator has."""

    def __init__(self, room, verb):
        object.__setattr__(self, "known", getattr(room, verb).get_rna_type().properties.keys())

    def __setattr__(self, name, value):
        assert name in self.known, name


def draw_all(bpy):
    """Draw the sidebar; returns its texts by panel."""
    from expanded_panoramas.ui import layer_panel, picture_panels, place_panels, probe_panel

    modules = (place_panels, picture_panels, probe_panel, layer_panel)
    classes = [cls for module in modules for cls in module.classes]
    return {cls.__name__: draw(bpy, cls) for cls in classes}


def draw(bpy, cls, context=None):
    texts = []
    names = {name: value for base in reversed(cls.__mro__) for name, value in vars(base).items()}
    panel = type("Panel", (), {k: v for k, v in names.items() if callable(v) and not k.startswith("__")})()
    panel.layout = Layout(bpy, texts)
    if hasattr(panel, "draw_header"):
        panel.draw_header(context or bpy.context)
    panel.draw(context or bpy.context)
    return " ".join(texts)


def test_empty_scene(fresh_blend):
    texts = draw_all(fresh_blend)
    assert "Step 1: Open a panorama first" in texts["PANORAMA_PT_job"]
    assert "Calibrate first" in texts["PANORAMA_PT_light"]


def test_it_follows_the_work(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = calibrated(bpy, tmp_path)
    texts = draw_all(bpy)
    assert "Step 3: Build the shapes" in texts["PANORAMA_PT_job"]
    assert "±" in texts["PANORAMA_PT_calibration"]
    bpy.ops.panorama.build()
    assert "Step 4" in draw_all(bpy)["PANORAMA_PT_job"]
    bpy.ops.panorama.add_ball(kind="MIRROR")
    assert "Step 5" in draw_all(bpy)["PANORAMA_PT_job"]
    state.picks[0].points[0].uv = (0.1, 0.9)
    texts = draw_all(bpy)
    assert "Step 2" in texts["PANORAMA_PT_job"]
    assert "calibrate again" in texts["PANORAMA_PT_calibration"]


def test_layers_say_what_is_there_and_what_is_missing(fresh_blend, tmp_path):
    layers = fresh_blend.context.scene.panorama_layers
    texts = draw_all(fresh_blend)["PANORAMA_PT_layers"]
    assert "Open a panorama, or add a camera" in texts
    assert "Choose a folder with layers, or make them" in texts
    write_layers(layered_box(), tmp_path / "box")
    layers.folder = str(tmp_path / "box")
    texts = draw_all(fresh_blend)["PANORAMA_PT_layers"]
    assert "room, objects; radius 0.5 m" in texts
    assert "Choose" not in texts
    (tmp_path / "box" / "panorama.xml").write_text("<no")
    layers.folder = str(tmp_path / "box")
    assert "no XML that can be read" in draw_all(fresh_blend)["PANORAMA_PT_layers"]


def test_every_kind_of_pick_and_shape_draws(fresh_blend):
    from expanded_panoramas.operators.properties import PICK_KINDS, SHAPE_KINDS

    bpy = fresh_blend
    for kind, *_ in PICK_KINDS:
        bpy.ops.panorama.add_pick(kind=kind)
        assert "to set" in draw_all(bpy)["PANORAMA_PT_picks"]
    for kind, *_ in SHAPE_KINDS:
        bpy.ops.panorama.add_shape(kind=kind)
        bpy.context.scene.panorama_set.shapes[-1].reflectivity = 0.1
        draw_all(bpy)


def test_warnings_and_problems_are_shown(fresh_blend, tmp_path):
    bpy = fresh_blend
    state = built(bpy, tmp_path)
    state.result.warnings, state.shapes[0].warnings, state.problem = "tilted much", "far off", "no height"
    texts = draw_all(bpy)
    assert "tilted much" in texts["PANORAMA_PT_calibration"]
    assert "no height" in texts["PANORAMA_PT_calibration"]
    assert "far off" in texts["PANORAMA_PT_shapes"]


def test_a_calibration_that_came_with_the_file(fresh_blend, tmp_path):
    state = calibrated(fresh_blend, tmp_path)
    for name in ("condition", "uncertainty_tilt_deg", "residual_deg"):
        state.result.property_unset(name)
    state.result.tilt_deg = 12.5
    texts = draw_all(fresh_blend)["PANORAMA_PT_calibration"]
    assert "12.50°, as the file says" in texts
    assert "±" not in texts


def test_lights_of_a_photo_are_listed_with_what_is_doubtful(fresh_blend):
    from expanded_panoramas.cycles_integration.probe_lights import ProbeSun, put_probe_lights

    bpy = fresh_blend
    assert "Photograph a mirror or matte ball" in draw_all(bpy)["PANORAMA_PT_light_of_photo"]
    sun = ProbeSun(np.array((0.6, 0, 0.8)), np.array((2.0, 1.0, 1.0)), 4.0)
    told = {"photo": "ball.jpg", "warnings": "Light 1: clipped\nThe frame cuts the ball"}
    put_probe_lights(bpy.context.scene, [sun], np.eye(4).tolist(), told)
    bpy.context.view_layer.update()
    texts = draw_all(bpy)["PANORAMA_PT_light_of_photo"]
    assert "Photo ball.jpg Probe Light 1 53° high, strength 2 Light 1: clipped The frame cuts" in texts


def test_selected_pieces(fresh_blend, tmp_path):
    bpy = fresh_blend
    built(bpy, tmp_path)
    select(bpy, "floor")
    assert "floor shows what lies behind it" in draw_all(bpy)["PANORAMA_PT_objects"]
    bpy.ops.panorama.store_coordinates()
    assert "floor keeps its picture" in draw_all(bpy)["PANORAMA_PT_objects"]


def test_image_editor(fresh_blend, tmp_path):
    from expanded_panoramas.ui import image_editor

    bpy = fresh_blend
    calibrated(bpy, tmp_path)
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    area.type = "IMAGE_EDITOR"
    with bpy.context.temp_override(window=window, area=area, space_data=area.spaces.active):
        for cls in image_editor.classes:
            draw(bpy, cls)


def test_nothing_stays_registered(fresh_blend):
    import expanded_panoramas
    from expanded_panoramas import operators, ui

    bpy = fresh_blend
    panels = [cls.__name__ for module in ui.PANELS for cls in module.classes]
    buttons = [cls.bl_idname.split(".")[1] for module in operators.OPERATORS for cls in module.classes]
    assert all(hasattr(bpy.types, name) for name in panels)
    assert set(buttons) == set(dir(bpy.ops.panorama))
    expanded_panoramas.unregister()
    left = [name for name in panels if hasattr(bpy.types, name)], dir(bpy.ops.panorama)
    state_left = hasattr(bpy.types.Scene, "panorama_set")
    expanded_panoramas.register()
    assert (*left, state_left) == ([], [], False)
