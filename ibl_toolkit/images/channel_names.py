"""Which channels of an OpenEXR file are the picture's colour."""

from .errors import ImageError
from .exr_header import UINT

_COLOUR = {"r": 0, "red": 0, "g": 1, "green": 1, "b": 2, "blue": 2}
_LUMINANCE = ("y", "l", "luminance")
_NOT_LUMINANCE_BESIDE = {"ry", "by", "x"}  # chroma coded apart, or Y as a coordinate
# What renderers call the layer that is the picture, where they name it.
_PICTURE_LAYERS = ("combined", "beauty", "rgb", "rgba", "color", "colour", "default")


def colour_channels(parts, path):
    """Index of the part that holds the picture, and the names of its R, G and B (or of its luminance).

    Any case, `R` or `red`, with or without a layer before the last dot.  A nameless layer goes before
    named ones, an earlier part before a later one, and colour before luminance.

    Raises: ImageError if there is none, or if it could be any of several layers.
    """
    candidates = [
        (index, layer, names)
        for index, part in enumerate(parts)
        for layer, names in _colour_layers([channel.name for channel in part.channels]).items()
    ]
    found = ", ".join(channel.name for part in parts for channel in part.channels) or "none"
    if not candidates:
        raise ImageError(f"{path}: channels R G B (or Y alone) are needed, found {found}")
    for preferred in ("", *_PICTURE_LAYERS):
        for index, layer, names in candidates:
            if layer.rpartition(".")[2].lower() == preferred:
                return index, _usable(parts[index], names, path)
    if len({layer for _, layer, _ in candidates}) > 1:
        layers = ", ".join(layer for _, layer, _ in candidates)
        raise ImageError(f"{path}: which of the layers {layers} is the picture? One of them must be R G B")
    index, _, names = candidates[0]
    return index, _usable(parts[index], names, path)


def channel_named(part, name):
    """The channel of a part whose name, less its layer, is `name` in any case; None without one.

    A channel without a layer goes first.
    """
    matching = [c for c in part.channels if c.name.rpartition(".")[2].lower() == name.lower()]
    return min(matching, key=lambda channel: channel.name.count("."), default=None)


def _colour_layers(channel_names):
    """Layer name -> its R, G, B channels, or its one luminance channel; only layers that have either."""
    layers = {}
    for name in channel_names:
        layer, _, last = name.rpartition(".")
        layers.setdefault(layer, {})[last.lower()] = name
    colours = {layer: _colour(channels) for layer, channels in layers.items()}
    complete = {layer: names for layer, names in colours.items() if len(names) == 3}
    return complete or {layer: names for layer, names in colours.items() if names}


def _colour(channels):
    colour = {_COLOUR[last]: name for last, name in channels.items() if last in _COLOUR}
    if len(colour) == 3:
        return tuple(colour[k] for k in range(3))
    if colour or _NOT_LUMINANCE_BESIDE & channels.keys():
        return ()
    return tuple(channels[name] for name in _LUMINANCE if name in channels)[:1]


def _usable(part, names, path):
    for channel in part.channels:
        if channel.name not in names:
            continue
        if channel.sampling != (1, 1):
            raise ImageError(
                f"{path}: channel {channel.name} is subsampled {channel.sampling}, must be (1, 1)"
            )
        if channel.pixel_type == UINT:
            raise ImageError(f"{path}: channel {channel.name} is of type uint, must be half or float")
    return names
