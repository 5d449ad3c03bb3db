"""A ball before a camera: its outline's cone, what it mirrors, its unwrapping, marker poses, shadows."""

import numpy as np
import pytest
from probe_photos import Lamp, angle_deg, desk_before, hdr, ldr, photograph, surroundings, unit

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.mobile.probe import (
    PANORAMA_FROM_CAMERA,
    Ball,
    PhotoCamera,
    ProbeError,
    ball_from_ellipse,
    ball_from_rays,
    find_marker,
    light_from_shadow,
    unwrap,
)
from expanded_panoramas.ibl_toolkit.mobile.probe.ball import reflected
from expanded_panoramas.ibl_toolkit.mobile.probe.samples import normal_of_uv, on_ball
from expanded_panoramas.ibl_toolkit.mobile.probe.square_sides import measured_corners
from expanded_panoramas.ibl_toolkit.mobile.probe.unwrap import normal_angle

LENS = (-0.25, 0.08, 0.001, -0.002, 0.0)
CAMERA = PhotoCamera.from_fov(60, 320, 240)


@pytest.mark.parametrize("distortion", [(), LENS])
def test_pixels_and_rays_are_inverse(distortion):
    camera = PhotoCamera((300.0, 310.0), (150.0, 130.0), 320, 240, distortion)
    xy = np.random.default_rng(0).uniform((0, 0), (320, 240), (50, 2))
    np.testing.assert_allclose(camera.pixels(camera.rays(xy)), xy, atol=1e-6)


def test_the_principal_point_is_seen_straight_ahead_as_pixel_centres_are_at_a_half():
    np.testing.assert_allclose(CAMERA.rays([160.0, 120.0]), [0, 0, 1])
    np.testing.assert_allclose(CAMERA.matrix[:2, 2], [159.5, 119.5])  # OpenCV's own convention


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda: PhotoCamera.from_fov(180, 320, 240), "field of view 180"),
        (lambda: PhotoCamera.from_focal(0, 320, 240), "focal length"),
        (lambda: PhotoCamera.from_focal(300, 0, 240), "picture of 0 × 240"),
        (lambda: PhotoCamera.from_focal(300, 320, 240, distortion=(1, 2, 3)), "distortion"),
        (lambda: Ball(np.array([0, 0, -2.0]), 1), "behind the camera"),
        (lambda: Ball(np.array([0, 0, 2.0]), 2.5), "lies in the ball"),
        (lambda: Ball(np.array([0, 0, 2.0]), -1), "radius -1"),
        (lambda: ball_from_rays([[0, 0, 1], [0.1, 0, 1]]), "2 points"),
        (lambda: ball_from_rays(CAMERA.rays([[10, 20], [20, 20], [30, 20]])), "on one line"),
        (lambda: ball_from_ellipse(CAMERA, (100, 100), (20, 0), 0), "semi-axes"),
    ],
)
def test_what_cannot_be_is_refused(make, what):
    with pytest.raises(ProbeError, match=what):
        make()


def test_a_ball_off_the_middle_is_seen_as_an_ellipse_that_gives_it_back():
    ball = Ball(np.array([0.9, -0.5, 2.0]), 0.4)
    xy = CAMERA.pixels(ball.outline(400))
    centre = (xy.max(axis=0) + xy.min(axis=0)) / 2
    # The image of a sphere is longest along the line to the principal point; its centre is not the ball's.
    spread = np.linalg.svd(xy - xy.mean(axis=0), compute_uv=False)
    assert spread[0] > 1.05 * spread[1]
    assert np.linalg.norm(centre - CAMERA.pixels(ball.axis)) > 1.5
    along = unit(np.array([0.9, -0.5]))
    off = xy - (160, 120)
    ends = (off @ along).min(), (off @ along).max()
    middle = (160, 120) + along * np.mean(ends)
    long = (ends[1] - ends[0]) / 2
    short = np.abs(off @ (-along[1], along[0])).max()
    found = ball_from_ellipse(CAMERA, middle, (long, short), np.degrees(np.arctan2(along[1], along[0])))
    assert angle_deg(found.centre, ball.centre) < 1e-3
    assert found.distance == pytest.approx(ball.distance / ball.radius, rel=2e-5)


def test_normals_and_reflections_obey_the_law():
    ball = Ball(np.array([0.2, 0.1, 3.0]), 0.5)
    rays = np.stack([unit(ball.centre + np.array([x, 0.2, 0])) for x in (-0.3, 0.0, 0.3)])
    normals = ball.normals(rays)
    points = ball.centre + ball.radius * normals
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
    np.testing.assert_allclose(np.cross(points, rays), 0, atol=1e-12)
    assert (np.sum(normals * rays, axis=1) < 0).all()  # the near side
    mirrored = reflected(rays, normals)
    np.testing.assert_allclose(np.sum(mirrored * normals, axis=1), -np.sum(rays * normals, axis=1))
    np.testing.assert_allclose(np.cross(mirrored - rays, normals), 0, atol=1e-12)
    assert np.isnan(ball.normals([0.0, 1.0, 0.0])).all()


@pytest.mark.parametrize("distance", [1.05, 2.0, 10.0, 1e4])
@pytest.mark.parametrize("surroundings_at", [np.inf, 3.0])
def test_the_mirror_equation_is_solved_at_any_distance(distance, surroundings_at):
    theta = np.linspace(0, np.arccos(1 / distance) * 0.999, 60)
    normal = np.stack([np.cos(theta), np.sin(theta)], axis=1)  # the camera stands at (distance, 0)
    ray = normal - (distance, 0)
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    mirrored = ray - 2 * np.sum(ray * normal, axis=1, keepdims=True) * normal
    if np.isfinite(surroundings_at):
        along = np.sum(mirrored * normal, axis=1)
        reach = -along + np.sqrt(along**2 + surroundings_at**2 - 1)
        mirrored = normal + reach[:, None] * mirrored
    psi = np.arctan2(mirrored[:, 1], mirrored[:, 0])
    np.testing.assert_allclose(normal_angle(psi, distance, surroundings_at), theta, atol=1e-8)


def test_the_blind_spot_is_as_wide_as_the_ball_is_seen():
    distance = 4.0
    blind = np.pi - np.arcsin(1 / distance)
    found = normal_angle(np.array([blind - 1e-6, blind + 1e-6]), distance)
    assert np.isfinite(found[0])
    assert np.isnan(found[1])
    with pytest.raises(ProbeError, match="above 1"):
        normal_angle(1.0, 0.9)


def test_an_unwrapped_ball_shows_what_is_around_it():
    ball = Ball(np.array([0.3, -0.2, 2.5]), 0.5)
    camera = PhotoCamera.from_fov(50, 400, 300)
    lamps = [Lamp(unit([0.6, -0.6, -0.3]), 12, (3, 2, 1)), Lamp(unit([-0.9, 0.1, 0.4]), 12, (1, 2, 3))]
    image = photograph(camera, ball, lamps, reflectance=(1, 1, 1), fine=3)
    width = 128
    found = unwrap(hdr(image), camera, ball, width)
    directions = equirectangular.pixel_directions(width, width // 2) @ PANORAMA_FROM_CAMERA
    true = surroundings(directions, lamps)
    away = np.degrees(np.arccos(np.clip(directions @ ball.axis, -1, 1)))
    off = away - np.degrees(ball.angular_radius)
    np.testing.assert_array_equal(found.known[np.abs(off) > 2], off[np.abs(off) > 2] > 0)
    sure = off > 12  # the ball's outermost pixels mirror many degrees
    error = np.abs(found.radiance - true).mean(axis=2)[sure]
    assert np.median(error) < 0.003
    assert np.mean(error > 0.1) < 0.01  # the lamps' rims
    assert (found.radiance[~found.known] == 0).all()
    with pytest.raises(ProbeError, match="width 127"):
        unwrap(hdr(image), camera, ball, 127)


def test_a_coarse_panorama_is_averaged_and_a_cut_ball_is_unknown_beyond():
    ball = Ball(np.array([0.62, 0.0, 2.0]), 0.3)
    camera = PhotoCamera.from_fov(40, 300, 200)
    image = photograph(camera, ball, [], environment=lambda d: np.full(d.shape, 0.5), reflectance=(1, 1, 1))
    found = unwrap(hdr(image), camera, ball, 32)
    blind = (1 - np.cos(ball.angular_radius)) / 2
    assert 0.03 < 1 - found.known.mean() - blind < 0.5
    np.testing.assert_allclose(found.radiance[found.known], 0.5, rtol=1e-3)


def test_the_balls_own_domain_faces_the_camera_and_its_solid_angles_make_what_it_mirrors():
    ball = Ball(np.array([0.4, 0.3, 2.0]), 0.5)
    np.testing.assert_allclose(normal_of_uv(ball, [0.5, 0.5]), -ball.axis, atol=1e-12)
    samples = on_ball(hdr(np.full((240, 320, 3), 0.5)), CAMERA, ball, 200)
    seen = 4 * np.pi - 2 * np.pi * (1 - np.cos(ball.angular_radius))
    rim = 0.06  # of it is left out as too slanted
    assert samples.solid_angle[samples.mask].sum() == pytest.approx(seen, rel=rim)


@pytest.mark.parametrize("distortion", [(), LENS])
def test_a_markers_pose(distortion):
    camera = PhotoCamera.from_fov(45, 480, 360, distortion=distortion)
    desk = desk_before()
    image = photograph(camera, None, [], desk=desk, fine=3)
    for photo in (hdr(image), ldr(image, 0.8)):
        check_pose(find_marker(photo, camera, desk.side), desk)


def check_pose(pose, desk):
    assert pose.id == 7
    assert angle_deg(pose.marker_from_camera[2], desk.camera_from_marker[:, 2]) < 0.25
    assert np.linalg.norm(pose.origin - desk.origin) < 0.002
    assert pose.residual_px < 0.2
    assert pose.warnings == ()
    np.testing.assert_allclose(pose.to_camera(pose.eye), 0, atol=1e-9)
    aim = desk.to_camera((0.1, 0.05, 0.0))
    np.testing.assert_allclose(pose.on_plane(unit(aim)), (0.1, 0.05, 0.0), atol=0.002)


def test_corners_stay_where_no_side_is_seen():
    corners = np.array([[40.0, 40], [80, 40], [80, 80], [40, 80]])
    flat = np.full((120, 120), 0.5, np.float32)
    np.testing.assert_array_equal(
        measured_corners(flat, PhotoCamera.from_fov(50, 120, 120), corners), corners
    )


def test_one_of_several_markers_must_be_named():
    camera = PhotoCamera.from_fov(45, 400, 300)
    desk = desk_before(ids=(3, 12), places=((-0.12, 0.0), (0.1, 0.0)))
    photo = hdr(photograph(camera, None, [], desk=desk, fine=2))
    with pytest.raises(ProbeError, match="markers 3, 12 are seen"):
        find_marker(photo, camera, 0.1)
    with pytest.raises(ProbeError, match="marker 4 is not seen; seen: 3, 12"):
        find_marker(photo, camera, 0.1, 4)
    pose = find_marker(photo, camera, 0.1, 12)
    np.testing.assert_allclose(pose.origin, desk.to_camera((0.1, 0, 0)), atol=0.003)
    with pytest.raises(ProbeError, match="no marker of dictionary 6X6_50"):
        find_marker(photo, camera, 0.1, dictionary="6X6_50")
    with pytest.raises(ProbeError, match="'9X9' is unknown"):
        find_marker(photo, camera, 0.1, dictionary="9X9")
    with pytest.raises(ProbeError, match="side -1"):
        find_marker(photo, camera, -1)


def test_one_marker_seen_twice_is_refused():
    camera = PhotoCamera.from_fov(45, 400, 300)
    desk = desk_before(ids=(5, 5), places=((-0.12, 0.0), (0.1, 0.0)))
    with pytest.raises(ProbeError, match="marker 5 is seen 2 times"):
        find_marker(hdr(photograph(camera, None, [], desk=desk, fine=2)), camera, 0.1)


def test_a_small_marker_is_doubted():
    camera = PhotoCamera.from_fov(60, 320, 240)
    desk = desk_before(side=0.075)
    pose = find_marker(hdr(photograph(camera, None, [], desk=desk, fine=4)), camera, 0.075)
    assert any("come nearer" in text for text in pose.warnings)


@pytest.fixture(scope="module")
def desk_photo():
    """Camera, desk, pose."""
    camera = PhotoCamera.from_fov(45, 400, 300)
    desk = desk_before()
    return camera, desk, find_marker(hdr(photograph(camera, None, [], desk=desk, fine=3)), camera, desk.side)


@pytest.mark.parametrize("light", [(0.5, 0.3, 0.8), (-0.4, -0.2, 0.3), (0.0, 0.0, 1.0)])
def test_a_shadow_tells_its_light(desk_photo, light):
    camera, desk, pose = desk_photo
    light, foot, height = unit(light), np.array([0.05, 0.1, 0.0]), 0.06
    tip = foot - light * height / light[2] + (0, 0, height)
    base, end = (camera.pixels(desk.to_camera(point)) for point in (foot, tip))
    found = light_from_shadow(camera, pose, base, end, height)
    assert angle_deg(found.direction, light) < 0.3
    assert found.altitude_deg == pytest.approx(np.degrees(np.arcsin(light[2])), abs=0.3)
    assert 0 < found.uncertainty_deg < 4
    assert found.warnings == ()


def test_a_shadow_without_end_and_a_low_one(desk_photo):
    camera, desk, pose = desk_photo
    base = camera.pixels(desk.to_camera((0, 0.1, 0)))
    horizon = camera.pixels(desk.camera_from_marker @ np.array([0, 1.0, 0.05]))
    with pytest.raises(ProbeError, match="above the horizon"):
        light_from_shadow(camera, pose, base, horizon, 0.06)
    far = camera.pixels(desk.to_camera((0, 1.2, 0)))
    (warning,) = light_from_shadow(camera, pose, base, far, 0.06).warnings
    assert "18 times as long" in warning
    with pytest.raises(ProbeError, match="height 0"):
        light_from_shadow(camera, pose, base, far, 0)
