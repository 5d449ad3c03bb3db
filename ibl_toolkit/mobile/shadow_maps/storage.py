"""How a device holds numbers from 0 to 1: as 32-bit floats, in 8 bits each, or in 16 bits each.

Devices of 2012 have textures of four bytes a texel only. Two numbers of 16 bits are packed into them, the
high byte first ("bit packing", section IV.C); what filters them has to unpack them first.
"""

import numpy as np

STEPS = {"float32": None, "8+8": 1 / 255, "16+16": 1 / 65535}
"""Step between two numbers of each storage; a float's varies."""


def packed(numbers: np.ndarray, storage: str) -> np.ndarray:
    """Numbers (…, C) as the device holds them: float32 (…, C), uint8 (…, C), or uint8 (…, 2C), rounded.

    Whole numbers hold 0 to 1; what is beyond is cut off.

    >>> packed(np.array([[0.5, 1.0]]), "16+16")
    array([[128,   0, 255, 255]], dtype=uint8)
    """
    if storage == "float32":
        return numbers.astype(np.float32)
    whole = np.rint(np.clip(numbers, 0, 1) / STEPS[storage]).astype(np.uint16)
    if storage == "8+8":
        return whole.astype(np.uint8)
    bytes_ = np.stack([whole >> 8, whole & 255], axis=-1).astype(np.uint8)
    return bytes_.reshape(*numbers.shape[:-1], -1)


def unpacked(texels: np.ndarray, storage: str) -> np.ndarray:
    """The numbers (…, C) that texels stand for, float64.

    >>> unpacked(packed(np.array([[0.25]]), "8+8"), "8+8").round(4)
    array([[0.251]])
    """
    if storage == "float32":
        return texels.astype(np.float64)
    if storage == "16+16":
        texels = texels[..., 0::2].astype(np.float64) * 256 + texels[..., 1::2]
    return texels * STEPS[storage]
