"""Jobs of the sidebar's step of layers: they are made, opened and written by its buttons. Runs in Blender."""

import bpy
import look
from jobs_sidebar import choose_file, import_set
from waiting import Until

LAST_HEADER = 26
"""Height of the last panel, which is closed, at the lower edge of the sidebar that is scrolled down [px]."""
ABOVE = 12
"""Middle of the header of the panel before it, above that [px]."""
PANEL = 297
"""Height of the panel [px]."""
MINUTES = 180
"""A child Blender renders with all that the machine has [s]."""


def view():
    """The 3D view."""
    return look.area("VIEW_3D")


def press(stage, *words):
    """Click a button of the sidebar."""
    yield from look.click_button(stage.hand, look.region(view(), "UI"), *words, columns=(0.3,))
    yield


def open_panel(stage):
    """Scroll down, open the closed panel before the last, scroll down again."""
    sidebar = look.region(view(), "UI")
    yield from stage.hand.move(*look.middle(sidebar))
    yield from stage.hand.wheel("WHEELDOWNMOUSE", 60)
    yield
    yield from stage.hand.click(sidebar.x + 0.4 * sidebar.width, sidebar.y + LAST_HEADER + ABOVE)
    for _ in range(20):  # it unrolls
        yield
    yield from stage.hand.move(*look.middle(sidebar))
    yield from stage.hand.wheel("WHEELDOWNMOUSE", 60)
    yield


def make_open_and_write(stage):
    """The hotel room, rebuilt, in layers; in a scene of their own, seen from within; and as a file."""
    yield from import_set(stage)
    bpy.ops.panorama.calibrate()
    bpy.ops.panorama.build()
    layers = bpy.context.scene.panorama_layers
    stage.note(can_before=can())
    bpy.ops.wm.save_as_mainfile(filepath=str(stage.folder / "room.blend"))
    layers.folder, layers.width = "//layers", 1024
    yield from open_panel(stage)
    yield from press(stage, "panorama.make_layers")
    yield Until(lambda: layers.found, "layers", MINUTES)
    stage.note(found=layers.found, files=sorted(path.suffix for path in (stage.folder / "layers").iterdir()))
    sidebar = look.region(view(), "UI")
    panel = sidebar.x, sidebar.y + LAST_HEADER, sidebar.width, PANEL
    yield from stage.picture("layers_panel", panel)
    yield from press(stage, "panorama.open_layers")
    yield Until(lambda: bpy.context.scene.name == "Layers", "the scene of the layers")
    scene = bpy.context.scene
    stage.note(objects=sorted(thing.name for thing in scene.objects), can_after=can())
    yield from look_beside(stage)
    yield from press(stage, "panorama.export_layers")
    yield from choose_file(stage, stage.folder / "room.glb")
    stage.note(bytes=(stage.folder / "room.glb").stat().st_size)
    yield from undo(stage)


def can():
    """Which of the three buttons can be pressed."""
    return [getattr(bpy.ops.panorama, f"{verb}_layers").poll() for verb in ("make", "open", "export")]


def look_beside(stage):
    """A camera 40 cm beside the origin, and a picture of what it sees in Material Preview."""
    scene = bpy.context.scene
    origin = scene.objects["Layers Origin"]
    camera = bpy.data.objects.new("Beside", bpy.data.cameras.new("Beside"))
    scene.collection.objects.link(camera)
    scene.camera, camera.data.lens, camera.data.show_passepartout = camera, 18, False
    camera.location = origin.location + origin.matrix_world.to_3x3().col[1] * 0.4
    camera.rotation_euler = (1.35, 0, 2.4)
    space = view().spaces.active
    space.shading.type, space.region_3d.view_perspective = "MATERIAL", "CAMERA"
    space.region_3d.view_camera_zoom = 20
    space.overlay.show_overlays = space.show_gizmo = space.show_region_toolbar = False
    for _ in range(60):  # shaders are compiled
        yield
    window, sidebar = look.region(view()), look.region(view(), "UI")
    yield from stage.picture("layers_beside", (window.x, window.y, sidebar.x - window.x, window.height))


def undo(stage):
    """Take the opening back."""
    yield from stage.hand.move(*look.middle(look.region(view())))
    for _ in range(4):
        if bpy.data.scenes.get("Layers") is None:
            break
        yield from stage.hand.key("Z", ctrl=True)
        yield
    stage.note(scenes_after_undo=sorted(scene.name for scene in bpy.data.scenes))


JOBS = (make_open_and_write,)
