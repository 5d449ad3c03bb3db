"""The largest value of an image inside boxes of pixels, from a pyramid of maxima; bounds, never too low."""

import numpy as np


class MaximumPyramid:
    """An image (H, W) and its maxima over blocks of 2, 4, 8 … pixels, for quick bounds over boxes.

    >>> pyramid = MaximumPyramid(np.array([[0, 1, 0], [5, 0, 2]]))
    >>> pyramid.bound([0, 2], [1, 2], [0, 0], [0, 1]).tolist()
    [1.0, 2.0]
    """

    def __init__(self, image):
        self.layers = [image]
        while max(self.layers[-1].shape) > 1:
            self.layers.append(_halved(self.layers[-1]))

    @property
    def image(self):
        """The image itself (H, W)."""
        return self.layers[0]

    def bound(self, left, right, top, bottom):
        """Upper bounds (n,), float64, of the image over boxes of pixels, each side (n,) and included.

        What lies outside the image counts as 0.  A bound is the maximum over a box at most four times as
        wide and as high, and the exact maximum for boxes of one or two pixels' width and height.
        """
        height, width = self.image.shape
        left, top = np.maximum(left, 0), np.maximum(top, 0)
        right, bottom = np.minimum(right, width - 1), np.minimum(bottom, height - 1)
        extent = np.maximum(right - left, bottom - top)
        largest = np.zeros(len(extent))
        inside = (right >= left) & (bottom >= top)
        layer = np.ceil(np.log2(np.maximum(extent, 1))).astype(np.int64)
        for k in np.unique(layer[inside]):
            here = np.flatnonzero(inside & (layer == k))
            # 2**k is no less than the extent, so a box touches at most two blocks each way.
            blocks = [[side[here] >> k for side in sides] for sides in ((left, right), (top, bottom))]
            for columns in blocks[0]:
                for rows in blocks[1]:
                    largest[here] = np.maximum(largest[here], self.layers[k][rows, columns])
        return largest


def _halved(image):
    """Maxima over blocks of 2 × 2 pixels; the last row and column may stand alone."""
    rows = _halved_rows(image)
    return np.ascontiguousarray(_halved_rows(rows.T).T)


def _halved_rows(image):
    whole = len(image) // 2 * 2
    halved = np.maximum(image[0:whole:2], image[1:whole:2])
    return halved if whole == len(image) else np.concatenate([halved, image[whole:]])
