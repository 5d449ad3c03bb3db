"""Make ibl_toolkit/light/penrose_corrections.npy, the correction vectors of the Penrose sampler.

    python release/penrose_corrections.py

Some seconds; a test makes the table anew and compares.

The points of the tiling are even but regular.  Lloyd's relaxation moves each to the centroid of its Voronoi
cell; but all points with the same importance index and structural index, seen in the frames of their tiles,
must move alike, so each step takes the mean of their moves.  What they have moved by in the end is the
table's entry, in units of the tile's scale.

The paper relaxes each importance index by itself, on uniform importance.  Points where it varies then have
neighbours that were moved by another row of the table, and may meet.  Here importance is a wave over the
plane, up and down by the factor phi, steep enough that all rows are relaxed beside each other.  The spread
of nearest distances on a gradient of 200 : 1 falls from 0.17 to 0.11 of their mean by that; on uniform
importance the mean is 3 % less than it could be.

Source: Ostromoukhov, Donohue & Jodoin 2004, the section on pre-processing; the table itself is ours.
"""

import pathlib
from dataclasses import dataclass

import cv2
import numpy as np

from expanded_panoramas.ibl_toolkit.light import penrose_tiles

TABLE = pathlib.Path(__file__).resolve().parents[1] / "ibl_toolkit/light/penrose_corrections.npy"
INDICES = penrose_tiles.INDEX_COUNT
LEVEL = 8  # of the tiling: 400 to 1,300 points
WAVES = (20.0, 10.0)  # lengths in mean distances: importance changes by 15 % and 30 % per point at most
STEPS_OF_LLOYD = 10  # twice as many gain less than 1 % in mean distance
OVER_RELAXATION = 1.5  # Lloyd's own step is 1; up to 2 converges, and sooner
RIM = 4.0  # mean distances from the root's edge, within which cells are cut off and do not count
_HEXAGON = 5 / (36 * np.sqrt(3))  # second moment of a hexagon's area along one axis, over its area squared
_PIXELS = 8192  # side of OpenCV's subdivision, whose coordinates are float32


@dataclass(frozen=True)
class Field:
    """Sampling tiles under a wave of importance, each (n,)."""

    point: np.ndarray
    entry: np.ndarray
    """Number of the table's entry, row by row, that corrects the tile."""
    frame: np.ndarray
    """Unit vector times scale, complex, of the tile."""
    slope: np.ndarray
    """Gradient, complex, of the logarithm of importance."""
    is_inner: np.ndarray
    """Whether the Voronoi cell is whole."""


def wave_field(index, length, direction, phase, level=LEVEL):
    """Field of importance phi^sin(k x + phase) times the middle of the interval `index` above `level`.

    length: of the wave, in mean distances of the points; direction, phase [rad].
    """
    middle = penrose_tiles.PHI ** (2 * (level + (index + 0.5) / INDICES)) / np.sqrt(5)
    distance = np.sqrt(2 * penrose_tiles.ROOT_AREA / middle)
    wave_vector = 2 * np.pi / (length * distance) * np.exp(1j * direction)
    tiles = penrose_tiles.sampling_tiles_below(middle * penrose_tiles.PHI)
    angle = (tiles.point * wave_vector.conj()).real + phase
    importance = middle * penrose_tiles.PHI ** np.sin(angle)
    chosen = importance >= tiles.value + 0.5
    tiles, importance, angle = tiles[chosen], importance[chosen], angle[chosen]
    its_level = penrose_tiles.level_of(importance)
    row = penrose_tiles.importance_index(importance)
    column = penrose_tiles.structural_index(tiles.value, its_level)
    slope = np.log(penrose_tiles.PHI) * np.cos(angle) * wave_vector
    is_inner = _is_inside(tiles.point, RIM * distance)
    return Field(tiles.point, row * INDICES + column, tiles.frame_at(its_level), slope, is_inner)


def all_fields(level=LEVEL):
    """A field per importance index and length of wave, their directions and phases spread evenly."""
    fields = []
    for k, (index, length) in enumerate((index, length) for length in WAVES for index in range(INDICES)):
        turns = k * np.array([1 / penrose_tiles.PHI, np.sqrt(2)])  # both far from any fraction
        fields.append(wave_field(index, length, *(2 * np.pi * (turns % 1)), level))
    return fields


def relaxed(fields, steps=STEPS_OF_LLOYD):
    """The table (21, 21), complex, after `steps` of Lloyd's relaxation on all `fields` together."""
    entries = np.zeros(INDICES**2, dtype=complex)
    for _ in range(steps):
        total, count = np.zeros_like(entries), np.zeros(len(entries))
        for field in fields:
            moves = (_centroid_moves(field, entries) / field.frame)[field.is_inner]
            entry = field.entry[field.is_inner]
            np.add.at(total, entry, moves)
            count += np.bincount(entry, minlength=len(entries))
        entries += OVER_RELAXATION * total / np.maximum(count, 1)
    return entries.reshape(INDICES, INDICES)


def _centroid_moves(field, entries):
    """From each corrected point to the centre of importance of its Voronoi cell: (n,), complex."""
    points = field.point + entries[field.entry] * field.frame
    area, centroid = voronoi_cells(points)
    return centroid - points + _HEXAGON * area * field.slope


def voronoi_cells(points):
    """Area (n,) and centroid (n,), complex, of the Voronoi cells of `points` (n,), complex."""
    corner = complex(points.real.min(), points.imag.min())
    unit = max(np.ptp(points.real), np.ptp(points.imag)) / (_PIXELS / 2)
    middle = _PIXELS / 4 * (1 + 1j)
    scaled = (points - corner) / unit + middle
    subdivision = cv2.Subdiv2D((0, 0, _PIXELS, _PIXELS))
    subdivision.insert(np.stack([scaled.real, scaled.imag], axis=-1).astype(np.float32))
    facets, sites = subdivision.getVoronoiFacetList([])
    if len(facets) != len(points):
        raise ValueError(f"{len(points) - len(facets)} of {len(points)} points coincide: no Voronoi cells")
    area, centroid = _polygon_moments(facets, sites)
    return area * unit**2, (centroid - middle) * unit + corner


def _polygon_moments(facets, sites):
    """Area and centroid, complex, of polygons; corners are taken relative to the sites, against round-off."""
    sites = sites[:, 0].astype(float) + 1j * sites[:, 1]
    lengths = np.array([len(facet) for facet in facets])
    starts = np.cumsum(lengths) - lengths
    corners = np.concatenate(facets).astype(float)
    corners = corners[:, 0] + 1j * corners[:, 1] - np.repeat(sites, lengths)
    following = np.arange(1, len(corners) + 1)
    following[starts + lengths - 1] = starts
    cross = (corners.conj() * corners[following]).imag
    area = np.add.reduceat(cross, starts) / 2
    moment = np.add.reduceat(cross * (corners + corners[following]), starts) / 6
    return np.abs(area), sites + moment / area


def _is_inside(points, margin):
    """Whether `points`, complex, lie in the root by more than `margin`."""
    corners = penrose_tiles.root().corners()[0]
    along = np.roll(corners, -1) - corners
    offset = points[:, None] - corners
    return ((along.conj() * offset).imag / np.abs(along) > margin).all(axis=1)


def main():
    """Write the table."""
    table = relaxed(all_fields())
    np.save(TABLE, np.stack([table.real, table.imag], axis=-1).astype(np.float32))
    print(f"{TABLE.name}: {np.count_nonzero(table)} entries, the longest {np.abs(table).max():.3f} scales")


if __name__ == "__main__":
    main()
