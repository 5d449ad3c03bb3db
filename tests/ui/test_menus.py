"""Entries in Blender's own menus: they are there, name operators that exist, and go again."""

from types import SimpleNamespace


class Layout:
    """Notes the menus and operators that an entry names, and refuses those that do not exist."""

    operator_context = "EXEC_REGION_WIN"  # as Blender's own entries leave it

    def __init__(self, bpy):
        self.bpy, self.named = bpy, []

    def separator(self):
        pass

    def menu(self, name, icon="NONE"):
        assert hasattr(self.bpy.types, name)
        self.named.append(name)

    def operator(self, name, text="", icon="NONE"):
        assert self.operator_context == "INVOKE_REGION_WIN"  # the mouse says where
        assert name.partition(".")[2] in dir(self.bpy.ops.panorama), name
        icons = self.bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        assert icon in icons, icon
        self.named.append(name)
        return SimpleNamespace()


def draw_entry(bpy, draw):
    """The menus and operators that an entry names."""
    layout = Layout(bpy)
    draw(SimpleNamespace(layout=layout), bpy.context)
    return layout.named


def entries_of(bpy):
    """How many of our functions Blender's menus call."""
    menus = (bpy.types.VIEW3D_MT_add, bpy.types.VIEW3D_MT_object_context_menu)
    functions = [function for menu in menus for function in getattr(menu.draw, "_draw_funcs", ())]
    return [function.__name__ for function in functions if "expanded_panoramas" in function.__module__]


def test_the_add_menu_offers_what_a_place_needs(fresh_blend):
    from expanded_panoramas.ui import menus

    assert draw_entry(fresh_blend, menus.draw_in_add_menu) == ["PANORAMA_MT_add"]
    named = draw_entry(fresh_blend, menus.PANORAMA_MT_add.draw)
    assert set(named) == {
        "panorama.add_ball", "panorama.add_camera", "panorama.camera_from_view", "panorama.add_sun",
        "panorama.pick_sun", "panorama.add_sun_by_time", "panorama.lights_of_probe", "panorama.load_sample",
    }  # fmt: skip


def test_objects_can_be_sent_once_there_is_a_place(fresh_blend):
    from expanded_panoramas.ui import menus

    bpy = fresh_blend
    assert draw_entry(bpy, menus.draw_in_object_menu) == []
    bpy.ops.panorama.load_sample()
    bpy.ops.panorama.calibrate()
    assert draw_entry(bpy, menus.draw_in_object_menu) == ["panorama.send_to_place"]


def test_entries_come_once_and_go(fresh_blend):
    import expanded_panoramas

    assert sorted(entries_of(fresh_blend)) == ["draw_in_add_menu", "draw_in_object_menu"]
    expanded_panoramas.unregister()
    assert entries_of(fresh_blend) == []
    expanded_panoramas.register()
    assert len(entries_of(fresh_blend)) == 2
