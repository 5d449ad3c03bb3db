"""One comparison with one texel: Williams's shadow map, and that of cards without shaders."""

from .lookup import nearest
from .storage import packed, unpacked


def texels(depth, camera, settings):
    """The map as the device holds it."""
    return packed(depth[..., None], settings.storage)


def visibility(shadow_map, texture):
    """Of places (n, 3), s, t, r: 1 where r ≤ the depth that is stored, else 0 (GL_LEQUAL)."""
    stored = unpacked(nearest(shadow_map.texels, texture[:, :2]), shadow_map.settings.storage)
    return (texture[:, 2] <= stored[:, 0]).astype(float)
