"""Folders of layers: out and in again, all or nothing, and what is refused."""

import cv2
import numpy as np
import OpenEXR
import pytest

from expanded_panoramas.ibl_toolkit.images import read_photo_sphere, write_exr
from expanded_panoramas.ibl_toolkit.layers.errors import LayersError
from expanded_panoramas.ibl_toolkit.layers.files import storage
from expanded_panoramas.ibl_toolkit.layers.files.storage import read_layers, write_layers
from expanded_panoramas.ibl_toolkit.layers.panorama import Layer, LayeredPanorama

ROTATION = cv2.Rodrigues(np.array([0.2, -0.5, 1.1]))[0]
EXACT = 1e-14


def object_mask(height, width):
    mask = np.zeros((height, width), bool)
    mask[9:15, -4:] = mask[10:14, :3] = mask[25:30, 20:24] = True
    return mask


def attributes(height, width, mask, only=None):
    """Every attribute, of values that halves hold exactly."""
    rng = np.random.default_rng(5)
    colour = rng.integers(0, 1024, (3, height, width, 3)).astype(np.float32) / 64
    depth = rng.uniform(0.5, 20, (height, width)).astype(np.float32)
    depth[rng.uniform(size=depth.shape) < 0.1] = np.inf
    depth[~mask] = np.nan
    every = {
        "radiance": colour[0],
        "depth": depth,
        "diffuse light": colour[1],
        "normals": rng.choice(np.float32([-1, 1]), (height, width, 1)) * np.float32([0, 0, 1]),
        "reflectivity": rng.integers(0, 65, (height, width)).astype(np.float32) / 64,
        "material index": rng.integers(0, 2**32, (height, width), dtype=np.uint64).astype(np.uint32),
        "emission": colour[2],
        "mask": mask,
    }
    return {name: every[name] for name in only or every}


def example():
    """A background of all directions and objects of their own resolution, in two mappings."""
    everywhere = np.ones((16, 32), bool)
    back = Layer("Background", "equirectangular", attributes(16, 32, everywhere, ("radiance", "depth")))
    front = Layer("sofa & ../lamp", "equirectangular", attributes(32, 64, object_mask(32, 64)))
    cube = Layer("cube", "cube map", attributes(32, 48, object_mask(32, 48)))
    return LayeredPanorama((back, front, cube), ROTATION, np.array([1.0, -2.0, 1.15]), 0.5)


def assert_same_inside(got, expected):
    assert (got.name, got.mapping) == (expected.name, expected.mapping)
    assert got.attributes.keys() == expected.attributes.keys()
    np.testing.assert_array_equal(got.mask, expected.mask)
    for name, values in expected.attributes.items():
        assert got.attributes[name].dtype == values.dtype
        np.testing.assert_array_equal(got.attributes[name][expected.mask], values[expected.mask])


def exr_channels(folder):
    """Channel name -> pixels of every OpenEXR file of a folder, by file name."""
    files = {path.name: OpenEXR.File(str(path), separate_channels=True) for path in folder.glob("*.exr")}
    return {
        name: {channel: c.pixels for channel, c in file.channels().items()} for name, file in files.items()
    }


def test_round_trip(tmp_path):
    panorama = example()
    assert write_layers(panorama, tmp_path / "new" / "folder") == tmp_path / "new" / "folder" / "panorama.xml"
    got = read_layers(tmp_path / "new" / "folder")
    for layer, expected in zip(got.layers, panorama.layers, strict=True):
        assert_same_inside(layer, expected)
    np.testing.assert_allclose(got.world_from_panorama, ROTATION, atol=EXACT)
    np.testing.assert_array_equal(got.origin, panorama.origin)
    assert got.radius == 0.5


def test_only_what_is_in_the_domain_is_stored(tmp_path):
    write_layers(example(), tmp_path)
    files = exr_channels(tmp_path)
    assert files["0_Background.exr"]["R"].shape == (16, 32)
    for stem in ("1_sofa_lamp", "2_cube"):
        assert files[f"{stem}_d.exr"]["Z"].size < 100  # of 62 px of domain


def test_types_in_the_files(tmp_path):
    panorama = example()
    panorama.layers[0].radiance[3, 4, 1] = 1e5  # beyond half floats
    write_layers(panorama, tmp_path)
    types = {
        name: {channel: pixels.dtype for channel, pixels in channels.items()}
        for name, channels in exr_channels(tmp_path).items()
    }
    assert types["0_Background.exr"] == dict.fromkeys("RGB", np.float32)
    assert types["1_sofa_lamp.exr"] == dict.fromkeys("RGB", np.float16)
    assert types["1_sofa_lamp_n.exr"] == dict.fromkeys("XYZ", np.float16)
    assert types["1_sofa_lamp_d.exr"] == {"Z": np.float32}
    assert types["1_sofa_lamp_materials.exr"] == {"material": np.uint32}
    np.testing.assert_array_equal(read_layers(tmp_path).layers[0].radiance, panorama.layers[0].radiance)


def test_ldr(tmp_path):
    panorama = example()
    write_layers(panorama, tmp_path, ldr=True, exposure=1 / 16)
    assert {"0_Background.png", "0_Background_d.exr"} <= {path.name for path in tmp_path.iterdir()}
    for layer, expected in zip(read_layers(tmp_path).layers, panorama.layers, strict=True):
        mask = expected.mask
        np.testing.assert_array_equal(layer.depth[mask], expected.depth[mask])
        np.testing.assert_array_equal(layer.mask, mask)
        # Half a step of 1/255 at the steepest of the sRGB curve, 2.275, divided by the exposure.
        np.testing.assert_allclose(layer.radiance[mask], expected.radiance[mask], atol=16 * 2.28 * 0.5 / 255)
        assert layer.radiance.dtype == np.float32


def test_mip_levels(tmp_path):
    panorama = example()
    write_layers(panorama, tmp_path, levels=3)
    assert [layer.size for layer in read_layers(tmp_path, level=1).layers] == [(16, 8), (32, 16), (24, 16)]
    coarse = read_layers(tmp_path, level=2).layers[0]
    blocks = 1 / panorama.layers[0].depth.reshape(4, 4, 8, 4)
    np.testing.assert_allclose(coarse.depth, 1 / blocks.mean(axis=(1, 3)), rtol=1e-6)
    assert read_layers(tmp_path, level=99).layers[0].size == coarse.size
    assert_same_inside(read_layers(tmp_path).layers[1], panorama.layers[1])


def test_a_printed_folder_is_read(tmp_path):
    """Colour as PNG, depth as OpenEXR, no names, no version: thesis, section 6.2.1."""
    depth = np.full((4, 8), 2.5, np.float32)
    depth[0] = np.nan
    write_exr(tmp_path / "Background_d.exr", {"Z": depth})
    cv2.imwrite(str(tmp_path / "Background.png"), np.full((4, 8, 3), (0, 188, 255), np.uint8))  # B G R
    (tmp_path / "panorama.xml").write_text(
        "<Panorama><TransformGroup><Translate vector='0 0 1.15' /><Scale vector='-1 1 1' /></TransformGroup>"
        "<Mapping type='LatLongMapping' /><Freedom radius='0.5' /><Layer><Textures mapname='Background.png' "
        "depthname='Background_d.exr' normals='' /></Layer></Panorama>"
    )
    (layer,) = read_layers(tmp_path / "panorama.xml").layers
    np.testing.assert_array_equal(layer.depth, depth)
    np.testing.assert_allclose(layer.radiance[2, 3], [1, 0.5029, 0], atol=1e-4)  # sRGB 188 is 0.5029


def test_writing_again_leaves_nothing_of_the_old(tmp_path):
    write_layers(example(), tmp_path)
    first = {path.name for path in tmp_path.iterdir()}
    (tmp_path / "notes.txt").write_text("mine")
    write_layers(example(), tmp_path)
    second = {path.name for path in tmp_path.iterdir()} - {"notes.txt"}
    assert first & second == {"panorama.xml"}
    write_layers(example(), tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == first | {"notes.txt"}
    assert len(read_layers(tmp_path).layers) == 3


def test_images_by_other_hands_stay(tmp_path):
    test_a_printed_folder_is_read(tmp_path)
    write_layers(example(), tmp_path)
    assert {"Background.png", "Background_d.exr"} <= {path.name for path in tmp_path.iterdir()}


@pytest.mark.parametrize("at", [1, 5, 10])
def test_an_interrupted_write_leaves_the_old(tmp_path, monkeypatch, at):
    write_layers(example(), tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    calls = []
    write_image = storage.write_image

    def interrupted(*arguments):
        calls.append(1)
        if len(calls) == at:
            raise KeyboardInterrupt
        write_image(*arguments)

    monkeypatch.setattr(storage, "write_image", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_layers(example(), tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_an_interrupt_after_the_last_step_leaves_the_new(tmp_path, monkeypatch):
    write_layers(example(), tmp_path)
    before = {path.name for path in tmp_path.iterdir()} - {"panorama.xml"}
    write_xml = storage.write_xml

    def interrupted(*arguments):
        write_xml(*arguments)
        raise KeyboardInterrupt

    monkeypatch.setattr(storage, "write_xml", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_layers(example(), tmp_path)
    assert len(read_layers(tmp_path).layers) == 3
    assert before.isdisjoint(path.name for path in tmp_path.iterdir())


def test_names_that_differ_by_case_alone_are_one_to_some_file_systems(tmp_path):
    depth = {"depth": np.full((4, 8), 2.0, np.float32)}
    names = []
    for name in ("Sofa", "sofa"):
        layer = Layer(name, "equirectangular", depth)
        write_layers(LayeredPanorama((layer,), ROTATION, np.zeros(3), 0.5), tmp_path)
        names.append({path.name.lower() for path in tmp_path.iterdir()} - {"panorama.xml"})
    assert names[0].isdisjoint(names[1])


def test_impossible_values_are_not_written(tmp_path):
    panorama = example()
    panorama.layers[0].radiance[2, 5] = np.nan
    with pytest.raises(ValueError, match=r"layer 'Background': radiance is NaN .* 1 pixels .* \(5, 2\)"):
        write_layers(panorama, tmp_path)
    with pytest.raises(ValueError, match="exposure 0 must be"):
        write_layers(example(), tmp_path, ldr=True, exposure=0)
    assert not list(tmp_path.iterdir())


def test_values_outside_of_the_domain_do_not_matter(tmp_path):
    panorama = example()
    layer = panorama.layers[1]
    layer.radiance[~layer.mask] = np.nan
    write_layers(panorama, tmp_path)
    got = read_layers(tmp_path).layers[1]
    assert_same_inside(got, layer)
    assert (got.radiance[~layer.mask] == 0).all()


def spoiled(tmp_path, name, spoil):
    write_layers(example(), tmp_path)
    path = tmp_path / name
    spoil(path)
    return tmp_path


def replaced(old, new):
    def spoil(path):
        text = path.read_text(encoding="iso-8859-1")
        assert old in text
        path.write_text(text.replace(old, new, 1), encoding="iso-8859-1")

    return spoil


def cut_short(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


@pytest.mark.parametrize(
    ("name", "spoil", "message"),
    [
        (
            "1_sofa_lamp_d.exr",
            lambda p: p.unlink(),
            r"Layer\[2\]/Textures, line \d+: depth: the file 1_sofa.* missing",
        ),
        ("1_sofa_lamp_d.exr", cut_short, r"Layer\[2\]/Textures, .*1_sofa_lamp_d\.exr: truncated"),
        ("1_sofa_lamp_mask.png", cut_short, r"1_sofa_lamp_mask\.png: truncated"),
        ("1_sofa_lamp_mask.png", lambda p: p.write_bytes(b"GIF89a"), "not a PNG file"),
        ("0_Background_d.exr", lambda p: p.write_bytes(b"GIF89a"), "depth must be an OpenEXR file"),
        (
            "0_Background_d.exr",
            lambda p: write_exr(p, {"Z": np.ones((16, 32), np.float16)}),
            "depth needs channels Z of 32-bit floats, found Z",
        ),
        (
            "0_Background.exr",
            lambda p: write_exr(p, {"G": np.ones((16, 32), np.float16)}),
            "radiance needs channels R G B, found G",
        ),
        (
            "0_Background_d.exr",
            lambda p: write_exr(p, {"Z": np.ones((8, 16), np.float32)}),
            "several sizes: radiance 32 x 16, depth 16 x 8",
        ),
        (
            "0_Background_d.exr",
            lambda p: write_exr(p, {"Z": np.zeros((16, 32), np.float32)}),
            "512 depths of its domain",
        ),
        (
            "0_Background.exr",
            lambda p: write_exr(p, dict.fromkeys("RGB", np.full((16, 32), np.inf, np.float32))),
            "radiance is NaN or infinite in 512 pixels",
        ),
        (
            "panorama.xml",
            replaced('width="64" height="32"', 'width="999998" height="499999"'),
            "GiB of memory",
        ),
        ("panorama.xml", replaced('width="64" height="32"', 'width="64" height="31"'), "must be 2:1"),
        ("panorama.xml", replaced('map="20 25"', 'map="70 25"'), r"patch \d+, .* leaves the map"),
        ("panorama.xml", replaced('atlas="0 0"', 'atlas="99 0"'), r"patch \d+, .* leaves the atlas"),
        (
            "panorama.xml",
            replaced('name="cube"', 'name="Background"'),
            "two layers have the name 'Background'",
        ),
    ],
)
def test_damaged_folders(tmp_path, name, spoil, message):
    with pytest.raises(LayersError, match=rf"panorama\.xml: .*{message}"):
        read_layers(spoiled(tmp_path, name, spoil))


def test_limit_to_memory_is_of_all_layers(tmp_path):
    write_layers(example(), tmp_path)
    needed = sum(values.nbytes for layer in example().layers for values in layer.attributes.values())
    read_layers(tmp_path, max_bytes=needed + 12 * 32 * 48)
    with pytest.raises(LayersError, match="GiB"):
        read_layers(tmp_path, max_bytes=needed - 1)


def test_no_folder(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_layers(tmp_path / "none")


def test_whole_pictures_of_8_bits_are_photo_spheres(tmp_path):
    """And no others: not those of objects, nor of a cube map, nor of other attributes."""
    write_layers(example(), tmp_path, ldr=True, exposure=0.1)
    spheres = {path.name: read_photo_sphere(path) for path in tmp_path.glob("*.png")}
    assert [name for name, sphere in spheres.items() if sphere is not None] == ["0_Background.png"]
    sphere = spheres["0_Background.png"]
    assert sphere.full_size == sphere.size == (32, 16)
    np.testing.assert_allclose(sphere.world_from_panorama, ROTATION, atol=1e-5)
