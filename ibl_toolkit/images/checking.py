"""What a panorama must be, whatever file it comes from or goes to."""

import numpy as np

from .errors import ImageError

# Lossy compression and resampling leave values just below zero. Those of the panoramas that ship with
# Blender go down to 1.4 % of their mean (night.exr); what is beyond this part of the mean is not rounding.
NEGATIVE_ROUNDING = 0.02
_BLOCK_ROWS = 64


def row_blocks(height):
    """Slices of rows that cover an image, each small enough to stay in the cache.

    >>> row_blocks(100)
    [slice(0, 64, None), slice(64, 128, None)]
    """
    return [slice(row, row + _BLOCK_ROWS) for row in range(0, height, _BLOCK_ROWS)]


def refuse_more_than(max_bytes, needed, what, path):
    """Raise ImageError if the header's `what` needs more bytes than allowed."""
    if needed > max_bytes:
        raise ImageError(
            f"{path}: its header asks for {needed / 2**30:.3g} GiB of memory ({what}), the limit is "
            f"{max_bytes / 2**30:.3g} GiB"
        )


def refuse_other_shapes(width, height, path):
    """Raise ImageError unless the image is 2:1."""
    if width != 2 * height:
        raise ImageError(f"{path}: {width} x {height} px, an equirectangular panorama must be 2:1")


def refuse_impossible_radiance(image, path):
    """Raise ImageError for NaN, infinite or negative radiance beyond rounding; returns the lowest value.

    Goes by blocks of rows, so as not to fill the memory.
    """
    blocks = [image[rows] for rows in row_blocks(len(image))]
    # Every NaN and infinity shows in the smallest or the largest value: nothing is stored to find it.
    lowest, highest = np.min([b.min() for b in blocks]), np.max([b.max() for b in blocks])
    if not np.isfinite([lowest, highest]).all():
        _refuse_not_finite(blocks, path)
    if lowest >= 0:
        return float(lowest)
    mean = sum(float(b.sum(dtype=np.float64)) for b in blocks) / image.size
    if lowest < -NEGATIVE_ROUNDING * max(mean, 0):
        row, column, channel = _first(blocks, lambda b: b == lowest)
        raise ImageError(
            f"{path}: negative radiance, {lowest:.4g} in {'RGB'[channel]} of pixel ({column}, {row}); "
            f"rounding explains {NEGATIVE_ROUNDING:.0%} of the mean, {mean:.4g}"
        )
    return float(lowest)


def _refuse_not_finite(blocks, path):
    count = sum(int(np.count_nonzero(~np.isfinite(b).all(axis=-1))) for b in blocks)
    row, column, channel = _first(blocks, lambda b: ~np.isfinite(b))
    value = blocks[row // _BLOCK_ROWS][row % _BLOCK_ROWS, column, channel]
    raise ImageError(
        f"{path}: {count} pixel{'s' if count > 1 else ''} of NaN or infinite radiance, the first at "
        f"({column}, {row}): {value} in {'RGB'[channel]}"
    )


def _first(blocks, test):
    """Row, column and channel of the first value, row by row, for which `test` holds."""
    for number, block in enumerate(blocks):
        found = np.argwhere(test(block))
        if len(found):
            row, column, channel = (int(k) for k in found[0])
            return number * _BLOCK_ROWS + row, column, channel
    raise AssertionError("called without such a value")
