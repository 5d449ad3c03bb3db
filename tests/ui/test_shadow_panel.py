"""Step 8's panel: a row for each light, and what adds more of them."""

import shadow_pictures

from expanded_panoramas.ui.shadow_panel import PANORAMA_PT_device_shadows


class Layout:
    """Notes what a panel draws: properties by name, operators by name, labels by text."""

    def __init__(self, drawn):
        self.drawn = drawn

    def row(self, align=False):
        return Layout(self.drawn)

    column = row

    def label(self, text="", icon="NONE"):
        self.drawn.append(text)

    def prop(self, owner, name, **keywords):
        assert hasattr(owner, name)
        self.drawn.append(name)

    def operator(self, name, **keywords):
        self.drawn.append(name)
        return type("Properties", (), {})()


def drawn(bpy):
    panel = PANORAMA_PT_device_shadows
    own = type("Panel", (), {"say": panel.say, "draw": panel.draw, "_draw_lights": panel._draw_lights})()
    own.layout = Layout([])
    own.draw(bpy.context)
    return own.layout.drawn


def test_one_light_takes_one_click_and_four_are_the_most(fresh_blend):
    bpy = fresh_blend
    shadow_pictures.still_life()
    assert "light" not in drawn(bpy)
    shadow_pictures.add_light("POINT")
    sun = shadow_pictures.add_light("SUN")
    assert "None chosen, so 'SUN'" in drawn(bpy)
    for thing in bpy.context.scene.objects:
        thing.select_set(thing.type in {"MESH", "LIGHT"})
    assert "None chosen, so 'POINT', 'SUN'" in drawn(bpy)
    preview = bpy.context.scene.panorama_shadow_preview
    preview.another = sun
    shown = drawn(bpy)
    assert (shown.count("light"), shown.count("panorama.remove_shadow_light")) == (1, 1)
    assert not [text for text in shown if text.startswith("None chosen")]
    assert shown.count("panorama.add_shadow_lights") == 2
    for _ in range(3):
        preview.lights.add().light = sun
    shown = drawn(bpy)
    assert shown.count("light") == 4
    assert not {"another", "panorama.add_shadow_lights"} & set(shown)
