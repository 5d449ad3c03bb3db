"""The operators of light: from infinity without surfaces, and a clipped lamp restored."""

import numpy as np
import panoramas
import pytest

from expanded_panoramas.ibl_toolkit.images import read_panorama


@pytest.fixture
def lit_place(fresh_blend, tmp_path):
    """A calibrated room under a map with one clipped lamp over its floor."""
    image = np.full((128, 256, 3), 0.002, np.float32)
    image[20:26, 60:72] = 16
    scene, here = panoramas.room_place(fresh_blend, panoramas.write_panorama(tmp_path / "map.exr", image))
    scene.panorama_set.image = here.image
    scene.panorama_set.image_path = str(tmp_path / "map.exr")
    scene.panorama_set.result.is_solved = True
    scene.render.engine = "CYCLES"
    return scene, here


def test_light_from_infinity_needs_no_surfaces(fresh_blend, lit_place):
    scene, here = lit_place
    for thing in list(here.surfaces.all_objects):
        fresh_blend.data.objects.remove(thing)
    assert fresh_blend.ops.panorama.light_from_infinity() == {"FINISHED"}
    assert len(here.suns.objects) >= 1
    assert scene.world.cycles.sampling_method == "NONE"
    assert "% of the light" in scene.panorama_set.job.lights_at_infinity
    scene.panorama_set.job.lights = "NONE"
    fresh_blend.ops.panorama.light_from_infinity()
    assert not here.suns.objects
    assert scene.world.cycles.sampling_method == "MANUAL"


def test_the_artist_sees_the_suns_only_where_they_light(fresh_blend, lit_place):
    from expanded_panoramas.cycles_integration import methods, preparation
    from expanded_panoramas.cycles_integration.view_layers import layer_collection

    scene, here = lit_place
    own = scene.view_layers[0]
    preparation.IRRADIANCE_WIDTH, kept = 32, preparation.IRRADIANCE_WIDTH
    try:
        preparation.prepare(scene)
    finally:
        preparation.IRRADIANCE_WIDTH = kept
    assert layer_collection(own, here.suns).exclude
    methods.set_up(scene, here, methods.DIRECTIONAL)
    assert not layer_collection(own, here.suns).exclude
    methods.set_up(scene, here, methods.CATCHER)
    assert layer_collection(own, here.suns).exclude


@pytest.mark.parametrize(("known", "value"), [("IRRADIANCE", 3.0), ("RATIO", 400.0)])
def test_a_clipped_lamp_is_restored_into_a_new_file(fresh_blend, lit_place, tmp_path, known, value):
    scene, here = lit_place
    target = tmp_path / "restored.exr"
    done = fresh_blend.ops.panorama.restore_light(filepath=str(target), known=known, value=value)
    assert done == {"FINISHED"}
    image = read_panorama(target)
    assert image[40, 40] == pytest.approx([0.002] * 3, rel=1e-3)
    assert image[22, 65].min() > 20
    assert here.image.filepath.endswith("restored.exr")
    assert scene.panorama_set.image_path == str(target)
    assert scene.panorama_set.maps_are_old


def test_less_light_than_there_is_is_refused(fresh_blend, lit_place, tmp_path):
    with pytest.raises(RuntimeError, match="cannot have brought less"):
        fresh_blend.ops.panorama.restore_light(
            filepath=str(tmp_path / "restored.exr"), known="IRRADIANCE", value=1e-3
        )
    assert not (tmp_path / "restored.exr").exists()
