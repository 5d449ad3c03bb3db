"""The page in a real, headless Chromium: what it shows is what numpy's shadow maps say."""

import subprocess

import numpy as np
import pytest
import web_pages
from web_pages import CHROMIUM, FLAGS, measured, photo, sky, still_life, white

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import suggested_settings
from expanded_panoramas.ibl_toolkit.mobile.web_page import write_page

pytestmark = pytest.mark.skipif(
    not CHROMIUM, reason="needs a Chromium: CHROMIUM=/path/to/chromium, or `chromium` on the PATH"
)

MEAN = 1.0
"""Of 255, over a picture; where everything is white or in shadow it is below 0.2."""
BEYOND = 0.003
"""The part of what is not at an outline that may differ by more than 2/255: texels at a shadow's edge."""


@pytest.mark.parametrize(
    ("method", "storage", "lights", "background"),
    [
        ("hard", "float32", ("sun",), "white"),
        ("pcf", "8+8", ("lamp",), "photo"),
        ("vsm", "16+16", ("sun",), "white"),
        ("evsm", "16+16", ("sun", "lamp"), "sky"),
    ],
)
def test_page_shows_what_numpy_says(tmp_path, method, storage, lights, background):
    real = ("support",) * 3
    scene = still_life(lights, real, 0.0) if background == "white" else still_life(lights)
    behind = {"white": white, "sky": sky, "photo": lambda: photo(web_pages.camera())}[background]()
    settings = suggested_settings(4.0, 512, storage, 0.04, method)
    off, outlines, shown = measured(scene, settings, behind, tmp_path)
    assert off.mean() < MEAN
    assert (off[~outlines] > 2).mean() < BEYOND
    assert shown.std() > 10  # there is a shadow at all


def test_tolerance_would_not_let_a_wrong_window_pass():
    scene, view = still_life(("sun",), ("support",) * 3, 0.0), web_pages.camera()
    right, other = (
        web_pages.expected(scene, suggested_settings(4.0, 512, "16+16", penumbra, "vsm"), white(), view)
        for penumbra in (0.04, 0.08)
    )
    assert (np.abs(right[0] - other[0]).max(axis=2)[~right[1]] > 2).mean() > 2 * BEYOND


def test_page_says_what_the_device_lacks(tmp_path):
    page = tmp_path / "page.html"
    write_page(page, still_life(), [suggested_settings(4.0, 64)], sky(), web_pages.camera())
    done = subprocess.run(
        [
            CHROMIUM,
            *FLAGS,
            "--disable-3d-apis",
            "--dump-dom",
            f"--user-data-dir={tmp_path}/user",
            page.as_uri(),
        ],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    assert "<output>this browser or device has no WebGL 2</output>" in done.stdout
