"""When, where and over which colour the panorama is painted; and that nothing of it stays behind."""

from types import SimpleNamespace

import numpy as np
import pytest


@pytest.fixture
def view_3d(fresh_blend):
    """A scene with a panorama; gives bpy and the 3D View's space."""
    from expanded_panoramas.cycles_integration.blender_images import image_from_array

    bpy = fresh_blend
    bpy.context.scene.panorama_set.image = image_from_array("panorama", np.ones((4, 8, 3), np.float32))
    area = bpy.context.window_manager.windows[0].screen.areas[0]
    area.type = "VIEW_3D"
    return bpy, area.spaces.active


def test_shading_modes(view_3d):
    from expanded_panoramas.ui.background import painting

    bpy, space = view_3d
    shown = {}
    for mode in ("WIREFRAME", "SOLID", "MATERIAL", "RENDERED"):
        space.shading.type = mode
        shown[mode] = painting.is_shown(bpy.context.scene, space)
    assert shown == {"WIREFRAME": True, "SOLID": True, "MATERIAL": True, "RENDERED": False}
    space.shading.type = "SOLID"
    bpy.context.scene.panorama_view.show_background = False
    assert not painting.is_shown(bpy.context.scene, space)


def test_image_of_the_set_or_of_the_place(view_3d):
    from expanded_panoramas.ui.background import painting

    bpy, _ = view_3d
    scene = bpy.context.scene
    image = scene.panorama_set.image
    assert painting.image_of(scene) == image
    scene.panorama_set.image, scene.panorama_place.image = None, image
    assert painting.image_of(scene) == image
    scene.panorama_place.image = None
    assert painting.image_of(scene) is None


def test_an_image_whose_file_is_gone_is_none(view_3d):
    from expanded_panoramas.ui.background import painting

    bpy, _ = view_3d
    missing = bpy.data.images.new("gone", 1, 1)
    missing.source, missing.filepath = "FILE", "//no_such_file.exr"
    bpy.context.scene.panorama_set.image = missing
    assert painting.image_of(bpy.context.scene) is None


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"type": "SOLID"}, [("LESS_EQUAL", "NONE", 1.0)]),
        ({"type": "MATERIAL", "show_xray": True}, [("LESS_EQUAL", "NONE", 1.0)]),
        ({"type": "WIREFRAME", "show_xray": True}, [("NONE", "NONE", 0.3)]),
        (
            {"type": "SOLID", "show_xray": True},
            [("LESS_EQUAL", "NONE", 1.0), ("GREATER", "ADDITIVE_PREMULT", 0.75)],
        ),
    ],
)
def test_passes(changes, expected):
    from expanded_panoramas.ui.background import painting

    shading = SimpleNamespace(**{"show_xray": False, "xray_alpha": 0.25, **changes})
    assert painting.passes(shading, 0.3) == expected


def test_colour_behind_all_objects(view_3d):
    from expanded_panoramas.ui.background.theme import background_of

    bpy, space = view_3d
    scene, themes = bpy.context.scene, bpy.context.preferences.themes
    gradients = themes[0].view_3d.space.gradients
    gradients.background_type, gradients.high_gradient = "SINGLE_COLOR", (0.4, 0.2, 0)
    gradients.gradient = (0, 0.6, 0.2)
    in_theme = background_of(space, scene, themes)
    assert in_theme == pytest.approx((0.132868, 0.033105, 0), abs=1e-5)  # IEC 61966-2-1 of those values
    gradients.background_type = "LINEAR"
    assert background_of(space, scene, themes) == pytest.approx((0.132868, 0.318547, 0.033105), abs=1e-5)
    gradients.background_type = "SINGLE_COLOR"
    themes[0].view_3d.clipping_border_3d = 0, 0.6, 0, 1
    clipped = background_of(space, scene, themes, is_clipped=True)
    assert clipped == pytest.approx((0.132868, 0.318547, 0), abs=1e-5)
    space.shading.type, space.shading.background_type = "SOLID", "VIEWPORT"
    space.shading.background_color = 0.25, 0.5, 0.75
    assert background_of(space, scene, themes) == (0.25, 0.5, 0.75)
    space.shading.background_type = "WORLD"
    assert background_of(space, scene, themes) == in_theme
    scene.world = bpy.data.worlds.new("world")
    scene.world.color = 0.5, 0.25, 0.125
    assert background_of(space, scene, themes) == (0.5, 0.25, 0.125)
    space.shading.type = "MATERIAL"
    assert background_of(space, scene, themes) == in_theme


def test_push_constants_fit_every_graphics_card(fresh_blend):
    from expanded_panoramas.ibl_toolkit.views import View
    from expanded_panoramas.ui.background import shader

    view = View.from_matrices(np.eye(4), np.eye(4), np.eye(3), 1.5, (200, 100))
    values = shader.constants(view, 4.0, 0.5)
    assert 16 * len(values) <= 128
    assert all(len(value) == 4 for value in values.values())
    fourth = {name: value[3] for name, value in values.items()}
    assert fourth == {"eye": 0, "eye_x": 0.01, "eye_y": 0.02, "ray": 4, "ray_x": 0.5, "ray_y": 0, "up": 1.5}


@pytest.mark.parametrize(("tilt_deg", "expected"), [(0, False), (45, False), (89.9, False), (90, True)])
def test_an_orthographic_view_along_the_floor_is_left_alone(fresh_blend, tilt_deg, expected):
    from mathutils import Matrix

    from expanded_panoramas.ibl_toolkit.views import View

    view_matrix = Matrix.Rotation(np.radians(-tilt_deg), 4, "X")
    along = View.from_matrices(np.diag([0.1, 0.1, -0.01, 1]), view_matrix, np.eye(3), 1.5, (200, 100))
    assert along.runs_along_floor == expected
    perspective = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, -0.02], [0, 0, -1, 0]])
    ahead = View.from_matrices(perspective, view_matrix, np.eye(3), 1.5, (200, 100))
    assert not ahead.runs_along_floor


def test_nothing_stays_behind(fresh_blend):
    import expanded_panoramas
    from expanded_panoramas.ui import background
    from expanded_panoramas.ui.background import painting, shader

    header = fresh_blend.types.VIEW3D_HT_header
    drawn = len(header._dyn_ui_initialize())
    assert len(background._handles) == 2
    painting._scene_layer, shader._built = "a framebuffer", ("a shader", "a batch")
    expanded_panoramas.unregister()
    left = len(background._handles), shader.is_built(), painting.forget_scene_layer()
    in_header = len(header._dyn_ui_initialize())
    expanded_panoramas.register()
    assert left == (0, False, None)
    assert in_header == drawn - 1


def test_only_textures_of_what_was_drawn_are_freed(monkeypatch):
    from expanded_panoramas.ui.background import painting

    freed = []
    images = [SimpleNamespace(session_uid=uid, gl_free=lambda uid=uid: freed.append(uid)) for uid in (1, 2)]
    monkeypatch.setattr(painting, "bpy", SimpleNamespace(data=SimpleNamespace(images=images)))
    monkeypatch.setattr(painting, "_textured", {2, 3})
    painting.free_textures()
    painting.free_textures()
    assert freed == [2]
