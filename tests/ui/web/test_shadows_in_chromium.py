"""The page in a real, headless Chromium: what it shows is what numpy's shadow maps say."""

import re
from dataclasses import replace

import numpy as np
import pytest
import web_pages
from web_pages import CHROMIUM, measured, photo, sky, still_life, white

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import LightCamera, reaching, suggested_settings
from expanded_panoramas.ibl_toolkit.mobile.web_page import SOURCES, write_page

pytestmark = pytest.mark.skipif(
    not CHROMIUM, reason="needs a Chromium: CHROMIUM=/path/to/chromium, or `chromium` on the PATH"
)

MEAN = 1.0
"""Of 255, over a picture; where everything is white or in shadow it is below 0.2."""
BEYOND = 0.003
"""The part of what is not at an outline that may differ by more than 2/255: texels at a shadow's edge."""


FINE, COARSE = (512, 0.04), (64, 0.9)
"""Texels a side, and the penumbra [m]; coarse is where a line in which the floor comes to far would show."""
CASES = {
    "hard, float32, sun, visibility": ("hard", "float32", FINE, ("sun",), white),
    "PCF, 8+8, lamp, photo": ("pcf", "8+8", FINE, ("lamp",), lambda: photo(web_pages.camera())),
    "VSM, 16+16, sun, visibility": ("vsm", "16+16", FINE, ("sun",), white),
    "EVSM, 8+8, lamp, visibility": ("evsm", "8+8", FINE, ("lamp",), white),
    "EVSM, 16+16, both, panorama": ("evsm", "16+16", COARSE, ("sun", "lamp"), sky),
}


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    cases = []
    for method, storage, (texels, penumbra), lights, background in CASES.values():
        alone = background is white
        settings = suggested_settings(4.0, texels, storage, penumbra, method)
        scene = still_life(lights, ("support",) * 3, 0.0) if alone else as_exported(lights, settings)
        cases.append((scene, settings, background()))
    return dict(zip(CASES, measured(cases, tmp_path_factory.mktemp("pages")), strict=True))


def as_exported(lights, settings):
    """Floor and box stand for real things, whose shadows are in the photograph; the maps are fitted to the
    ball, and the floor comes to far in them."""
    scene = still_life(lights)
    floor, box, ball = (replace(mesh, throws=mesh.name == "ball") for mesh in scene.meshes)
    real = [replace(mesh, role="support") for mesh in (floor, box)]
    cameras = {
        "sun": LightCamera.of_sun(web_pages.SUN, ball.points),
        "lamp": LightCamera.of_lamp(web_pages.LAMP, ball.points),
    }
    fitted = [reaching(cameras[name].with_border(settings), floor.points, floor.triangles) for name in lights]
    return replace(
        scene,
        meshes=(*real, ball),
        lights=[replace(one, camera=camera) for one, camera in zip(scene.lights, fitted, strict=True)],
    )


@pytest.mark.parametrize("name", CASES)
def test_page_shows_what_numpy_says(shown, name):
    page = shown[name]
    assert page.off.mean() < MEAN
    assert (page.off[~page.outlines] > 2).mean() < BEYOND
    assert page.picture.std() > 10  # there is a shadow at all


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
    command = tmp_path, "--disable-3d-apis", "--dump-dom", page.as_uri()
    # A busy machine's browser may dump the page before its modules have run: it is asked up to three times.
    shown = (web_pages.chromium(*command) for _ in range(3))
    assert any("<output>this browser or device has no WebGL 2</output>" in page for page in shown)


SMALL_TEXTURES = """<script>
const limit = WebGL2RenderingContext.prototype.getParameter;
WebGL2RenderingContext.prototype.getParameter = function (name) {
  return name === this.MAX_TEXTURE_SIZE ? 128 : limit.call(this, name);
};
</script>
<script type="module">
const kinds = document.querySelector("select");
const canvas = document.querySelector("canvas");
while (!kinds.length) { await new Promise((done) => setTimeout(done, 10)); }
const gl = canvas.getContext("webgl2");
const shown = async () => {
  dispatchEvent(new Event("resize"));
  await new Promise(requestAnimationFrame); /* in which it is drawn first */
  const pixels = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return new Set(pixels).size + " " + pixels.reduce((sum, value, k) => (sum + value * (k % 997)) % 1e9, 0);
};
const before = await shown();
kinds.selectedIndex = 1;
kinds.dispatchEvent(new Event("change"));
document.title = [before, await shown()].join();
</script>
</body>"""


def test_where_a_map_fails_the_page_says_why_and_keeps_the_one_it_had(tmp_path):
    """As on a device whose textures end at 128 px, of which the second kind of map wants 256."""
    kinds = [suggested_settings(4.0, size, "8+8", 0, "hard") for size in (64, 256)]
    page = tmp_path / "page.html"
    write_page(page, still_life(), kinds, sky(), web_pages.camera())
    page.write_text(page.read_text(encoding="utf-8").replace("</body>", SMALL_TEXTURES), encoding="utf-8")
    for _ in range(3):  # a busy machine's browser may dump the page before its modules have run
        dumped = web_pages.chromium(tmp_path, "--window-size=240,160", "--dump-dom", page.as_uri())
        before, _, after = re.search("<title>(.*)</title>", dumped)[1].partition(",")
        if after:
            break
    complaint = "this device's textures end at 128 texels a side, the shadow map has 256"
    assert f"<output>{complaint}</output>" in dumped
    assert after == before
    assert int(before.split()[0]) > 50  # values of pixels: there is a picture


DRAG = """
const listeners = {};
const canvas = {
  clientWidth: 100,
  addEventListener: (name, listener) => { listeners[name] = listener; },
  setPointerCapture: () => {},
  hasPointerCapture: () => true,
};
const view = new View({ eye: [0, 0, 0], axes: [[0, -1, 0], [0, 0, -1], [1, 0, 0]], half_width: 1 });
control(canvas, view, () => {});
listeners.pointerdown({ isPrimary: true, pointerId: 1, clientX: 20, clientY: 50 });
listeners.pointermove({ isPrimary: true, pointerId: 1, clientX: 70, clientY: 50 });
listeners.pointermove({ isPrimary: true, pointerId: 1, clientX: 120, clientY: 50 });
document.body.textContent = view.axes[2].map((v) => v.toFixed(3));
"""


def test_dragging_across_turns_by_the_angle_of_view_without_movement_in_events(tmp_path):
    """From along x to along y, what was in the middle of 90° being dragged by the picture's whole width."""
    page = tmp_path / "drag.html"
    code = (SOURCES / "view.js").read_text(encoding="utf-8")
    page.write_text(f'<body><script type="module">{code}{DRAG}</script>', encoding="utf-8")
    found = web_pages.chromium(tmp_path, "--dump-dom", page.as_uri())
    assert re.search(r"<body>(.*?)</body>", found, re.DOTALL)[1].replace("-0", "0") == "0.000,1.000,0.000"
