"""Summed-area tables: the sum over any rectangle of an image in four look-ups.

Source: thesis, section 7.4.2.3, eq. 7.3-7.5. Rectangles are half-open pixel ranges, and the table has a row
and a column of zeros in front, so that no rectangle is a special case.
"""

import cv2
import numpy as np


def summed_area_table(image):
    """Table (..., H + 1, W + 1) of an image (..., H, W): entry (j, i) is the sum over rows < j, columns < i.

    Sums of a boolean image are exact, int32; all others are float64.

    >>> summed_area_table(np.array([[1.0, 2.0], [3.0, 4.0]])).tolist()
    [[0.0, 0.0, 0.0], [0.0, 1.0, 3.0], [0.0, 4.0, 10.0]]
    """
    image = np.asarray(image)
    height, width = image.shape[-2:]
    counts = image.dtype == bool
    table = np.zeros((*image.shape[:-2], height + 1, width + 1), dtype=np.int32 if counts else np.float64)
    for sheet in np.ndindex(image.shape[:-2]):
        if counts:
            cv2.integral(image[sheet].view(np.uint8), sum=table[sheet], sdepth=cv2.CV_32S)
        else:
            cv2.integral(image[sheet].astype(np.float64, copy=False), sum=table[sheet], sdepth=cv2.CV_64F)
    return table


def rectangle_sums(table, x0, y0, x1, y1, *sheet):
    """Sums (n,) over the columns x0 <= x < x1 and rows y0 <= y < y1, each (n,), of the image of a table.

    ``sheet``: indices (n,) along the axes before the rows, where the table has any.

    >>> table = summed_area_table(np.array([[1.0, 2.0], [3.0, 4.0]]))
    >>> rectangle_sums(table, np.array([0, 1]), 0, 2, np.array([1, 2])).tolist()
    [3.0, 6.0]
    """
    return (
        table[(*sheet, y1, x1)] - table[(*sheet, y1, x0)] - table[(*sheet, y0, x1)] + table[(*sheet, y0, x0)]
    )
