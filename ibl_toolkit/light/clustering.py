"""Many samples of a light map made few: the two whose union errs least become one, again and again.

Source: thesis, section 3.2.3, after Velho and Gomes [56].
"""

import numpy as np

from .light_map import LUMINANCE
from .samples import combined

FREQUENCIES = ("F1", "F2", "F3")
"""F1: 1, the distance alone counts. F2: the luminance of the region, integrated over it. F3: its mean."""
_ROWS = 64
"""Clusters whose errors with all others are in memory at once."""
_FULL = 0.8
"""Once no larger part of the clusters is left, the merged ones are dropped."""
_LEAST_FREQUENCY = 1e-300
"""Two clusters without light join at no error, not at 0/0."""


def cluster(samples, count=None, least_angle=None, frequency="F2"):
    """Merge LightSamples in pairs until `count` are left, or none are nearer than `least_angle` [rad].

    The pair with the smallest E(c_i, c_j) = F_i F_j / (F_i + F_j) · d² is next, d the great-circle distance;
    what is printed, (F_i F_j² + F_j F_i²) / (F_i + F_j)² · d², is the same. It becomes
    c = (F_i c_i + F_j c_j) / (F_i + F_j), brought back to the unit sphere. F1 and F2 of the union are sums,
    F3 is its mean luminance. With `least_angle`, only pairs nearer than that are merged; with both criteria,
    the first that is met ends it.

    -> LightSamples: irradiance and solid angles are sums, the partition has the new numbers.

    Raises: ValueError for another frequency, without a criterion, for a count below 1, or an angle outside
    (0, π].

    Source: thesis, sections 3.2.3 and 3.2.3.1. Deviation: with `least_angle`, the thesis merges the pair of
    smallest E even where it is wider apart than that.

    >>> from .samples import samples_from_sites
    >>> random = np.random.default_rng(1)
    >>> image = random.random((16, 32, 3), dtype=np.float32)
    >>> many = samples_from_sites(image, random.normal(size=(50, 3)))
    >>> few = cluster(many, count=6)
    >>> len(few), bool(np.allclose(few.irradiance.sum(axis=0), many.irradiance.sum(axis=0), rtol=1e-9))
    (6, True)
    """
    if frequency not in FREQUENCIES:
        raise ValueError(f"frequency is {frequency!r}: must be one of {', '.join(FREQUENCIES)}")
    if count is None and least_angle is None:
        raise ValueError("neither count nor least_angle is given: one must say when to stop")
    if count is not None and count < 1:
        raise ValueError(f"count is {count}: at least 1 light must be left")
    if least_angle is not None and not 0 < least_angle <= np.pi:
        raise ValueError(f"least_angle is {least_angle} rad: must be above 0 and at most π")
    clusters = _Clusters(samples, frequency, least_angle or np.inf)
    while clusters.count > (count or 1) and clusters.merge_cheapest():
        pass
    return combined(samples, *clusters.result())


def clusterings(samples, most, frequency="F2"):
    """For every number of clusters, from `most` down to 1: groups (n,) and directions (m, 3).

    Cheaper than `cluster` for each, and without partitions.

    >>> from .samples import samples_from_sites
    >>> samples = samples_from_sites(np.ones((8, 16, 3), np.float32), [[1, 0, 0], [-1, 0, 0], [-1, 1, 0]])
    >>> [groups.tolist() for groups, _ in clusterings(samples, 2)]
    [[0, 1, 1], [0, 0, 0]]
    """
    clusters = _Clusters(samples, frequency, np.inf)
    while clusters.count > most:
        clusters.merge_cheapest()
    yield clusters.result()
    while clusters.count > 1:
        clusters.merge_cheapest()
        yield clusters.result()


def _frequency_terms(samples, frequency):
    """Numerator and denominator (n,) of every sample's F, and whether denominators add up in a union."""
    ones = np.ones(len(samples))
    if frequency == "F1":
        return ones, ones.copy(), False
    power = np.asarray(samples.irradiance, np.float64) @ LUMINANCE
    power = power / max(power.max(), _LEAST_FREQUENCY)  # errors are kept as single floats
    if frequency == "F2":
        return power, ones, False
    return power, np.array(samples.solid_angles, np.float64), True


class _Clusters:
    """What is left of the samples, and for each the partner with which it errs least.

    A cluster whose partner was merged is stale: its error is then a lower bound, since all others were worse,
    and it is looked at again only when it is the least of all. Merged clusters stay, at infinite error, until
    they are too many.
    """

    def __init__(self, samples, frequency, widest):
        self._above, self._below, self._is_mean = _frequency_terms(samples, frequency)
        self._frequencies = self._above / self._below
        self._directions = np.array(samples.directions, np.float64)
        self._widest = widest
        self.count = len(samples)
        self._alive = np.ones(self.count, bool)
        self._numbers = np.arange(self.count)  # each row's cluster goes by the number of one of its samples
        self._parents = np.arange(self.count)  # of each number: itself, or the one it was merged into
        self._nearest = np.zeros(self.count, np.int64)
        self._least = np.full(self.count, np.inf, np.float32)
        self._is_stale = np.zeros(self.count, bool)
        for first in range(0, self.count, _ROWS):  # each pair once
            rows = np.arange(first, min(first + _ROWS, self.count))
            errors = self._errors_with(rows, first)
            self._improve(rows, errors, first)
            self._improve(np.arange(first, self.count), errors.T, first)

    def merge_cheapest(self):
        """Make one of the two clusters whose union errs least; False if no pair may be merged."""
        i = int(self._least.argmin())
        while self._is_stale[i]:
            self._choose(i)
            i = int(self._least.argmin())
        if np.isinf(self._least[i]):
            return False
        j = int(self._nearest[i])
        self._join(i, j)
        errors = self._choose(i)
        self._least[j] = np.inf
        self._is_stale |= (self._nearest == i) | (self._nearest == j)
        closer = errors < self._least
        self._nearest[closer], self._least[closer] = i, errors[closer]
        self._is_stale[closer] = self._is_stale[[i, j]] = False
        if self.count < _FULL * len(self._alive):
            self._drop_empty_rows()
        return True

    def result(self):
        """Cluster of every sample, from 0, and directions (count, 3) of the clusters."""
        parents = self._parents
        while not np.array_equal(parents, parents[parents]):
            parents = parents[parents]
        order = np.argsort(self._numbers[self._alive])
        numbers = self._numbers[self._alive][order]
        return np.searchsorted(numbers, parents), self._directions[self._alive][order]

    def _errors_with(self, rows, first=0):
        """E (m, n) of the unions of m clusters with those from `first` on, infinite where none may be."""
        cosines = np.einsum("mk,nk->mn", self._directions[rows], self._directions[first:])
        squared_sines = np.clip(0.5 - 0.5 * cosines, 0, 1).astype(np.float32)  # of half the angles
        distances = 2 * np.arcsin(np.sqrt(squared_sines))
        own, others = self._frequencies[rows, None], self._frequencies[first:]
        weights = own * others / np.maximum(own + others, _LEAST_FREQUENCY)
        errors = distances * distances * weights.astype(np.float32)
        errors[:, ~self._alive[first:]] = np.inf
        if np.isfinite(self._widest):
            errors[distances >= self._widest] = np.inf
        errors[np.arange(len(rows)), rows - first] = np.inf
        return errors

    def _improve(self, rows, errors, first):
        """Take the partners, numbered from `first`, with which these clusters err less than before."""
        least = errors.min(axis=1)
        better = least < self._least[rows]
        self._least[rows[better]] = least[better]
        self._nearest[rows[better]] = errors[better].argmin(axis=1) + first

    def _choose(self, row):
        """Find the partner of a cluster -> its errors with all others, (n,)."""
        errors = self._errors_with(np.array([row]))[0]
        self._nearest[row] = errors.argmin()
        self._least[row] = errors[self._nearest[row]]
        self._is_stale[row] = False
        return errors

    def _join(self, i, j):
        """Put cluster j into cluster i."""
        first, second = self._frequencies[i], self._frequencies[j]
        mean = first * self._directions[i] + second * self._directions[j]
        length = np.sqrt(mean @ mean)
        if length > 1e-9 * (first + second):
            self._directions[i] = mean / length
        # otherwise they are opposite and as strong: the one is as good as the other
        self._above[i] += self._above[j]
        if self._is_mean:
            self._below[i] += self._below[j]
        self._frequencies[i] = self._above[i] / self._below[i]
        self._parents[self._numbers[j]] = self._numbers[i]
        self._alive[j] = False
        self.count -= 1

    def _drop_empty_rows(self):
        rows = np.flatnonzero(self._alive)
        names = "_above", "_below", "_frequencies", "_directions", "_alive", "_numbers", "_least", "_is_stale"
        for name in names:
            setattr(self, name, getattr(self, name)[rows])
        self._nearest = np.searchsorted(rows, self._nearest[rows])
