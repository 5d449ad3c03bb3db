"""The self-similar tiling behind importance sampling with blue noise: modified Penrose tiles and F-codes.

Four triangles tile the plane, two acute (c, d: sides 1, phi, phi) and two obtuse (e, f: sides phi**2,
phi, phi), phi being the golden ratio.  One step of subdivision replaces each by smaller ones, 1/phi as
long, and drops a sampling tile (a, b) at some of their corners: a point without area, which only turns
from then on (a becomes b, b becomes a).  So the number of triangles, and of points, grows by phi**2.

Each step appends two Fibonacci digits to a tile's F-code.  Read as a number, with the newest digits as
the most significant, the codes of the points below one root all differ, and the points below any limit
lie evenly: there are limit / 2 of them in an obtuse root.  Comparing a point's number with the importance
found there is all the thinning that sampling needs.

Points of the plane are complex numbers and turns are steps of 18 degrees, both in the frame of the root:
an obtuse triangle f with corners 0, phi**2 and phi exp(i pi/5).

Source: Ostromoukhov, Donohue & Jodoin, Fast Hierarchical Importance Sampling with Blue Noise Properties,
SIGGRAPH 2004: production rules, F-codes, structural index, importance index.
"""

from dataclasses import dataclass

import numpy as np

PHI = (1 + np.sqrt(5)) / 2
ROOT_AREA = PHI**3 * np.sin(np.pi / 5) / 2
INDEX_COUNT = 21  # six Fibonacci digits count from 0 to 20; the importance has as many intervals
STEPS = np.exp(1j * np.pi / 10 * np.arange(20))
ACUTE, ACUTE_MIRRORED, OBTUSE, OBTUSE_MIRRORED = range(4)  # the paper's tiles c, d, e, f


def _fibonacci(count):
    numbers = [0, 1]
    while len(numbers) < count:
        numbers.append(numbers[-1] + numbers[-2])
    return np.array(numbers, dtype=np.int64)


FIBONACCI = _fibonacci(91)  # up to the largest that 64 bits hold; two per level
DEEPEST_LEVEL = 43

# Corners of a triangle of each kind, of scale 1 and turn 0.
_ACUTE_CORNERS = (0, 1, PHI * STEPS[4])
_OBTUSE_CORNERS = (0, PHI**2, PHI * STEPS[2])
_CORNERS = np.array([_ACUTE_CORNERS, _ACUTE_CORNERS, _OBTUSE_CORNERS, _OBTUSE_CORNERS])

# The production rules.  Per kind: its smaller triangles as (kind, first corner, turn, digit), and its
# sampling tile as (point, turn, digit) or None.  At level n, digit 1 adds FIBONACCI[2n] and 2 the next.
_ON_SIDE = PHI * STEPS[2] + STEPS[14]
_TRIANGLES = {
    ACUTE: ((OBTUSE_MIRRORED, PHI * STEPS[4], 14, 0), (ACUTE, 1, 6, 2)),
    ACUTE_MIRRORED: ((OBTUSE, 1, 6, 0), (ACUTE_MIRRORED, 1 + STEPS[8], 14, 2)),
    OBTUSE: ((ACUTE, PHI * STEPS[2], 12, 2), (OBTUSE, PHI**2, 8, 1), (OBTUSE_MIRRORED, 0, 0, 0)),
    OBTUSE_MIRRORED: ((OBTUSE_MIRRORED, PHI * STEPS[2], 12, 1), (OBTUSE, _ON_SIDE, 0, 0),
                      (ACUTE_MIRRORED, _ON_SIDE + STEPS[2], 8, 2)),
}
_SAMPLING = {
    ACUTE: (PHI * STEPS[4] + STEPS[16], 1, 2),
    ACUTE_MIRRORED: None,
    OBTUSE: (PHI * STEPS[2] + STEPS[12] / PHI, 7, 2),
    OBTUSE_MIRRORED: (_ON_SIDE, 15, 1),
}


@dataclass(frozen=True)
class Triangles:
    """Triangles of one level: kind, first corner (complex), turn and code value of each, (n,)."""

    kind: np.ndarray
    origin: np.ndarray
    turn: np.ndarray
    value: np.ndarray
    level: int

    def __len__(self):
        """Number of triangles."""
        return len(self.kind)

    def __getitem__(self, chosen):
        """Those triangles that an index array or a mask picks."""
        fields = (self.kind, self.origin, self.turn, self.value)
        return Triangles(*(field[chosen] for field in fields), self.level)

    def corners(self):
        """Corners (n, 3), complex.

        >>> root().corners().round(3).tolist()
        [[0j, (2.618+0j), (1.309+0.951j)]]
        """
        frame = STEPS[self.turn] * PHI**-self.level
        return self.origin[:, None] + _CORNERS[self.kind] * frame[:, None]


@dataclass(frozen=True)
class SamplingTiles:
    """Sampling tiles: point (complex), turn and level at birth, and code value of each, (n,)."""

    point: np.ndarray
    turn: np.ndarray
    level: np.ndarray
    value: np.ndarray

    def __len__(self):
        """Number of sampling tiles."""
        return len(self.point)

    def __getitem__(self, chosen):
        """Those sampling tiles that an index array or a mask picks."""
        return SamplingTiles(self.point[chosen], self.turn[chosen], self.level[chosen], self.value[chosen])

    def frame_at(self, level):
        """Unit vector times scale (n,), complex, of each tile's frame at a later `level` (n,).

        A tile turns by half a turn every second level, as a becomes b and b becomes a.
        """
        turn = (self.turn + 10 * ((level - self.level) // 2)) % 20
        return STEPS[turn] * PHI ** -np.asarray(level, dtype=float)


def root():
    """The triangle f of level 0 that everything is cut from."""
    zero = np.zeros(1, dtype=np.int64)
    return Triangles(zero + OBTUSE_MIRRORED, np.zeros(1, dtype=complex), zero, zero, 0)


def subdivided(triangles):
    """The smaller `Triangles` of `triangles`, and the `SamplingTiles` that appear with them.

    Raises: ValueError below level 43, where a code value would no longer fit into 64 bits.

    >>> smaller, points = subdivided(root())
    >>> len(smaller), points.value.tolist()
    (3, [1])
    """
    level = triangles.level + 1
    if level > DEEPEST_LEVEL:
        raise ValueError(f"level {level} of the tiling is too deep: code values fit up to {DEEPEST_LEVEL}")
    digits = np.array([0, FIBONACCI[2 * level], FIBONACCI[2 * level + 1]])
    smaller, points = [], []
    for kind, rules in _TRIANGLES.items():
        parents = triangles[triangles.kind == kind]
        if not len(parents):
            continue
        for child, *rule in rules:
            placed = _placed(parents, *rule, digits)
            smaller.append((np.full(len(parents), child), *placed))
        if _SAMPLING[kind]:
            points.append(_placed(parents, *_SAMPLING[kind], digits))
    kind, origin, turn, value = (np.concatenate(field) for field in zip(*smaller, strict=True))
    return Triangles(kind, origin, turn, value, level), _sampling_tiles(points, level)


def sampling_tiles_below(limit, keep=None):
    """All `SamplingTiles` of the root whose code value is below `limit`, or of the part that `keep` keeps.

    keep: function of `Triangles` -> mask (n,); false prunes a triangle with everything below it.

    >>> sampling_tiles_below(8).value.tolist()
    [1, 5, 4]
    """
    triangles, found = root(), []
    while len(triangles) and FIBONACCI[2 * triangles.level + 2] < limit:
        triangles, points = subdivided(triangles)
        found.append(points[points.value < limit])
        if keep is not None:
            triangles = triangles[keep(triangles)]
    return joined(found)


def joined(parts):
    """One `SamplingTiles` from a list of them."""
    if not parts:
        return _sampling_tiles([], 0)
    fields = ([getattr(part, name) for part in parts] for name in ("point", "turn", "level", "value"))
    return SamplingTiles(*(np.concatenate(field) for field in fields))


def level_of(importance):
    """Level (n,) at which all code values up to `importance` - 1/2 are there.

    It is log(sqrt(5) importance) to the base phi**2, rounded down.  Importance counts in code values and
    is at least 1/2.

    >>> level_of([0.5, 1.5, 100]).tolist()
    [0, 1, 5]
    """
    return np.floor(_logarithm(importance)).astype(np.int64)


def importance_index(importance):
    """Importance index (n,), 0 to 20: where `importance` lies between two levels, on a logarithmic scale.

    >>> importance_index([100, 100 * PHI**2, 105 * PHI**4]).tolist()
    [13, 13, 14]
    """
    logarithm = _logarithm(importance)
    return np.minimum((INDEX_COUNT * (logarithm - np.floor(logarithm))).astype(np.int64), INDEX_COUNT - 1)


def structural_index(value, level):
    """Structural index (n,), 0 to 20: the six newest Fibonacci digits of code `value` at `level`.

    >>> structural_index([0, 20, 21, 54], 4).tolist()
    [0, 7, 8, 20]
    """
    rest = np.array(value, dtype=np.int64)
    level = np.broadcast_to(level, rest.shape)
    index = np.zeros_like(rest)
    for digit in range(7, 1, -1):  # greedy: F-codes have no two neighbouring ones, so this finds them
        position = 2 * level + digit - 6
        weight = FIBONACCI[np.maximum(position, 0)]
        present = (position >= 2) & (rest >= weight)
        rest -= np.where(present, weight, 0)
        index += np.where(present, FIBONACCI[digit], 0)
    return index


def _placed(parents, offset, turn, digit, digits):
    """First corner, turn and code value of what one rule puts into each of `parents`."""
    frame = STEPS[parents.turn] * PHI**-parents.level
    return parents.origin + offset * frame, (parents.turn + turn) % 20, parents.value + digits[digit]


def _sampling_tiles(parts, level):
    if not parts:
        nothing = np.zeros(0, dtype=np.int64)
        return SamplingTiles(np.zeros(0, dtype=complex), nothing, nothing, nothing)
    point, turn, value = (np.concatenate(field) for field in zip(*parts, strict=True))
    return SamplingTiles(point, turn, np.full(len(point), level), value)


def _logarithm(importance):
    return np.log(np.sqrt(5) * np.asarray(importance, dtype=float)) / np.log(PHI**2)
