"""Sheets of pictures, pixel by pixel, with a title over each column."""

import cv2
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

GAP, HEADER, DPI, QUALITY = 8, 44, 100, 90
"""Between pictures and over the columns [px], dots an inch, of the JPEG [%]."""


def write_sheet(path, columns):
    """Write columns, {title: pictures (h, w, 3) sRGB from top to bottom, of one size}, as a JPEG."""
    high, wide = next(iter(columns.values()))[0].shape[:2]
    rows = len(next(iter(columns.values())))
    width, height = len(columns) * (wide + GAP) - GAP, HEADER + rows * (high + GAP) - GAP
    sheet = np.full((height, width, 3), 255, np.uint8)
    figure = plt.figure(figsize=(width / DPI, HEADER / DPI), dpi=DPI)
    for number, (title, pictures) in enumerate(columns.items()):
        left = number * (wide + GAP)
        for row, picture in enumerate(pictures):
            top = HEADER + row * (high + GAP)
            sheet[top : top + high, left : left + wide] = picture
        figure.text((left + wide / 2) / width, 0.45, title, ha="center", va="center", fontsize=wide / 22)
    figure.canvas.draw()
    sheet[:HEADER] = np.asarray(figure.canvas.buffer_rgba())[:HEADER, :width, :3]
    plt.close(figure)
    cv2.imwrite(str(path), sheet[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
