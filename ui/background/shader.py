"""The background's shader: built when it is first drawn with, and freed with the add-on."""

from __future__ import annotations

from pathlib import Path

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

NAME = "background"
CONSTANTS = ("eye", "eye_x", "eye_y", "ray", "ray_x", "ray_y", "up")
"""Push constants, a vec4 each: 112 bytes of the 128 that every graphics card has."""
COVER = np.array([(-1, -1, 1, 1), (3, -1, 1, 1), (-1, 3, 1, 1)], np.float32)
"""Corners of a triangle, in clip space, that covers the region at the far plane."""
_built = None


def draw(view, texture: gpu.types.GPUTexture, gain: float, share: float, corners=COVER):
    """Draw the panorama into the framebuffer in use, in the state of blending and depth test in use.

    view: an `ibl_toolkit.views.View`. texture: the panorama, scene-linear. gain: what its radiance is
    multiplied by. share: what the result, alpha included, is multiplied by. corners (3 n, 4): triangles in
    clip space on which it is drawn.
    """
    shader = _shader()
    shader.bind()
    for name, value in constants(view, gain, share).items():
        shader.uniform_float(name, value)
    shader.uniform_sampler("panorama", texture)
    batch_for_shader(shader, "TRIS", {"corner": np.ascontiguousarray(corners, np.float32)}).draw(shader)


def constants(view, gain: float, share: float) -> dict[str, tuple[float, ...]]:
    """The push constants, as the fragment shader's head describes them."""
    width, height = view.size
    fourth = (float(view.is_perspective), 2 / width, 2 / height, gain, share, 0.0, view.camera_height)
    vectors = (getattr(view, name) for name in CONSTANTS)
    return {name: (*map(float, v), w) for name, v, w in zip(CONSTANTS, vectors, fourth, strict=True)}


def free():
    """Give the shader back."""
    global _built
    _built = None


def is_built() -> bool:
    """Whether there is a shader to free."""
    return _built is not None


def _shader():
    global _built
    if _built is None:
        _built = gpu.shader.create_from_info(_description())
    return _built


def _description():
    """What OpenGL, Vulkan and Metal each make their shader of."""
    between = gpu.types.GPUStageInterfaceInfo("panorama_background")
    between.smooth("VEC3", "place")
    info = gpu.types.GPUShaderCreateInfo()
    info.vertex_in(0, "VEC4", "corner")
    info.vertex_out(between)
    info.fragment_out(0, "VEC4", "colour")
    info.sampler(0, "FLOAT_2D", "panorama")
    for name in CONSTANTS:
        info.push_constant("VEC4", name)
    info.vertex_source(_source("vert"))
    info.fragment_source(_source("frag"))
    return info


def _source(stage):
    return Path(__file__).with_name(f"{NAME}.{stage}.glsl").read_text(encoding="utf-8")
