"""Draws the panorama of CASES.npz as its views show it, and writes SHOWN.npz. Runs in Blender:

blender --background --python shown_in_blender.py -- CASES.npz SHOWN.npz
"""

import importlib.util
import pathlib
import sys

import gpu
import numpy as np

ROOT = pathlib.Path(__file__).parents[3]


def package():
    """Import the package from where this file is."""
    spec = importlib.util.spec_from_file_location(
        "expanded_panoramas", ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
    )
    module = sys.modules["expanded_panoramas"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)


def shown(shader, texture, view, exposure, share):
    """What the shader draws (H, W, 4), first row at the top."""
    width, height = view.size
    target = gpu.types.GPUOffScreen(width, height, format="RGBA32F")
    with target.bind():
        frame = gpu.state.active_framebuffer_get()
        frame.clear(color=(9, 9, 9, 9))
        shader.draw(view, texture, 2.0**exposure, share)
        pixels = frame.read_color(0, 0, width, height, 4, 0, "FLOAT")
    pixels.dimensions = width * height * 4
    return np.array(pixels, np.float32).reshape(height, width, 4)[::-1]


def main():
    """Read, draw and write."""
    source, target = sys.argv[sys.argv.index("--") + 1 :]
    package()
    from expanded_panoramas.cycles_integration.blender_images import image_from_array
    from expanded_panoramas.ibl_toolkit.views import View
    from expanded_panoramas.ui.background import shader

    gpu.init()
    cases = np.load(source)
    images = {}
    drawn = {}
    for name in cases["names"]:
        case = {key: cases[f"{name}.{key}"] for key in ("image", "window", "view", "frame", "numbers")}
        key = case["image"].tobytes()
        if key not in images:
            images[key] = image_from_array(f"image {len(images)}", case["image"])
        height, exposure, share, *size = case["numbers"].tolist()
        view = View.from_matrices(case["window"], case["view"], case["frame"], height, [int(n) for n in size])
        texture = gpu.texture.from_image(images[key])
        drawn[str(name)] = shown(shader, texture, view, exposure, share)
    assert shader.is_built()
    shader.free()
    assert not shader.is_built()
    np.savez(target, **drawn)


main()
