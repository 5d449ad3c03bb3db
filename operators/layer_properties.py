"""Where a scene's layers lie, and how they are made; saved in the .blend, beside the set."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..ibl_toolkit.layers.errors import LayersError
from ..ibl_toolkit.layers.files.xml_file import NAME, read_xml


def _folder_changed(layers, context):
    look_into_folder(layers)


class PanoramaLayers(bpy.types.PropertyGroup):
    """The folder of a panorama in layers, and how the next one is made."""

    folder: StringProperty(
        name="Folder",
        description="Folder of the panorama in layers: where it is made, and from where it is opened",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
        update=_folder_changed,
    )
    radius: FloatProperty(
        name="Radius",
        description="How far from the point of capture views will be: a larger one takes more of what is "
        "hidden. 0: half the distance of what is nearest",
        min=0,
        soft_max=5,
        step=1,
        precision=3,
        unit="LENGTH",
    )
    width: IntProperty(
        name="Width",
        description="Width of the layers' maps [pixels]; the height is half of it. Twice as wide takes four "
        "times as long",
        default=2048,
        min=8,
        soft_max=8192,
        step=2,
    )
    most: IntProperty(
        name="Layers",
        description="Largest number of surfaces along a ray: each shows what hides behind the one before. "
        "Fewer are made where nothing more would come into sight; backs of objects come in further layers. "
        "For an RGB-D panorama, of layers: with too few, depth jumps within the last",
        default=4,
        min=1,
        soft_max=8,
    )
    infinity: BoolProperty(
        name="Infinity Apart",
        description="What moves by less than a pixel within the radius becomes a layer at infinity, which "
        "has no parallax",
    )
    geometry: BoolProperty(
        name="Floor and Walls Apart",
        description="Large layers become layers of their floor, ceiling, walls, lights and the rest: each "
        "an object when opened",
    )
    found: StringProperty(description="What the folder holds; empty where that are no layers")
    problem: StringProperty(description="Why what is in the folder cannot be used")


def folder_of(layers: PanoramaLayers) -> Path:
    """The folder, absolute. Raises ValueError without one, or where it is relative to a file not saved
    yet."""
    if not layers.folder:
        raise ValueError("choose a folder for the layers first")
    if layers.folder.startswith("//") and not bpy.data.filepath:
        raise ValueError(
            f"{layers.folder}: is relative to the .blend: save that first, or choose another one"
        )
    return Path(bpy.path.abspath(layers.folder))


def look_into_folder(layers: PanoramaLayers):
    """Keep what the folder holds, or why it cannot be used."""
    layers.found = layers.problem = ""
    try:
        path = folder_of(layers) / NAME
        if path.is_file():
            panorama = read_xml(path)
            names = ", ".join(layer.name for layer in panorama.layers)
            layers.found = f"{names}; radius {panorama.radius:.3g} m"
    except (LayersError, OSError) as error:
        layers.problem = str(error)
    except ValueError:  # no folder yet
        return


def register():
    """Give every scene its layers."""
    bpy.utils.register_class(PanoramaLayers)
    bpy.types.Scene.panorama_layers = PointerProperty(
        type=PanoramaLayers, description="The scene's panorama in layers"
    )


def unregister():
    """Take them back."""
    del bpy.types.Scene.panorama_layers
    bpy.utils.unregister_class(PanoramaLayers)
