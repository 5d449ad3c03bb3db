"""Light directions from a photograph of a ball, mirror or matt, with a marker or without; or of a shadow."""

from .ball import Ball, ball_from_ellipse, ball_from_rays
from .camera import PhotoCamera
from .errors import ProbeError
from .estimate import DOMAINS, KINDS, MOST, Estimate, estimate_lights
from .lights import ProbeLight
from .marker import DICTIONARY, MarkerPose, dictionary_names, find_marker
from .photo import Photo, read_photo
from .placing import PlacedBall, place_ball
from .shadow import ShadowLight, light_from_shadow
from .unwrap import PANORAMA_FROM_CAMERA, Unwrapped, natural_width, unwrap, write_unwrapped

__all__ = [
    "DICTIONARY",
    "DOMAINS",
    "KINDS",
    "MOST",
    "PANORAMA_FROM_CAMERA",
    "Ball",
    "Estimate",
    "MarkerPose",
    "Photo",
    "PhotoCamera",
    "PlacedBall",
    "ProbeError",
    "ProbeLight",
    "ShadowLight",
    "Unwrapped",
    "ball_from_ellipse",
    "ball_from_rays",
    "dictionary_names",
    "estimate_lights",
    "find_marker",
    "light_from_shadow",
    "natural_width",
    "place_ball",
    "read_photo",
    "unwrap",
    "write_unwrapped",
]
