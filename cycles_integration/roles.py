"""What an object is to the composite: new, real and touched, or real and only lighting (5.6.1)."""

from __future__ import annotations

import bpy

SYNTHETIC, SUPPORT, ENVIRONMENT = "SYNTHETIC", "SUPPORT", "ENVIRONMENT"
LAMP = "panorama_lamp"
"""Custom property of the meshes that stand for the lamps of the photograph: ours, not the artist's."""
ROLES = (
    (SYNTHETIC, "Synthetic", "A new object: lit by the place, it casts shadows on it and reflects it"),
    (
        SUPPORT,
        "Support",
        "A real surface that receives shadows, bounced light and reflections of new objects",
    ),
    (
        ENVIRONMENT,
        "Environment",
        "A real surface that shows the photograph and lights with it, and nothing more",
    ),
)

watchers: list = []
"""Functions of an object, called when its role was changed; an update of the scene does not tell it."""


def real_objects(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return the scene's meshes that stand for real surfaces; the lamps on them are left out."""
    meshes = (o for o in scene.objects if o.type == "MESH" and LAMP not in o)
    return [o for o in meshes if o.panorama_role != SYNTHETIC]


def with_role(scene: bpy.types.Scene, role: str) -> list[bpy.types.Object]:
    """Return the real meshes of one role."""
    return [o for o in real_objects(scene) if o.panorama_role == role]


def refuse_linked_surfaces(scene: bpy.types.Scene):
    """Raise ValueError naming real objects that cannot be given the photograph: they or their meshes are
    linked from another file."""
    linked = [o for o in real_objects(scene) if not (is_editable(o) and is_editable(o.data))]
    if linked:
        names = ", ".join(f"'{thing.name}'" for thing in linked)
        raise ValueError(
            f"{names}: linked from another file, so the photograph cannot be put on: make object and mesh "
            "local (Object > Relations > Make Local), or the object synthetic"
        )


def is_editable(thing: bpy.types.ID) -> bool:
    """Whether a data-block can be changed and keeps the change: it is neither linked nor a mere part of an
    override of something else."""
    override = thing.override_library
    return thing.library is None and not (override and override.is_system_override)


def _role_changed(thing, context):
    for watcher in watchers:
        watcher(thing)


def register():
    """Give every object its role and, for a glossy support, its reflection."""
    bpy.types.Object.panorama_role = bpy.props.EnumProperty(
        name="Role",
        description="What this object is to the composite",
        items=ROLES,
        default=SYNTHETIC,
        update=_role_changed,
        override={"LIBRARY_OVERRIDABLE"},
    )
    bpy.types.Object.panorama_reflectivity = bpy.props.FloatProperty(
        name="Reflectivity",
        description="Share of light that this real surface mirrors, in 0 to 1; the photograph stays as it is",
        subtype="FACTOR",
        min=0,
        max=1,
        override={"LIBRARY_OVERRIDABLE"},
    )
    bpy.types.Object.panorama_roughness = bpy.props.FloatProperty(
        name="Roughness",
        description="Blur of this real surface's reflections: 0 is a mirror, 1 is matte",
        subtype="FACTOR",
        min=0,
        max=1,
        default=0.2,
        override={"LIBRARY_OVERRIDABLE"},
    )


def unregister():
    """Take the properties back."""
    del bpy.types.Object.panorama_roughness
    del bpy.types.Object.panorama_reflectivity
    del bpy.types.Object.panorama_role
