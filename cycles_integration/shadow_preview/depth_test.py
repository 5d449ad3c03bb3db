"""The test of each method as nodes: how much of the light reaches a point, from its place on the map."""

from __future__ import annotations

from ...ibl_toolkit.mobile.shadow_maps import ShadowSettings, evsm, vsm
from ..node_trees import add, maths
from .kinds import GROUP_NODES


class DepthTest:
    """Writes the test of one method into a node tree.

    place: the projection's outputs. texel: the group that reads the map; name: of its nodes. after: a socket,
    or a number, that has to be there before the first look-up, see `new_texel`.
    """

    def __init__(self, tree, settings: ShadowSettings, place, texel, name: str, after=0.0):
        self.tree, self.settings, self.place, self.texel, self.name = tree, settings, place, texel, name
        self.after = after

    def visibility(self):
        """The socket of the lit part, 0 to 1, of a point on the map."""
        method = self.settings.method
        if method == "hard":
            column, row = (self.maths("FLOOR", self.on_map(side)) for side in ("S", "T"))
            return self.is_lit(column, row)
        if method == "pcf":
            return self.mean(self.settings.window, lambda column, row: [self.is_lit(column, row)])[0]
        depth = self.place["Linear Depth"]
        first, second = self.mean(1, lambda column, row: self.read(column, row, depth))
        if method == "vsm":
            return self.without_bleeding(
                self.chebyshev(first, second, depth, vsm.least_variance(self.settings.storage))
            )
        least = evsm.least_deviation(self.settings) ** 2
        return self.without_bleeding(self.chebyshev(first, second, 1.0, least))

    def maths(self, operation, *values):
        """A Math node's output."""
        return maths(self.tree, operation, *values)

    def on_map(self, side):
        """S or T [texels]."""
        return self.maths("MULTIPLY", self.place[side], float(self.settings.resolution))

    def read(self, column, row, depth=0.0):
        """Both numbers of a texel."""
        inputs = {"Column": column, "Row": row, "Depth": depth, "After": self.after}
        kind = GROUP_NODES[self.tree.bl_idname]
        return list(add(self.tree, kind, inputs, node_tree=self.texel, name=self.name).outputs)

    def is_lit(self, column, row):
        """1 where the depth is not beyond the stored one (GL_LEQUAL), else 0."""
        stored = self.read(column, row)[0]
        return self.maths("SUBTRACT", 1.0, self.maths("GREATER_THAN", self.place["Depth"], stored))

    def mean(self, window, numbers):
        """Means of what ``numbers(column, row)`` gives, under a box of ``window`` texels over the point.

        The outermost columns and rows count with the share that the box covers; 1 is bilinear mixing.
        """
        columns, wide = self.steps("S", window)
        rows, high = self.steps("T", window)
        sums = None
        for row, height in zip(rows, high, strict=True):
            line = None
            for column, width in zip(columns, wide, strict=True):
                line = self.plus(line, numbers(column, row), width)
                self.after = line[0]
            sums = self.plus(sums, line, height)
        return [self.maths("DIVIDE", total, float(window**2)) for total in sums]

    def steps(self, side, window):
        """Indices of the columns or rows under the box, and their weights, 0 to 1."""
        corner = self.maths("SUBTRACT", self.on_map(side), window / 2)
        first = self.maths("FLOOR", corner)
        share = self.maths("SUBTRACT", corner, first)
        indices = [first, *(self.maths("ADD", first, float(k)) for k in range(1, window + 1))]
        return indices, [self.maths("SUBTRACT", 1.0, share), *[1.0] * (window - 1), share]

    def plus(self, sums, values, weight):
        """Sums with weighted values added to them."""
        if sums is None:
            return [self.maths("MULTIPLY", value, weight) for value in values]
        return [self.maths("MULTIPLY_ADD", v, weight, s) for v, s in zip(values, sums, strict=True)]

    def chebyshev(self, first, second, depth, least):
        """Upper bound of the lit part; with nothing beyond the mean it is 1, since ``least`` is above 0."""
        mean_squared = self.maths("MULTIPLY", first, first)
        variance = self.maths("MAXIMUM", self.maths("SUBTRACT", second, mean_squared), least)
        beyond = self.maths("MAXIMUM", self.maths("SUBTRACT", depth, first), 0.0)
        return self.maths("DIVIDE", variance, self.maths("MULTIPLY_ADD", beyond, beyond, variance))

    def without_bleeding(self, lit):
        """The linear step of light-bleeding reduction."""
        amount = self.settings.bleeding_reduction
        part = self.maths("DIVIDE", self.maths("SUBTRACT", lit, amount), 1 - amount)
        return self.maths("MINIMUM", self.maths("MAXIMUM", part, 0.0), 1.0)
