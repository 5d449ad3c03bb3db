"""Make ibl_toolkit/light/penrose_corrections.npy, the correction vectors of the Penrose sampler.

    python release/penrose_corrections.py

About a minute; the same file every time, up to the last digits of the floating-point library.

Uniform importance leaves points of the tiling that are even but regular.  Lloyd's relaxation moves every
point to the centroid of its Voronoi cell; but all points with one structural index, seen in the frames
of their tiles, must move alike, so the mean of their moves is taken at each step.  What they have moved
by in the end is the table's entry, in units of the tile's scale: one complex number for each importance
index (row) and structural index (column).

Source: Ostromoukhov, Donohue & Jodoin 2004, the section on pre-processing; the table itself is ours.
"""

import pathlib
import sys

import cv2
import numpy as np

from expanded_panoramas.ibl_toolkit.light import penrose_tiles

TABLE = pathlib.Path(__file__).resolve().parents[1] / "ibl_toolkit/light/penrose_corrections.npy"
LEVEL = 9  # of the relaxed tiling: 1,300 to 3,400 points
STEPS_OF_LLOYD = 60
OVER_RELAXATION = 1.5  # Lloyd's own step is 1; up to 2 converges, and sooner
RIM = 4.0  # mean distances from the root's edge, within which cells are cut off and do not count
_PIXELS = 8192.0  # side of OpenCV's subdivision, whose coordinates are float32


def importance_of(index, level=LEVEL):
    """Importance in the middle of the interval `index` above `level`, in code values."""
    return penrose_tiles.PHI ** (2 * (level + (index + 0.5) / penrose_tiles.INDEX_COUNT)) / np.sqrt(5)


def uniform_tiles(index, level=LEVEL):
    """Sampling tiles of uniform importance `index`, their structural index and frame, each (n,)."""
    limit = importance_of(index, level) + 0.5
    tiles = penrose_tiles.sampling_tiles_below(limit)
    structure = penrose_tiles.structural_index(tiles.value, level)
    return tiles, structure, tiles.frame_at(np.full(len(tiles), level))


def voronoi_cells(points):
    """Area (n,) and centroid (n,), complex, of the Voronoi cells of `points` (n,), complex."""
    corner = complex(points.real.min(), points.imag.min())
    extent = max(np.ptp(points.real), np.ptp(points.imag))
    scaled = (points - corner) * (_PIXELS / 2 / extent) + _PIXELS / 4 * (1 + 1j)
    subdivision = cv2.Subdiv2D((0, 0, int(_PIXELS), int(_PIXELS)))
    subdivision.insert(np.stack([scaled.real, scaled.imag], axis=-1).astype(np.float32))
    facets, sites = subdivision.getVoronoiFacetList([])
    if len(facets) != len(points):
        raise ValueError(f"{len(points) - len(facets)} of {len(points)} points coincide: no Voronoi cells")
    area, centroid = _polygon_moments(facets, sites)
    back = extent / (_PIXELS / 2)
    return area * back**2, (centroid - _PIXELS / 4 * (1 + 1j)) * back + corner


def relaxed(index, start, steps=STEPS_OF_LLOYD, level=LEVEL):
    """The table's row (21,), complex, of importance `index`, from the row `start` by Lloyd's relaxation.

    Structural indices that do not occur at that importance keep their value of `start`.
    """
    tiles, structure, frame = uniform_tiles(index, level)
    inner = _is_inside(tiles.point, RIM * np.sqrt(penrose_tiles.ROOT_AREA / len(tiles)))
    count = np.bincount(structure[inner], minlength=penrose_tiles.INDEX_COUNT)
    row = np.array(start, dtype=complex)
    for _ in range(steps):
        points = tiles.point + row[structure] * frame
        move = ((voronoi_cells(points)[1] - points) / frame)[inner]
        total = [np.bincount(structure[inner], part, len(row)) for part in (move.real, move.imag)]
        row += OVER_RELAXATION * (total[0] + 1j * total[1]) / np.maximum(count, 1)
    return row


def table(steps=STEPS_OF_LLOYD, level=LEVEL):
    """The whole table (21, 21), complex: from the densest importance down, each row starting at the last."""
    rows = [relaxed(penrose_tiles.INDEX_COUNT - 1, np.zeros(penrose_tiles.INDEX_COUNT), 3 * steps, level)]
    for index in range(penrose_tiles.INDEX_COUNT - 2, -1, -1):
        rows.append(relaxed(index, rows[-1], steps, level))
    return np.array(rows[::-1])


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
    np.save(TABLE, np.stack([(whole := table()).real, whole.imag], axis=-1).astype(np.float32))
    print(f"{TABLE} written: {whole.shape}, longest {np.abs(whole).max():.3f}", file=sys.stderr)


if __name__ == "__main__":
    main()
