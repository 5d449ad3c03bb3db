"""A folder of layers: panorama.xml and the images it names.

Source: thesis, sections 6.2.1 and 6.2.3; the images are OpenEXR, which the thesis leaves to future work.
"""

from __future__ import annotations

import contextlib
import itertools
import re
from pathlib import Path

import numpy as np

from ...images import DEFAULT_MAX_BYTES, PhotoSphere
from ..errors import LayersError
from ..panorama import CHANNELS, EQUIRECTANGULAR, Layer, LayeredPanorama
from .atlas import Atlas, atlas_of
from .images import read_image, suffix_of, write_image
from .mip import mip_levels
from .xml_file import NAME, LayerFiles, LevelFiles, PanoramaFile, read_xml, write_xml

# An atlas that saves less than this share of the map's area isn't worth its table.
_WORTH_SHARE = 0.1
_OURS = re.compile(r"[0-9]+([_-][A-Za-z0-9_-]*)?\.(exr|png)")
_ENDINGS = {
    "radiance": "",
    "depth": "_d",
    "normals": "_n",
    "diffuse light": "_light",
    "reflectivity": "_reflectivity",
    "material index": "_materials",
    "emission": "_emission",
    "mask": "_mask",
}


def write_layers(panorama: LayeredPanorama, folder, *, levels=1, ldr=False, exposure=1.0) -> Path:
    """Write a panorama into `folder`, made if need be -> the path of its panorama.xml.

    levels: resolutions of each layer, halved each time. ldr: colours as 8-bit PNG, multiplied with
    `exposure` and clipped; what is a whole equirectangular map tells photo-sphere viewers so. What attributes
    hold outside of the domain is not kept.

    The images get names that are not taken, then panorama.xml is replaced in one step, then the images of
    the panorama before are deleted: whatever happens, the old panorama or the new one is there.

    Raises: ValueError for an exposure that is not finite and above 0, and for NaN or infinity in the domain
    of an attribute other than depth; OSError.
    """
    if not 0 < exposure < np.inf:
        raise ValueError(f"exposure {exposure} must be finite and above 0")
    for layer in panorama.layers:
        _refuse_not_finite(layer)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    before, written, complete = _files_named_by(folder / NAME), [], False
    try:
        layers = tuple(
            _written_layer(
                layer, folder, stem, levels, exposure if ldr else None, written, panorama.world_from_panorama
            )
            for layer, stem in zip(panorama.layers, _stems(panorama, folder), strict=True)
        )
        place = panorama.world_from_panorama, panorama.origin, panorama.radius
        write_xml(folder / NAME, PanoramaFile(layers, *place))
        complete = True
    finally:
        is_new = complete or not _files_named_by(folder / NAME).isdisjoint(written)
        for name in before if is_new else written:
            (folder / name).unlink(missing_ok=True)
    return folder / NAME


def read_layers(folder, *, level=0, max_bytes=DEFAULT_MAX_BYTES) -> LayeredPanorama:
    """The panorama in `folder`, or whose panorama.xml `folder` is.

    level: 0 for the finest resolution; a layer with fewer levels gives its coarsest.
    max_bytes: limit to all layers together once decoded, judged before each is.

    Raises: LayersError naming file, element and what would be right; OSError when one cannot be opened.

    >>> import tempfile
    >>> wall = Layer("wall", "equirectangular", {"depth": np.full((2, 4), 3.0, np.float32)})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = write_layers(LayeredPanorama((wall,), np.eye(3), np.zeros(3), 0.5), folder)
    ...     float(read_layers(folder).layers[0].depth.max())
    3.0
    """
    path = Path(folder) / NAME if Path(folder).is_dir() else Path(folder)
    described = read_xml(path)
    layers, left = [], max_bytes
    for files in described.layers:
        chosen = files.levels[min(level, len(files.levels) - 1)]
        try:
            layer = _read_layer(files, chosen, path.parent, left)
        except (ValueError, FileNotFoundError) as error:
            raise LayersError(f"{path}: {chosen.where}: {error}") from error
        left -= sum(values.nbytes for values in layer.attributes.values())
        layers.append(layer)
    try:
        return LayeredPanorama(
            tuple(layers), described.world_from_panorama, described.origin, described.radius
        )
    except ValueError as error:
        raise LayersError(f"{path}: {error}") from error


def _written_layer(layer, folder, stem, levels, exposure, written, world_from_panorama):
    """LayerFiles of a layer after its images are written; their names go to `written` first."""
    described = []
    for number, level in enumerate(mip_levels(layer, levels)):
        atlas = atlas_of(level.mask, level.mapping)
        whole = atlas.share > 1 - _WORTH_SHARE
        files = {}
        for attribute, values in level.attributes.items():
            ending = f"{_ENDINGS[attribute]}{f'_{number}' if number else ''}"
            files[attribute] = f"{stem}{ending}{suffix_of(attribute, exposure is not None)}"
            written.append(files[attribute])
            inside = _only_inside(attribute, values, level.mask)
            stored = inside if whole else atlas.packed(inside, _outside(attribute))
            sphere = None
            if whole and attribute == "radiance" and level.mapping == EQUIRECTANGULAR:
                sphere = PhotoSphere.whole(*level.size, world_from_panorama)
            write_image(folder / files[attribute], attribute, stored, exposure or 1.0, sphere)
        table = () if whole else (atlas.map_size, atlas.patches)
        described.append(LevelFiles(files, exposure or 1.0, *table))
    return LayerFiles(layer.name, layer.mapping, tuple(described))


def _read_layer(files, level, folder, left):
    """Layer of one LevelFiles; `left`: bytes it may have."""
    attributes = {}
    for attribute, name in level.files.items():
        if not (folder / name).is_file():
            raise LayersError(f"{attribute}: the file {name} is missing")
        image = read_image(folder / name, attribute, level.exposure, left)
        values = _unpacked(attribute, image, level, files.mapping, left)
        left -= values.nbytes
        attributes[attribute] = values
    layer = Layer(files.name, files.mapping, attributes)
    _refuse_not_finite(layer)
    return layer


def _unpacked(attribute, image, level, mapping, left):
    if level.map_size is None:
        return image
    width, height = level.map_size
    needed = width * height * CHANNELS[attribute] * image.itemsize
    if needed > left:
        raise LayersError(
            f"{attribute} of {width} x {height} px needs {needed / 2**30:.3g} GiB of memory, "
            f"{left / 2**30:.3g} GiB are left of the limit"
        )
    atlas = Atlas(level.map_size, (image.shape[1], image.shape[0]), mapping, level.patches)
    return atlas.unpacked(image, _outside(attribute))


def _only_inside(attribute, values, mask):
    if attribute == "mask":
        return values
    return np.where(
        mask if values.ndim == 2 else mask[..., None], values, values.dtype.type(_outside(attribute))
    )


def _outside(attribute):
    """The special value of eq. 6.14."""
    return np.nan if attribute == "depth" else 0


def _refuse_not_finite(layer):
    mask = layer.mask
    for name, values in layer.attributes.items():
        if name == "depth" or values.dtype.kind != "f":
            continue
        bad = ~np.isfinite(values)
        bad = (bad.any(axis=-1) if bad.ndim == 3 else bad) & mask
        if bad.any():
            row, column = (int(k) for k in np.unravel_index(np.argmax(bad), bad.shape))
            raise ValueError(
                f"{layer}: {name} is NaN or infinite in {np.count_nonzero(bad)} pixels of its domain, the "
                f"first at ({column}, {row})"
            )


def _files_named_by(path):
    """The images that a panorama.xml names and `write_layers` wrote: by their names, so no one else's."""
    with contextlib.suppress(LayersError, OSError):
        levels = [level for layer in read_xml(path).layers for level in layer.levels]
        return {name for level in levels for name in level.files.values() if _OURS.fullmatch(name)}
    return set()


def _stems(panorama, folder):
    """What each layer's files begin with: its number and, in plain letters, its name.

    All get one more number if that is what it takes not to meet a file that is there, whatever the case of
    its letters: to some file systems that is no difference.
    """
    plain = [re.sub(r"[^A-Za-z0-9-]+", "_", layer.name)[:60].strip("_") for layer in panorama.layers]
    stems = [f"{k}_{name}".strip("_") for k, name in enumerate(plain)]
    taken = [path.name.lower() for path in folder.iterdir()]
    for number in itertools.count(1):
        found = stems if number == 1 else [f"{stem}-{number}" for stem in stems]
        ours = tuple(f"{stem.lower()}{end}" for stem in found for end in "_.")
        if not any(name.startswith(ours) for name in taken):
            return found
