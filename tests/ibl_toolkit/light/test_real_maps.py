"""The eight maps that ship with Blender: bright parts of the thesis's kind, and no light is lost."""

import importlib.util
import pathlib

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.images import read_panorama
from expanded_panoramas.ibl_toolkit.light.choice import MOST_LIGHTS
from expanded_panoramas.ibl_toolkit.light.clipping import find_clipping
from expanded_panoramas.ibl_toolkit.light.extraction import extract_lights
from expanded_panoramas.ibl_toolkit.light.light_map import irradiance
from expanded_panoramas.ibl_toolkit.light.split import split

ENERGY = 1e-6
SPEC = importlib.util.find_spec("bpy")
FOLDERS = pathlib.Path(SPEC.origin).parent.glob("*/datafiles/studiolights/world") if SPEC else ()
PATHS = sorted(path for folder in FOLDERS for path in folder.glob("*.exr"))
NARROW = {"courtyard", "forest", "interior", "night", "studio", "sunrise"}


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_half_of_the_light_comes_from_a_small_part(path):
    """Below 5 % of the sphere "in general", section 3.2.1.1; not for a low sun in a bright sky."""
    half = split(read_panorama(path), 0.5)
    assert half.share == pytest.approx(0.5, abs=0.2)  # one pixel of `sunrise` holds 17 %
    assert (half.area < 0.05) == (path.stem in NARROW)


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_the_lights_of_the_bright_part_are_few_and_keep_its_light(path):
    image = read_panorama(path)
    bright = split(image)
    found = extract_lights(image, threshold=bright.share * (1 - 1e-9))
    assert 1 <= len(found.samples) <= MOST_LIGHTS
    assert found.share == pytest.approx(bright.share, rel=0.05)
    total = found.samples.irradiance.sum(axis=0) + irradiance(found.residual)
    assert np.allclose(total, irradiance(image), rtol=ENERGY)
    assert not find_clipping(image).is_clipped


@pytest.mark.parametrize(
    "path", [path for path in PATHS if path.stem == "studio"], ids=lambda path: path.stem
)
def test_the_lamps_of_the_studio_become_lights_by_default(path):
    found = extract_lights(read_panorama(path))
    assert len(found.samples) == 4
    assert found.share > 0.9
