"""What keeps a scene's shadow preview current when its lights, the objects or the settings change.

A change only marks the scene; a timer then makes the maps, once for all changes since the last, with a pause
as long as that took, so that the views stay free. A frame change makes it at once, for renders.
"""

from __future__ import annotations

import time

import bpy
from bpy.app.handlers import persistent

from ..cycles_integration import roles
from ..cycles_integration.shadow_preview import (
    KINDS,
    composite_nodes,
    drawn_things,
    is_in,
    is_there,
    nodes_of,
    renew,
    settle_shadows,
)

SHORTEST_PAUSE = 0.1
"""Between two maps [s]."""
_marked: set[str] = set()
"""Names of scenes whose maps are out of date."""
_drawn: dict[str, frozenset] = {}
"""Scene → what was drawn into its maps."""


def mark(scene: bpy.types.Scene):
    """Have the map made anew soon, if the scene has a preview that is kept current."""
    if is_kept(scene):
        _marked.add(scene.name)
        if not bpy.app.timers.is_registered(_at_rest):
            bpy.app.timers.register(_at_rest, first_interval=SHORTEST_PAUSE)


def is_kept(scene: bpy.types.Scene) -> bool:
    """Whether the scene has a preview, and the switch is on."""
    preview = scene.panorama_shadow_preview
    return is_there(preview) and preview.keep_current and scene.library is None


def is_waiting() -> bool:
    """Whether a map is out of date."""
    return bool(_marked)


def refresh(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph):
    """Make the maps anew and keep what they cannot show; where that fails, the last stay and it is said."""
    preview = scene.panorama_shadow_preview
    _marked.discard(scene.name)
    _drawn[scene.name] = drawn_things(scene)
    settle_shadows(preview)  # a light may be gone
    try:
        preview.problem = "; ".join(renew(preview, depsgraph))
    except ValueError as error:
        preview.problem = str(error)


def work_off():
    """Make the maps that are out of date of the scenes that are shown."""
    _marked.intersection_update([scene.name for scene in bpy.data.scenes if is_kept(scene)])
    shown = _shown()
    for name in [name for name in _marked if name in shown]:
        shown[name].update()
        refresh(bpy.data.scenes[name], shown[name].depsgraph or bpy.context.evaluated_depsgraph_get())


def settings_changed(preview, context):
    """A setting was changed: of the map, or of what shows it."""
    mark(preview.id_data)


def looks_changed(preview, context):
    """How dark shadows are, and whose they are: no new map."""
    if not is_there(preview):
        return
    nodes = [node for material in bpy.data.materials for node in nodes_of(material, preview.group)]
    for node in nodes + composite_nodes(preview.id_data, preview.composite_group):
        node.inputs["Darkness"].default_value = preview.darkness
    settle_shadows(preview)


def light_changed(preview, context):
    """Another light was chosen, or one less."""
    looks_changed(preview, context)
    mark(preview.id_data)


def _at_rest():
    start = time.monotonic()
    work_off()
    if _marked.isdisjoint(_shown()):  # a scene that is not shown waits for its next update
        return None
    return max(SHORTEST_PAUSE, time.monotonic() - start)


def _shown():
    """Name → view layer of the scenes that are shown."""
    shown = {window.scene.name: window.view_layer for window in bpy.context.window_manager.windows}
    shown.setdefault(bpy.context.scene.name, bpy.context.view_layer)
    return shown


def _is_changed(scene, depsgraph) -> bool:
    """Whether updates may be of the map; they do not say what began or ceased to be in it."""
    if any(_concerns(update) for update in depsgraph.updates):
        return True
    looks = any(isinstance(one.id, bpy.types.Object) and one.is_updated_shading for one in depsgraph.updates)
    return looks and _drawn.get(scene.name) != drawn_things(scene)


def _role_changed(thing):
    for scene in bpy.data.scenes:
        if is_kept(scene) and is_in(thing, scene):
            mark(scene)


def _concerns(update) -> bool:
    """Whether a change may be one of the map: where things stand, what they are, which are there."""
    thing = update.id
    if isinstance(thing, bpy.types.Object):
        return (thing.type == "LIGHT" or thing.type in KINDS or thing.type == "EMPTY") and (
            update.is_updated_transform or update.is_updated_geometry
        )
    return isinstance(thing, bpy.types.Collection | bpy.types.Light)


@persistent
def _on_change(scene, depsgraph):
    preview = scene.panorama_shadow_preview
    if preview.switched_off and not is_there(preview) and scene.library is None:
        settle_shadows(preview)  # its groups were deleted by hand
    if is_kept(scene) and (scene.name in _marked or _is_changed(scene, depsgraph)):
        mark(scene)


@persistent
def _on_frame(scene, depsgraph):
    if not is_kept(scene) or not _is_changed(scene, depsgraph):
        return
    if any(window.screen.is_animation_playing for window in bpy.context.window_manager.windows):
        mark(scene)
    else:
        refresh(scene, depsgraph)


@persistent
def _on_other_file(*_):
    _marked.clear()
    _drawn.clear()
    for scene in bpy.data.scenes:
        mark(scene)


@persistent
def _before_render(*_):
    if _marked:
        work_off()


HANDLERS = (
    ("depsgraph_update_post", _on_change),
    ("frame_change_post", _on_frame),
    ("load_post", _on_other_file),
    ("undo_post", _on_other_file),
    ("redo_post", _on_other_file),
    ("render_init", _before_render),
)


def register():
    """Begin to watch."""
    roles.watchers.append(_role_changed)
    for name, handler in HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister():
    """Leave no handler, watcher and timer."""
    roles.watchers.remove(_role_changed)
    for name, handler in HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    if bpy.app.timers.is_registered(_at_rest):
        bpy.app.timers.unregister(_at_rest)
    _marked.clear()
    _drawn.clear()
