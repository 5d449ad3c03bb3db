"""The page in Chromium against the preview's nodes in Cycles: of one Blender scene they show the same."""

import pytest
from page_and_preview import StillLife
from web_pages import CHROMIUM

from expanded_panoramas.ibl_toolkit.mobile.shadow_maps import suggested_settings

pytestmark = pytest.mark.skipif(
    not CHROMIUM, reason="needs a Chromium: CHROMIUM=/path/to/chromium, or `chromium` on the PATH"
)
MEAN = 0.2
"""Of 255, away from outlines."""


def test_page_shows_what_the_preview_shows(fresh_blend, tmp_path):
    """Beyond 2/255 is what a shadow's edge has where a texel's middle falls on the other side of it."""
    cases = (
        (("sun", "lamp"), suggested_settings(4.0, 256, "16+16", 0.08, "evsm"), 0.003),
        (("lamp",), suggested_settings(4.0, 256, "8+8", 0.08, "pcf"), 0.01),
    )
    pages = StillLife((240, 160)).differences([case[:2] for case in cases], tmp_path)
    for page, (_, settings, most) in zip(pages, cases, strict=True):
        inside = page.off[~page.outlines]
        assert inside.mean() < MEAN, settings
        assert (inside > 2).mean() < most, settings
        assert (page.picture < 128).any(axis=2).mean() > 0.1  # there is something to see
