"""Lights from photographs of balls with known lights, and what is said where a photograph tells none."""

import cv2
import numpy as np
import pytest
from probe_photos import (
    Desk,
    Lamp,
    angle_deg,
    ball_of_pixels,
    codes,
    degraded,
    desk_before,
    even_room,
    hdr,
    ldr,
    photograph,
    unit,
)

from expanded_panoramas.ibl_toolkit.images import ImageError, write_exr
from expanded_panoramas.ibl_toolkit.mobile.probe import (
    Ball,
    PhotoCamera,
    ProbeError,
    estimate_lights,
    find_marker,
    place_ball,
    read_photo,
)
from expanded_panoramas.ibl_toolkit.mobile.probe.components import maximum_components
from expanded_panoramas.ibl_toolkit.mobile.probe.mirror import reflected_centroid
from expanded_panoramas.ibl_toolkit.mobile.probe.samples import in_picture, on_ball
from expanded_panoramas.ibl_toolkit.mobile.probe.shading import fit_shading

CAMERA = PhotoCamera.from_fov(50, 240, 180)
BALL = ball_of_pixels(CAMERA, 100, (0.06, -0.04))
LAMPS = [
    Lamp(unit([0.5, -0.7, -0.3])),
    Lamp(unit([-0.8, -0.4, 0.3]), 6, (20, 18, 12)),
    Lamp(unit([-0.2, -0.6, -0.8]), 3, (30, 30, 40)),
]
BRIGHT = [Lamp(lamp.direction, lamp.radius_deg, tuple(4 * r for r in lamp.radiance)) for lamp in LAMPS]


@pytest.fixture(scope="module")
def mirror_image():
    return photograph(CAMERA, BALL, LAMPS, fine=3)


@pytest.fixture(scope="module")
def diffuse_image():
    return photograph(CAMERA, BALL, BRIGHT, kind="diffuse", fine=3)


def errors(lights, lamps):
    """Of each lamp, the angle [°] of the nearest light."""
    return [min(angle_deg(light.direction, lamp.direction) for light in lights) for lamp in lamps]


@pytest.mark.parametrize("domain", ["image", "sphere"])
def test_a_mirror_ball_shows_direction_colour_strength_and_size(mirror_image, domain):
    found = estimate_lights(hdr(mirror_image), CAMERA, BALL, count=8, domain=domain)
    assert len(found.lights) == 3
    for light, lamp in zip(found.lights, LAMPS, strict=True):  # in order of strength
        assert angle_deg(light.direction, lamp.direction) < 0.2
        # The sphere's domain takes bilinear samples, few of a small lamp: 15 %.
        np.testing.assert_allclose(light.irradiance, lamp.irradiance * (0.75, 0.72, 0.7), rtol=0.15)
        assert 2 * lamp.radius_deg * 0.7 < light.diameter_deg < 2 * lamp.radius_deg * 1.5
    assert found.lights[1].colour[0] == 1
    assert len(estimate_lights(hdr(mirror_image), CAMERA, BALL, count=1, domain=domain).lights) == 1


def test_a_clipped_photograph_says_so(mirror_image):
    found = estimate_lights(ldr(degraded(mirror_image, blur_px=0.7, noise=0.02)), CAMERA, BALL, count=8)
    assert len(found.lights) == 3
    assert max(errors(found.lights, LAMPS)) < 1
    assert all(light.is_clipped for light in found.lights)
    assert any("clipped; colour and strength are lower limits" in text for text in found.warnings)
    dark = estimate_lights(ldr(mirror_image, 0.01), CAMERA, BALL, count=1)
    assert not dark.lights[0].is_clipped
    assert not dark.warnings


def test_components_at_the_highest_luminance_are_the_papers(mirror_image):
    photo = ldr(mirror_image)
    for domain in (in_picture, on_ball):
        samples = domain(photo, CAMERA, BALL)
        parts = maximum_components(samples)
        sizes = [int(part.sum()) for part in parts]
        assert len(parts) == 3
        assert sizes == sorted(sizes, reverse=True)
        # Reflected at the centroid, with the sign of the errata: rougher than the mean of what is mirrored.
        directions = [reflected_centroid(BALL, CAMERA, samples, part) for part in parts]
        assert max(min(angle_deg(d, lamp.direction) for d in directions) for lamp in LAMPS) < 1.5


def test_diagonal_pixels_do_not_connect():
    image = np.full((180, 240, 3), 0.1, np.float32)
    x, y = CAMERA.pixels(BALL.axis).astype(int)
    image[y, x] = image[y + 1, x + 1] = image[y + 10, x] = image[y + 10, x + 1] = 5
    parts = maximum_components(in_picture(hdr(image), CAMERA, BALL))
    assert [int(part.sum()) for part in parts] == [2, 1, 1]


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_diffuse_ball_is_explained_by_its_lights(count):
    image = photograph(CAMERA, BALL, BRIGHT[:count], kind="diffuse", ambient=0.1, fine=2)
    found = estimate_lights(hdr(image), CAMERA, BALL, "diffuse", count=4)
    assert len(found.lights) == count
    for light, lamp in zip(found.lights, BRIGHT, strict=False):
        assert angle_deg(light.direction, lamp.direction) < 0.2
        np.testing.assert_allclose(light.irradiance, lamp.irradiance / np.pi * (0.75, 0.72, 0.7), rtol=0.01)
    assert found.residual < 0.001
    assert not found.warnings


def test_a_diffuse_ball_with_noise_blur_clipping_and_a_stain(diffuse_image):
    image = degraded(diffuse_image, blur_px=1, noise=0.05, seed=3)
    x, y = CAMERA.pixels(BALL.axis).astype(int)
    image[y - 30 : y - 20, x : x + 10] *= 0.2  # a stain
    exposure = 1.0 / np.percentile(image[y - 40 : y + 40, x - 40 : x + 40], 90)  # a tenth is clipped
    found = estimate_lights(ldr(image, exposure), CAMERA, BALL, "diffuse", count=2)
    assert errors(found.lights, BRIGHT[:2]) == pytest.approx([0, 0], abs=1.5)
    assert any("counts as a lower limit" in text for text in found.warnings)


def test_a_sky_above_is_not_the_sun():
    """A hemisphere of light beside one lamp, whose direction a constant ambient term puts 11° off."""
    lamp = Lamp(unit([0.9, -0.1, -0.2]), 4, (160, 160, 160))
    image = photograph(CAMERA, BALL, [lamp], kind="diffuse", fine=1)
    samples = in_picture(hdr(image), CAMERA, BALL)
    (x, y), (height, width) = samples.corner, samples.mask.shape
    sky = 0.11 * (1 - np.nan_to_num(samples.normals[..., 1])) * samples.mask
    image[y : y + height, x : x + width] += sky[..., None]
    found = estimate_lights(hdr(image), CAMERA, BALL, "diffuse", count=2)
    assert len(found.lights) == 1
    assert errors(found.lights, [lamp])[0] < 0.3
    np.testing.assert_allclose(
        found.lights[0].irradiance, lamp.irradiance / np.pi * (0.75, 0.72, 0.7), rtol=0.03
    )


def test_lights_without_use_are_not_added():
    turn = np.random.default_rng(1).normal(size=(2000, 3))
    normals = turn / np.linalg.norm(turn, axis=1, keepdims=True) * np.sign(turn[:, 2:])
    luminance = 0.3 + np.maximum(normals @ (0.6, 0.0, 0.5), 0)
    luminance += np.random.default_rng(2).normal(0, 0.02, len(luminance))
    shading = fit_shading(normals, luminance, 2)
    assert len(shading.vectors) == 1
    np.testing.assert_allclose(shading.vectors[0], (0.6, 0.0, 0.5), atol=0.01)
    np.testing.assert_allclose(shading.ambient, (0.3, 0, 0, 0), atol=0.01)
    assert shading.uncertainty_deg[0] < 0.5


def test_a_light_that_could_be_turned_round_is_doubted():
    """A weak one from the left, or from the right and the strong one further left: it looks the same."""
    turn = np.random.default_rng(1).normal(size=(3000, 3))
    normals = turn / np.linalg.norm(turn, axis=1, keepdims=True)
    normals = normals[normals[:, 2] > 0.3]
    weak, strong = np.array([-0.25, 0.0, 0.02]), np.array([0.0, 0.0, 1.0])
    luminance = 0.2 + np.maximum(normals @ weak, 0) + np.maximum(normals @ strong, 0)
    turned = 0.2 + np.maximum(normals @ -weak, 0) + np.maximum(normals @ (strong + weak), 0)
    np.testing.assert_allclose(turned, luminance)
    shading = fit_shading(normals, luminance / luminance.mean(), 3)
    strongest = np.argmax(np.linalg.norm(shading.vectors, axis=1))
    assert angle_deg(shading.vectors[strongest], strong) < 1  # of the two, that with less light in all
    assert shading.uncertainty_deg[strongest] == pytest.approx(angle_deg(strong, strong + weak), abs=1)
    assert shading.uncertainty_deg[1 - strongest] > 45


def test_two_exposures_of_one_photograph_agree(mirror_image):
    one, other = (estimate_lights(hdr(k * mirror_image), CAMERA, BALL) for k in (1, 1000))
    for a, b in zip(one.lights, other.lights, strict=True):
        assert angle_deg(a.direction, b.direction) < 1e-3
        np.testing.assert_allclose(1000 * a.irradiance, b.irradiance, rtol=1e-4)


def test_the_outline_is_found_without_a_marker(mirror_image, diffuse_image):
    for image, exposure in ((mirror_image, 1.0), (diffuse_image, 0.3)):
        photo = ldr(degraded(image, blur_px=0.7, noise=0.02), exposure)
        placed = place_ball(photo, CAMERA)
        assert placed.by == "edges"
        assert not placed.is_metric
        off = np.linalg.norm(CAMERA.pixels(placed.ball.axis) - CAMERA.pixels(BALL.axis))
        assert off < 0.6
        assert placed.ball.distance == pytest.approx(BALL.distance / BALL.radius, rel=0.02)


def test_given_points_place_the_ball():
    points = CAMERA.pixels(BALL.outline(6))
    placed = place_ball(ldr(np.zeros((180, 240, 3))), CAMERA, points=points, radius=0.05)
    np.testing.assert_allclose(placed.ball.centre, BALL.centre, rtol=1e-6)
    assert placed.is_metric
    assert placed.residual_px < 1e-6
    rough = place_ball(ldr(np.zeros((180, 240, 3))), CAMERA, points=points + [[3, 0], [-3, 0]] * 3)
    assert any("px off" in text for text in rough.warnings)


def test_a_marker_places_the_ball_and_gives_the_frame():
    camera = PhotoCamera.from_fov(42, 480, 360)
    desk = desk_before()
    true = Ball(desk.to_camera((0.12, 0.02, 0.05)), 0.05)
    lamp = Lamp(desk.camera_from_marker @ unit([0.5, 0.3, 0.03]))
    photo = hdr(degraded(photograph(camera, true, [lamp], desk=desk, fine=3), blur_px=0.5, noise=0.01))
    pose = find_marker(photo, camera, desk.side)
    placed = place_ball(photo, camera, pose=pose, radius=0.05, centre=(0.12, 0.02, 0.05))
    assert placed.by == "marker"
    assert not placed.warnings
    found = estimate_lights(photo, camera, placed.ball, pose=pose)
    assert angle_deg(found.lights[0].direction, lamp.direction) < 1
    assert any("light 1 stands 3" in text and "times as long" in text for text in found.warnings)
    elsewhere = place_ball(photo, camera, pose=pose, radius=0.05, centre=(0.128, 0.02, 0.05))
    assert any("beside where the marker puts it" in text for text in elsewhere.warnings)


def test_how_a_ball_can_be_placed():
    photo = ldr(np.zeros((180, 240, 3)))
    pose = find_marker(
        hdr(photograph(PhotoCamera.from_fov(45, 320, 240), None, [], desk=desk_before(), fine=2)),
        PhotoCamera.from_fov(45, 320, 240),
        0.1,
    )
    for what, how in (
        ("a marker is needed", {"centre": (0, 0, 0.1), "radius": 0.1}),
        ("its radius is needed", {"centre": (0, 0, 0.1), "pose": pose}),
        ("only one of them", {"centre": (0, 0, 0.1), "radius": 0.1, "pose": pose, "points": [[0, 0]]}),
        ("no outline of a ball", {}),
    ):
        with pytest.raises(ProbeError, match=what):
            place_ball(photo, CAMERA, **how)


def test_light_behind_the_camera_and_behind_the_ball():
    behind_camera = [Lamp(unit([0.1, -0.15, -1]), 3)]
    # On a mirror ball it is in the middle; on a matt one all of it is lit, and the shading tells it still.
    image = photograph(CAMERA, BALL, behind_camera, fine=3)
    assert errors(estimate_lights(ldr(image), CAMERA, BALL).lights, behind_camera)[0] < 0.5
    image = photograph(CAMERA, BALL, [Lamp(behind_camera[0].direction, 3, (300, 300, 300))], kind="diffuse")
    found = estimate_lights(hdr(image), CAMERA, BALL, "diffuse")
    assert errors(found.lights, behind_camera)[0] < 0.5
    behind_ball = [Lamp(unit([0.75, -0.3, 1.0]), 4, (300, 300, 300))]
    image = photograph(CAMERA, BALL, behind_ball, fine=3)
    assert errors(estimate_lights(hdr(image), CAMERA, BALL).lights, behind_ball)[0] < 1  # near the rim
    image = photograph(
        CAMERA, BALL, [Lamp(unit([0.7, -0.1, 1.0]), 4, (900, 900, 900))], kind="diffuse", fine=3
    )
    found = estimate_lights(hdr(image), CAMERA, BALL, "diffuse", count=1)
    assert any("its rim: it stands behind the ball" in text for text in found.warnings)


@pytest.mark.parametrize(
    ("kind", "make", "what"),
    [
        ("mirror", lambda: photograph(CAMERA, BALL, [], fine=1), "no highlight on the ball"),
        ("mirror", lambda: np.zeros((180, 240, 3)), "no highlight"),
        ("mirror", lambda: np.full((180, 240, 3), 2.0), "100% of the ball is saturated"),
        ("diffuse", lambda: np.full((180, 240, 3), 2.0), "100% of the ball is saturated"),
        ("diffuse", lambda: np.full((180, 240, 3), 0.5), "no shading on the ball"),
        ("diffuse", lambda: np.zeros((180, 240, 3)), "the ball is black"),
    ],
)
def test_photographs_that_tell_no_light(kind, make, what):
    with pytest.raises(ProbeError, match=what):
        estimate_lights(ldr(make()), CAMERA, BALL, kind)


def test_a_ball_cut_by_the_frame():
    lamp = Lamp(unit([-0.5, -0.6, -0.5]))
    cut = ball_of_pixels(CAMERA, 100, (0.4, 0.0))
    photo = hdr(photograph(CAMERA, cut, [lamp], fine=3))
    placed = place_ball(photo, CAMERA, points=CAMERA.pixels(cut.outline())[::10])
    assert any("the frame cuts the ball" in text for text in placed.warnings)
    assert errors(estimate_lights(photo, CAMERA, placed.ball).lights, [lamp])[0] < 0.5
    with pytest.raises(ProbeError, match="of its outline is in the photograph"):
        estimate_lights(photo, CAMERA, ball_of_pixels(CAMERA, 100, (0.55, 0.0)))
    with pytest.raises(ProbeError, match="are needed"):
        estimate_lights(photo, CAMERA, ball_of_pixels(CAMERA, 6))


def test_the_wrong_kind_of_ball_is_doubted(mirror_image):
    side = photograph(
        CAMERA, BALL, [Lamp(unit([1, -0.6, 0.4]), 3, (300,) * 3)], kind="diffuse", ambient=0.001
    )
    assert any("wide" in text for text in estimate_lights(hdr(side), CAMERA, BALL).warnings)
    taken_for_matt = estimate_lights(ldr(mirror_image), CAMERA, BALL, "diffuse", count=1)
    assert any("not matt" in text for text in taken_for_matt.warnings)


def test_a_light_at_the_rim_is_doubted():
    hidden = Lamp(unit(BALL.axis + np.array([0.5, 0.0, 0.0])), 5, (400, 400, 400))
    image = photograph(CAMERA, BALL, [hidden], environment=even_room)
    warnings = estimate_lights(hdr(image), CAMERA, BALL).warnings
    assert any("ends at the rim" in text for text in warnings)


def test_orders_that_make_no_sense(mirror_image):
    for how, what in (({"kind": "glass"}, "glass"), ({"domain": "uv"}, "uv"), ({"count": 0}, "0 lights")):
        with pytest.raises(ProbeError, match=what):
            estimate_lights(hdr(mirror_image), CAMERA, BALL, **how)


def test_files_of_photographs(tmp_path, mirror_image):
    small = mirror_image[60:80, 60:90]
    write_exr(tmp_path / "a.exr", {name: np.ascontiguousarray(small[..., k]) for k, name in enumerate("RGB")})
    np.testing.assert_array_equal(read_photo(tmp_path / "a.exr").image, small)
    cv2.imwrite(str(tmp_path / "a.hdr"), small[..., ::-1])
    np.testing.assert_allclose(read_photo(tmp_path / "a.hdr").image, small, rtol=0.02, atol=0.01)
    encoded = codes(small)
    cv2.imwrite(str(tmp_path / "a.png"), (encoded[..., ::-1] * 255).round().astype(np.uint8))
    cv2.imwrite(str(tmp_path / "b.png"), (encoded[..., ::-1] * 65535).round().astype(np.uint16))
    for name in ("a.png", "b.png"):
        photo = read_photo(tmp_path / name)
        assert not photo.is_hdr
        assert photo.size == (30, 20)
        np.testing.assert_allclose(photo.image, np.minimum(small, 1), atol=0.006)
    (tmp_path / "c.png").write_bytes(b"no picture")
    with pytest.raises(ImageError, match="c.png: not a picture"):
        read_photo(tmp_path / "c.png")
    bad = small.copy()
    bad[3, 4] = np.nan
    write_exr(tmp_path / "d.exr", {name: np.ascontiguousarray(bad[..., k]) for k, name in enumerate("RGB")})
    with pytest.raises(ImageError, match="d.exr: .*NaN"):
        read_photo(tmp_path / "d.exr")


def test_the_desks_light_reaches_the_ball_only_through_reflection():
    """The tracer itself: a mirror ball on a desk shows the desk below its horizon."""
    camera = PhotoCamera.from_fov(30, 120, 90)
    desk = Desk(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), np.array([0.0, 0.2, 1.5]), half_size=5)
    ball = Ball(np.array([0.0, 0.1, 1.5]), 0.1)
    image = photograph(camera, ball, [], desk=desk, environment=even_room, reflectance=(1, 1, 1))
    below, above = camera.pixels(ball.centre + np.array([[0, 0.07, -0.06], [0, -0.05, -0.06]]))
    assert image[int(below[1]), int(below[0])].mean() != pytest.approx(0.3, abs=0.005)
    assert image[int(above[1]), int(above[0])].mean() == pytest.approx(0.3)
