"""The 3D View's header: a button where there is a panorama; its pop-over names what exists."""

from types import SimpleNamespace


class Noting:
    """A layout that notes what is put into it."""

    def __init__(self, noted):
        self.noted = noted

    def row(self, **_):
        return self

    def column(self, **_):
        return self

    def prop(self, owner, name, **_):
        assert name in owner.bl_rna.properties
        self.noted.append(name)

    def popover(self, panel, **_):
        self.noted.append(panel)

    def operator(self, name, **_):
        self.noted.append(name)


def in_header(bpy):
    from expanded_panoramas.ui import view_header

    noted = []
    view_header.draw_toggle(SimpleNamespace(layout=Noting(noted)), bpy.context)
    return noted


def test_only_a_scene_with_a_panorama_has_the_button(fresh_blend):
    assert in_header(fresh_blend) == []
    fresh_blend.context.scene.panorama_set.image = fresh_blend.data.images.new("panorama", 8, 4)
    assert in_header(fresh_blend) == ["show_background", "PANORAMA_PT_view"]


def test_the_pop_over_names_what_exists(fresh_blend):
    from expanded_panoramas.ui import view_header

    bpy = fresh_blend
    assert hasattr(bpy.types, "PANORAMA_PT_view")
    area = bpy.context.window_manager.windows[0].screen.areas[0]
    area.type = "VIEW_3D"
    context = SimpleNamespace(scene=bpy.context.scene, space_data=area.spaces.active)
    noted = []
    view_header.PANORAMA_PT_view.draw(SimpleNamespace(layout=Noting(noted)), context)
    assert {"exposure", "opacity", "show_calibration", "show_floor"} < set(noted)
    verbs = [name.split(".")[1] for name in noted if name.startswith("panorama.")]
    assert verbs
    assert set(verbs) <= set(dir(bpy.ops.panorama))
