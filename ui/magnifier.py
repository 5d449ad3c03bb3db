"""The magnifier beside the mouse: the panorama's own pixels around it, and where a click would go."""

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ..ibl_toolkit.equirectangular import direction_from_uv, sample
from . import drawing

SIZE = 168
"""Width of the magnifier [px at a UI scale of 1]."""
DISTANCE = 36
"""Of the magnifier from the mouse [px at a UI scale of 1]."""
PIXELS_PER_ROW = 8
"""How large a row of the image is shown, at least [px of the screen]."""
LEAST_ZOOM = 2.5
"""… and how much larger than around it."""
SAMPLES = 84
FRAME, CROSS, CORNER = (0, 0, 0, 0.6), (1, 1, 1, 0.9), (1, 0.85, 0.1, 1)


def draw(canvas, xy, image, exposure, high, snap):
    """Draw it beside (2,) [px] of a canvas; exposure [EV]; high: how far to the right and up there is room
    [px]; snap: the `Snap` of a click there.
    """
    axes = _axes(canvas, np.asarray(xy, float), image.shape[0])
    if axes is None:
        return
    ahead, across, up, zoom = axes
    size, gap = SIZE * drawing.scale(), DISTANCE * drawing.scale()
    steps = ((np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5) * size / zoom
    x, y = np.meshgrid(steps, steps)
    colours = _display(sample(image, ahead + x[..., None] * across + y[..., None] * up), exposure)
    beyond, before = np.asarray(xy) + gap, np.asarray(xy) - gap - size
    low = np.where(beyond + size <= high, beyond, before)
    drawing.rectangle(low - 2, low + size + 2, FRAME)
    _draw_picture(low, size, colours)
    middle = low + size / 2
    for along in (np.array([1, 0]), np.array([0, 1])):
        for side in (-1, 1):
            arm = middle + side * np.outer((4, size / 2), along)
            drawing.lines(arm, FRAME, 3)
            drawing.lines(arm, CROSS, 1)
    if snap is not None and snap.is_corner:
        basis = np.column_stack([across, up])
        offset = np.linalg.lstsq(basis, direction_from_uv(snap.uv) - ahead, rcond=None)[0] * zoom
        if (np.abs(offset) < size / 2).all():
            drawing.ellipse(middle + offset, 6 * drawing.scale() * np.eye(2), CORNER, 2)


def _axes(canvas, xy, height):
    """Direction (3,) under the mouse, what a pixel of the screen to the right and up adds, and the zoom."""
    middle = canvas.uv_at(xy)
    if middle is None:
        return None
    ahead, steps = direction_from_uv(middle), []
    for offset in ((1, 0), (0, 1)):
        for sign in (1, -1):
            beside = canvas.uv_at(xy + sign * np.array(offset))
            if beside is not None:
                steps.append(sign * (direction_from_uv(beside) - ahead))
                break
    if len(steps) < 2:
        return None
    rows = np.linalg.norm(steps[1]) * height / np.pi
    return ahead, *steps, max(PIXELS_PER_ROW * rows, LEAST_ZOOM)


def _display(radiance, exposure):
    """sRGB and alpha (n, n, 4) float32 of linear radiance."""
    linear = np.clip(np.nan_to_num(radiance[..., :3]) * 2.0**exposure, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.concatenate([encoded, np.ones_like(encoded[..., :1])], axis=-1).astype(np.float32)


def _draw_picture(low, size, colours):
    height, width = colours.shape[:2]
    data = gpu.types.Buffer("FLOAT", colours.size, colours.ravel())
    texture = gpu.types.GPUTexture((width, height), format="RGBA32F", data=data)
    shader = gpu.shader.from_builtin("IMAGE")
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    batch = batch_for_shader(
        shader, "TRI_FAN", {"pos": (low + corners * size).astype(np.float32), "texCoord": corners}
    )
    shader.uniform_sampler("image", texture)
    batch.draw(shader)
