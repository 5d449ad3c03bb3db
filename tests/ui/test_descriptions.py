"""Every operator and property says what it does, and every number its unit."""

import re

UNIT = re.compile(
    r"\[[^\]]+\]|\b(pixels?|degrees?|seconds|metres|share|paths per pixel|number of|number that|EV)\b|%", re.I
)
PLAIN = {"NONE", "UNSIGNED", "XYZ"}  # subtypes that tell no unit
BLENDERS_OWN = {"rna_type", "name"}


def complaints(bl_rna, skip, seen):
    """What is missing in the properties of a type, and of the property groups in it."""
    for prop in bl_rna.properties:
        if prop.identifier in skip or prop.is_hidden:
            continue
        where = f"{bl_rna.identifier}.{prop.identifier}"
        if not prop.description:
            yield f"{where}: no description"
        if prop.type in ("INT", "FLOAT") and not has_unit(prop):
            yield f"{where}: no unit in {prop.description!r}"
        if prop.type == "ENUM":
            yield from (
                f"{where}: {item.identifier} not described"
                for item in prop.enum_items
                if not item.description
            )
        if (
            prop.type in ("POINTER", "COLLECTION")
            and is_ours(prop.fixed_type)
            and prop.fixed_type not in seen
        ):
            seen.append(prop.fixed_type)
            yield from complaints(prop.fixed_type, BLENDERS_OWN, seen)


def has_unit(prop):
    return prop.unit != "NONE" or prop.subtype not in PLAIN or UNIT.search(prop.description)


def is_ours(bl_rna):
    return bl_rna.identifier.startswith("Panorama") or bl_rna.identifier == "Place"


def of_blender(bpy):
    """Names of the properties that Blender's own file operators bring along."""
    from bl_operators.presets import AddPresetBase
    from bpy_extras.io_utils import ExportHelper, ImportHelper

    helpers = (ImportHelper, ExportHelper, AddPresetBase)
    return {name for helper in helpers for name in helper.__annotations__} | BLENDERS_OWN


def test_operators(fresh_blend):
    found = []
    for name in dir(fresh_blend.ops.panorama):
        rna = getattr(fresh_blend.ops.panorama, name).get_rna_type()
        if len(rna.description) < 20:
            found.append(f"{name}: described as {rna.description!r}")
        if "\n" in rna.description:
            found.append(f"{name}: its tooltip breaks lines where the source does")
        found += complaints(rna, of_blender(fresh_blend), [])
    assert not found, "\n".join(found)


def test_properties(fresh_blend):
    """Those of scenes and objects, with all property groups below them."""
    types = fresh_blend.types
    found, seen = [], []
    for owner in (types.Scene, types.Object, types.WindowManager):
        names = {prop.identifier for prop in owner.bl_rna.properties}
        ours = {name for name in names if name.startswith("panorama")}
        assert ours or owner is types.WindowManager
        found += complaints(owner.bl_rna, names - ours, seen)
    assert {"PanoramaSetState", "PanoramaJob", "PanoramaPoint", "Place"} <= {rna.identifier for rna in seen}
    assert not found, "\n".join(found)


def test_panels_and_menus_have_labels(fresh_blend):
    names = [name for name in dir(fresh_blend.types) if re.match(r"PANORAMA_(PT|MT|FH)_", name)]
    assert len(names) > 10
    assert not [name for name in names if not getattr(fresh_blend.types, name).bl_label]


def test_a_number_without_a_unit_is_found(fresh_blend):
    """The test itself can fail."""
    bpy = fresh_blend

    class PanoramaBare(bpy.types.PropertyGroup):
        bare: bpy.props.FloatProperty(description="How much of it")
        mute: bpy.props.BoolProperty()
        told: bpy.props.FloatProperty(description="Width [pixels]")
        length: bpy.props.FloatProperty(description="Width", unit="LENGTH")

    bpy.utils.register_class(PanoramaBare)
    try:
        found = list(complaints(PanoramaBare.bl_rna, BLENDERS_OWN, []))
    finally:
        bpy.utils.unregister_class(PanoramaBare)
    assert [text.split(":")[0] for text in found] == ["PanoramaBare.bare", "PanoramaBare.mute"]
