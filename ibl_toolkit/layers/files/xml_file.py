"""panorama.xml: what a folder of layers says of itself.

    <?xml version="1.0" encoding="iso-8859-1"?>
    <Panorama version="1">
      <TransformGroup> <Translate … /> <Rotate … /> <Scale … /> </TransformGroup>
      <Mapping type='LatLongMapping' />
      <Freedom radius="0.5" />
      <Layer name="sofa">
        <Textures mapname="sofa.exr" depthname="sofa_d.exr" width="4096" height="2048">
          <Patch map="310 900" atlas="0 0" size="512 260" />
        </Textures>
        <Textures mapname="sofa_1.exr" … />
      </Layer>
    </Panorama>

Source: thesis, section 6.2.1; without `version`, names, widths, patches and further Textures it is the
printed file, which is read as well. A layer's second Textures and those after it are its mip levels.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from ...images.atomic import replacing
from ..errors import LayersError
from ..panorama import CUBE_MAP, EQUIRECTANGULAR
from .atlas import Patch
from .transforms import place_of, transforms_of
from .xml_nodes import Node, read_nodes

NAME = "panorama.xml"
VERSION = 1
MAPPING_NAMES = {EQUIRECTANGULAR: "LatLongMapping", CUBE_MAP: "CubeMapping"}
# Attributes of Textures that name a file, by what the file holds; the first three are printed.
FILE_ATTRIBUTES = {
    "radiance": "mapname",
    "depth": "depthname",
    "normals": "normals",
    "diffuse light": "diffuselight",
    "reflectivity": "reflectivity",
    "material index": "materials",
    "emission": "emission",
    "mask": "mask",
}
_LONGEST_PATH = 255


@dataclass(frozen=True)
class LevelFiles:
    """The files of one layer at one resolution.

    files: names relative to the folder, by what they hold. exposure: what 8-bit colours were multiplied with.
    map_size: (W, H) [px] of the map that `patches` make again, None where the images are the whole maps.
    where: the element, as messages begin.
    """

    files: dict[str, str]
    exposure: float = 1.0
    map_size: tuple[int, int] | None = None
    patches: tuple[Patch, ...] = ()
    where: str = field(default="", compare=False)


@dataclass(frozen=True)
class LayerFiles:
    """One layer and its mip levels, the finest first."""

    name: str
    mapping: str
    levels: tuple[LevelFiles, ...]


@dataclass(frozen=True, eq=False)
class PanoramaFile:
    """What panorama.xml says: as LayeredPanorama, with the layers' files in place of their arrays."""

    layers: tuple[LayerFiles, ...]
    world_from_panorama: np.ndarray
    origin: np.ndarray
    radius: float


def read_xml(path) -> PanoramaFile:
    """Read the panorama.xml at `path`; opens none of the images it names.

    Raises: LayersError naming the file, the element and what would be right: XML that could harm (entities,
    depth, size), files outside of the folder, unknown elements, a newer version. OSError when it cannot be
    opened.
    """
    path = Path(path)
    try:
        return _panorama(read_nodes(path), path.parent)
    except LayersError as error:
        raise LayersError(f"{path}: {error}") from error


def write_xml(path, panorama: PanoramaFile):
    """Write a panorama.xml, all or nothing, in the thesis' encoding; other letters become references."""
    text = "\n".join(_lines(panorama)) + "\n"
    with replacing(path) as temporary:
        Path(temporary).write_bytes(text.encode("iso-8859-1", "xmlcharrefreplace"))


def _panorama(root: Node, folder):
    if root.tag != "Panorama":
        root.fail("the file must begin with Panorama")
    version = root.whole_numbers("version", 1, default="1")[0]
    if version != VERSION:
        newer = ": written by a newer program, update this one" if version > VERSION else ""
        root.fail(f"version is {version}, must be {VERSION}{newer}")
    mapping_node, freedom = root.child("Mapping"), root.child("Freedom")
    mapping = _mapping(mapping_node, "type")
    place = place_of(root.child("TransformGroup"), mapping)
    radius = freedom.number("radius", least=0)
    layers = tuple(_layer(node, k, mapping, folder) for k, node in enumerate(root.children("Layer"), 1))
    for node in (mapping_node, freedom, root):
        node.finish()
    if not layers:
        root.fail("element Layer is missing")
    return PanoramaFile(layers, *place, radius)


def _mapping(node, attribute, default=None):
    names = {name: mapping for mapping, name in MAPPING_NAMES.items()}
    return names[node.choice(attribute, tuple(names), default)]


def _layer(node, number, mapping, folder):
    own = _mapping(node, "mapping", MAPPING_NAMES[mapping])
    levels = tuple(_level(textures, folder) for textures in node.children("Textures"))
    if not levels:
        node.fail("element Textures is missing")
    name = node.text("name", default=f"layer {number}")
    node.finish()
    return LayerFiles(name, own, levels)


def _level(node, folder):
    names = {what: node.text(attribute, default="") for what, attribute in FILE_ATTRIBUTES.items()}
    files = {what: _inside(node, FILE_ATTRIBUTES[what], name, folder) for what, name in names.items() if name}
    if "depth" not in files:
        node.fail("depthname must name a file")
    patches = tuple(_patch(child) for child in node.children("Patch"))
    map_size = None
    if patches or node.has("width") or node.has("height"):
        map_size = tuple(node.whole_numbers(name, 1)[0] for name in ("width", "height"))
        if not patches:
            node.fail("width and height are given without a Patch: the images' own size is the map's")
    exposure = node.number("exposure", above=0, default="1")
    node.finish()
    return LevelFiles(files, exposure, map_size, patches, node.where)


def _patch(node):
    numbers = [value for name in ("map", "atlas", "size") for value in node.whole_numbers(name, 2)]
    node.finish()
    return Patch(*numbers)


def _inside(node, attribute, name, folder):
    """`name`, if it is a relative path in `folder` on every system, links followed."""
    parts = name.split("/")
    plain = name.isprintable() and not re.search(r'[\\:*?"<>|]', name) and len(name) <= _LONGEST_PATH
    if not plain or any(part in ("", ".", "..") for part in parts):
        node.fail(f"{attribute} is {name[:60]!r}, must be the relative path of a file in the folder")
    if not (Path(folder) / name).resolve().is_relative_to(Path(folder).resolve()):
        node.fail(f"{attribute} is {name!r}, which leads out of the folder")
    return name


def _lines(panorama):
    mapping = panorama.layers[0].mapping
    yield '<?xml version="1.0" encoding="iso-8859-1"?>'
    yield f'<Panorama version="{VERSION}">'
    yield "  <TransformGroup> <!-- affine transformation LocalToWorld -->"
    for element in transforms_of(panorama.world_from_panorama, panorama.origin, mapping):
        yield f"    {element}"
    yield "  </TransformGroup>"
    yield f"  <Mapping type='{MAPPING_NAMES[mapping]}' />"
    yield f'  <Freedom radius="{float(panorama.radius)!r}" />'
    for layer in panorama.layers:
        own = "" if layer.mapping == mapping else f' mapping="{MAPPING_NAMES[layer.mapping]}"'
        yield f"  <Layer name={quoteattr(layer.name)}{own}>"
        for level in layer.levels:
            yield from _textures_lines(level)
        yield "  </Layer>"
    yield "</Panorama>"


def _textures_lines(level):
    names = [f"{FILE_ATTRIBUTES[what]}={quoteattr(name)}" for what, name in level.files.items()]
    if level.exposure != 1:
        names.append(f'exposure="{level.exposure!r}"')
    if level.map_size is None:
        yield f"    <Textures {' '.join(names)} />"
        return
    width, height = level.map_size
    yield f'    <Textures {" ".join(names)} width="{width}" height="{height}">'
    for u, v, x, y, w, h in level.patches:
        yield f'      <Patch map="{u} {v}" atlas="{x} {y}" size="{w} {h}" />'
    yield "    </Textures>"
