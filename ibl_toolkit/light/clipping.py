"""A sun or lamp that the capture clipped: found by its plateau, and given back the light it lacks.

Above what the shortest exposure could hold, all pixels got one value. So the light's own pixels are the
brightest of the map, and alike; how much brighter they were is not in the map, and has to come from what an
artist knows: the light's irradiance, or how much brighter the ground is in it than in its shadow.
"""

from dataclasses import dataclass

import numpy as np

from .. import equirectangular
from .light_map import LUMINANCE, check_light_map, irradiance, strips
from .regions import connected_regions

PLATEAU = 1e-3
"""Pixels within this part of the highest value count as equal to it: the rounding of half floats."""
LEAST_PIXELS = 4
"""Fewer connected pixels on a plateau come about by chance."""
LEAST_CONTRAST = 2.0
"""A plateau is this many times as bright as the mean of the rest, or it is no light."""
LARGEST = 2 * np.pi
"""What is wider [sr] is what the map shows, and no light in it."""


@dataclass(frozen=True)
class Clipping:
    """The connected pixels that share the map's highest value; all of it 0 or False where there are none."""

    is_clipped: bool
    """A suspicion: a lamp rendered with one radiance looks the same."""
    level: np.ndarray
    """(3,) radiance of the plateau, RGB."""
    solid_angle: float
    """Of the plateau [sr]."""
    direction: np.ndarray
    """(3,) unit vector to its middle, panorama frame."""
    mask: np.ndarray
    """(H, W) bool: its pixels."""

    @property
    def irradiance(self):
        """(3,) that the plateau brings to a surface that faces it."""
        return self.level * self.solid_angle


def find_clipping(image: np.ndarray) -> Clipping:
    """The largest plateau at the highest value of a light map (H, W, 3).

    The value is that of a pixel's largest channel: one clipped channel is enough, and a white balance that
    gave each channel a ceiling of its own does no harm.

    Raises: ValueError for what `check_light_map` refuses.

    >>> image = np.full((32, 64, 3), 0.5, np.float32)
    >>> image[8:10, 20:23] = 16
    >>> found = find_clipping(image)
    >>> found.is_clipped, int(found.mask.sum()), found.level.round(6).tolist()
    (True, 6, [16.0, 16.0, 16.0])
    """
    image = check_light_map(image)
    height, width = image.shape[:2]
    solid_angles = equirectangular.row_solid_angles(width, height)
    plateau = _plateau(image)
    mask = _largest_part(plateau, solid_angles)
    light, solid_angle = _sums(image, mask, solid_angles)
    light_of_all, solid_angle_of_all = _sums(image, plateau, solid_angles)
    around = (irradiance(image) - light_of_all) / max(4 * np.pi - solid_angle_of_all, solid_angles.min())
    level = light / solid_angle
    is_light = LUMINANCE @ level > LEAST_CONTRAST * (LUMINANCE @ around) and solid_angle < LARGEST
    if np.count_nonzero(mask) < LEAST_PIXELS or not is_light:
        return Clipping(False, np.zeros(3), 0.0, np.zeros(3), np.zeros_like(mask))
    return Clipping(True, level, solid_angle, _middle(mask, solid_angles), mask)


def _plateau(image):
    """(H, W) bool: pixels whose largest channel has the map's highest value."""
    least = (1 - PLATEAU) * image.max()
    plateau = np.zeros(image.shape[:2], bool)
    for rows in strips(len(image)):
        if image[rows].max() >= least:  # few strips have it
            plateau[rows] = (image[rows] >= least).any(axis=2)
    return plateau


def _sums(image, mask, solid_angles):
    """Irradiance (3,) and solid angle of the pixels of a mask."""
    rows = np.flatnonzero(mask.any(axis=1))
    light = sum(solid_angles[row] * image[row][mask[row]].sum(axis=0, dtype=np.float64) for row in rows)
    return light, float(np.count_nonzero(mask[rows], axis=1) @ solid_angles[rows])


def restored(image: np.ndarray, clipping: Clipping, true_irradiance) -> np.ndarray:
    """A copy of the map (H, W, 3) whose plateau brings `true_irradiance`: (3,) RGB, or its luminance.

    Irradiance is that of a surface that faces the light, in the map's radiance times sr, all of the light's
    pixels together. Each channel is raised by one radiance; a luminance raises all by one factor.

    Raises: ValueError without a plateau, or where less light is asked for than is there.

    >>> image = np.full((32, 64, 3), 0.5, np.float32)
    >>> image[8:10, 20:23] = 16
    >>> found = find_clipping(image)
    >>> irradiance(restored(image, found, (9, 8, 7)), found.mask).round(5)
    array([9., 8., 7.])
    """
    _refuse_unclipped(clipping)
    wanted = np.asarray(true_irradiance, dtype=np.float64)
    there = clipping.irradiance
    if wanted.shape not in ((), (3,)) or not np.isfinite(wanted).all():
        raise ValueError(f"irradiance is {true_irradiance}: must be one finite number, or three, RGB")
    least = LUMINANCE @ there if wanted.ndim == 0 else there
    if (wanted < (1 - PLATEAU) * least).any():
        raise ValueError(
            f"irradiance is {np.round(wanted, 6).tolist()}: the clipped light brings "
            f"{np.round(least, 6).tolist()} already, and cannot have brought less"
        )
    result = image.astype(np.float32, copy=True)
    if wanted.ndim == 0:
        result[clipping.mask] *= np.float32(wanted / least)
    else:  # no factor would do for a channel that is 0
        missing = np.maximum(wanted - there, 0) / clipping.solid_angle
        result[clipping.mask] += missing.astype(np.float32)
    return result


def irradiance_from_shadow(image: np.ndarray, clipping: Clipping, lit_over_shadow, normal=(0, 0, 1)):
    """The clipped light's irradiance (3,), from a diffuse surface's radiance in it over that in its shadow.

    lit_over_shadow: (3,) RGB or one number, of two near points of the same surface, as the photograph shows
    them: its albedo cancels out. normal: of the surface, in the panorama frame; the floor's is +z.

    With E_sky what the rest of the map brings to that surface and θ the light's angle to its normal,
    lit / shadow = (E cos θ + E_sky) / E_sky, hence E = (lit / shadow − 1) E_sky / cos θ. The shadow is taken
    to be open to all the rest of the map; what else is blocked there makes E too large.

    Raises: ValueError without a plateau, for a ratio not above 1, or a light behind the surface.

    >>> image = np.full((32, 64, 3), 0.5, np.float32)
    >>> image[0:2] = 16
    >>> found = find_clipping(image)
    >>> irradiance_from_shadow(image, found, 5).round(1)  # 4 times the sky's, a little below π/2
    array([6.1, 6.1, 6.1])
    """
    _refuse_unclipped(clipping)
    ratio = np.asarray(lit_over_shadow, dtype=np.float64)
    if ratio.shape not in ((), (3,)) or not (np.isfinite(ratio) & (ratio > 1)).all():
        raise ValueError(f"lit over shadow is {lit_over_shadow}: must be one number above 1, or three, RGB")
    normal = np.asarray(normal, dtype=np.float64) / np.linalg.norm(normal)
    cosine = float(normal @ clipping.direction)
    if cosine <= 0:
        raise ValueError(
            f"the light is {np.degrees(np.arccos(cosine)):.1f}° from the surface's normal, behind it: "
            "choose a surface that it lights"
        )
    return (ratio - 1) * _sky_irradiance(image, ~clipping.mask, normal) / cosine


def _sky_irradiance(image, mask, normal):
    """∫ L max(ω·n, 0) dω over the pixels of the mask, (3,)."""
    height, width = mask.shape
    directions = equirectangular.pixel_directions(width, height)
    solid_angles = equirectangular.row_solid_angles(width, height)
    total = np.zeros(3)
    for rows in strips(height):
        cosines = np.maximum(directions[rows] @ normal, 0) * mask[rows] * solid_angles[rows, None]
        total += np.einsum("rc,rck->k", cosines, image[rows])
    return total


def _refuse_unclipped(clipping):
    if not clipping.is_clipped:
        raise ValueError("no clipped light was found: nothing in the map is to be restored")


def _largest_part(plateau, solid_angles):
    """Mask of the connected part with the largest solid angle."""
    width = plateau.shape[1]
    largest = max(connected_regions(plateau), key=lambda pixels: solid_angles[pixels // width].sum())
    mask = np.zeros_like(plateau)
    mask.ravel()[largest] = True
    return mask


def _middle(mask, solid_angles):
    """Unit vector to the middle of a mask that is less than half of the sphere."""
    height, width = mask.shape
    rows, columns = np.nonzero(mask)
    uv = equirectangular.uv_from_pixel(np.stack([columns, rows], axis=1), width, height)
    total = solid_angles[rows] @ equirectangular.direction_from_uv(uv)
    return total / max(np.linalg.norm(total), 1e-30)
