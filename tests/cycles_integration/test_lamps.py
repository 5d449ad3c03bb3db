"""Lamps on the surfaces of a room light, and are mirrored, as the map does that they were taken from."""

from types import SimpleNamespace

import numpy as np
import panoramas
import pytest
import small_scenes
from mathutils import Vector

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.calibration.adjustment import rotation_from_vector
from expanded_panoramas.ibl_toolkit.metrics import psnr
from expanded_panoramas.sample_scenes import closed_room_truth

WIDTH, HEIGHT = 512, 256
LOW, HIGH = np.array([-2.0, -2.0, -1.5]), np.array([2.0, 2.0, 1.2])
"""Corners of the box room, from the panorama's origin [m]."""
EYE = 1.5
TURNS = {"level": np.eye(3), "tilted": rotation_from_vector([0.3, -0.2, 1.1])}
WALL_RADIANCE = 0.2
LAMP, LAMP_SIZE, LAMP_RADIANCE = (1.0, -0.3), 0.4, (60, 50, 40)
SIGMAS = 4.5
PLAIN_NOISE = 0.02  # relative, of the mean of 512 samples
LAMP_SHAPE = 0.015  # relative irradiance: outlines follow pixels of 2 cm
NEAR = 0.05  # relative, 5 cm before a lamp of 40 cm that is 20 pixels wide
MIRRORED, RIM_PIXELS = 0.005, 0.03  # of the brightest radiance; share of pixels that may differ more
GLOSSY_MEAN = 0.015  # relative
WHITE_DOT = 10  # times the median of its neighbours
EXACT = 2e-5
SINGLE_MEAN = 0.02
FAR, FAR_SINGLE = 40, 25  # [dB], against the photograph


def box_points():
    """Points (H, W, 3) [m] where each pixel's ray meets the box room, in the panorama frame, and normals."""
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    distances = np.where(directions > 0, HIGH, LOW) / directions
    axis = distances.argmin(axis=2)
    normals = -np.sign(directions) * (np.arange(3) == axis[..., None])
    return directions * distances.min(axis=2)[..., None], normals


def on_ceiling(points, centre=LAMP, size=LAMP_SIZE):
    """Pixels of a square on the ceiling."""
    near = (np.abs(points[..., :2] - centre) < size / 2).all(axis=2)
    return near & (points[..., 2] > HIGH[2] - 1e-6)


def lamp_map(*lamps):
    """Dark walls; a smoothly uneven lamp for each (centre, size, radiance), or the usual one."""
    points, _ = box_points()
    image = np.full((HEIGHT, WIDTH, 3), WALL_RADIANCE)
    for centre, size, radiance in lamps or ((LAMP, LAMP_SIZE, LAMP_RADIANCE),):
        pixels = on_ceiling(points, centre, size)
        slope = 1 + 0.3 * (points[pixels][:, :1] - centre[0]) / size
        image[pixels] = radiance * slope
    return image.astype(np.float32)


def irradiance(image, point, normal):
    """E (3,) in closed form, direct, of the map on the box room's walls, at a point of the panorama frame.

    A pixel sends M·cosθ_wall·dA·cosθ/r², where dA = z²dω/cosθ_seen.
    """
    points, normals = box_points()
    solid_angles = equirectangular.row_solid_angles(WIDTH, HEIGHT)[:, None]
    squared = (points**2).sum(axis=2)
    area = solid_angles * squared / (-(points * normals).sum(axis=2) / np.sqrt(squared))
    to_wall = points - point
    distance = np.linalg.norm(to_wall, axis=2)
    cosines = np.maximum(to_wall @ normal, 0) * np.maximum(-(to_wall * normals).sum(axis=2), 0) / distance**2
    return np.einsum("ij,ijk->k", area * cosines / distance**2, image)


@pytest.fixture(autouse=True)
def quick(request, monkeypatch):
    """The supports' irradiance is another test's."""
    if "fresh_blend" in request.fixturenames:
        from expanded_panoramas.cycles_integration import preparation

        monkeypatch.setattr(preparation, "IRRADIANCE_WIDTH", 32)
        monkeypatch.setattr(preparation, "IRRADIANCE_SAMPLES", 4)


def box_room(bpy, folder, image, turn=TURNS["level"], without=None):
    """A place whose surfaces are the sides of the box room, without that at one height [m]."""
    from expanded_panoramas.cycles_integration import place

    path = panoramas.write_panorama(folder / "room.exr", image)
    scene = bpy.context.scene
    calibration = SimpleNamespace(world_from_panorama=turn, camera_height=EYE)
    here = place.create_place(scene, str(path), calibration)
    bpy.context.view_layer.update()
    for axis, bound in [(axis, bound) for axis in range(3) for bound in (LOW, HIGH)]:
        if bound[axis] != without:
            others = [k for k in range(3) if k != axis]
            corners = np.tile(bound, (4, 1))
            corners[:, others[0]] = np.array([LOW, HIGH, HIGH, LOW])[:, others[0]]
            corners[:, others[1]] = np.array([LOW, LOW, HIGH, HIGH])[:, others[1]]
            add_surface(bpy, scene, here, corners)
    return scene, here


def add_surface(bpy, scene, here, corners, role="ENVIRONMENT"):
    """A real surface of one polygon, by its corners in the panorama frame."""
    world = [tuple(here.origin.matrix_world @ Vector(corner)) for corner in corners]
    mesh = bpy.data.meshes.new("side")
    mesh.from_pydata(world, [], [tuple(range(len(world)))])
    side = bpy.data.objects.new("side", mesh)
    side.panorama_role = role
    scene.collection.objects.link(side)
    return side


def prepare(scene, most=None):
    from expanded_panoramas.cycles_integration import preparation

    return preparation.prepare(scene, most)


def lit_plane(bpy, scene, here, point, normal=(0, 0, 1), size=0.04):
    """A small white diffuse square at a point of the panorama frame, which fills the camera's view."""
    frame = here.origin.matrix_world
    point, normal = frame @ Vector(point), frame.to_3x3() @ Vector(normal)
    matte = small_scenes.material(bpy, small_scenes.DIFFUSE)
    plane = small_scenes.add_plane(scene, matte, 2 * size, point, normal)
    camera = small_scenes.add_camera(bpy, scene, point + 0.02 * normal, point, width=size)
    return plane, camera


def rendered_irradiance(bpy, scene, here, folder, point, samples, normal=(0, 0, 1)):
    """E (3,) at a point by a render, and the error of its mean."""
    plane, camera = lit_plane(bpy, scene, here, point, normal)
    picture = small_scenes.render(scene, folder / "lit.exr", (8, 8), samples).reshape(-1, 3)
    for thing in (plane, camera):
        bpy.data.objects.remove(thing)
    return np.pi * picture.mean(axis=0), np.pi * picture.std(axis=0) / 8


def assert_lit(found, expected, tolerance):
    """A rendered (E, its error) is what it should be."""
    values, errors = found
    assert (np.abs(values - expected) < SIGMAS * errors + tolerance * expected).all(), values / expected
    assert (errors < tolerance * expected).all(), errors / expected


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
def test_direct_light_is_the_maps(fresh_blend, tmp_path, turn):
    """Below the lamp and beside it; the plain map's light is the same, with far more noise."""
    image = lamp_map()
    scene, here = box_room(fresh_blend, tmp_path, image, turn)
    below, beside = (1.0, -0.3, -0.5), (-1.2, 1.0, 0.2)
    for most, samples, point, tolerance in (
        (0, 512, below, PLAIN_NOISE),
        (None, 64, below, LAMP_SHAPE),
        (None, 64, beside, LAMP_SHAPE),
    ):
        assert prepare(scene, most).at_depth.count == (most is None)
        found = rendered_irradiance(fresh_blend, scene, here, tmp_path, point, samples)
        assert_lit(found, irradiance(image, point, (0, 0, 1)), tolerance)


def bent_lamp():
    """A strip over the edge of ceiling and wall."""
    image, (points, _) = lamp_map(), box_points()
    image[:] = WALL_RADIANCE
    image[(np.abs(points[..., 1]) < 0.3) & (points[..., 0] > 1.6) & (points[..., 2] > 0.8)] = 40
    return image


def hot_pixel():
    image = np.full((HEIGHT, WIDTH, 3), WALL_RADIANCE, np.float32)
    image[70, 300] = 2e4
    return image


@pytest.mark.parametrize(
    ("make", "least"),
    [
        (bent_lamp, 2),
        (hot_pixel, 1),
        (lambda: lamp_map(((-1.5, 0.0), 0.3, (40, 60, 80)), ((0.0, 0.0), 0.3, (30, 30, 30))), 2),
    ],
    ids=["bent", "hot pixel", "on the seam and at the zenith"],
)
def test_lamps_of_other_shapes_light_as_the_map(fresh_blend, tmp_path, make, least):
    image = make()
    scene, here = box_room(fresh_blend, tmp_path, image)
    assert prepare(scene).at_depth.count >= least
    for point, normal in (((0.2, 0.5, -0.8), (0, 0, 1)), ((-0.5, -0.8, 0.0), (0.6, 0, 0.8))):
        found = rendered_irradiance(fresh_blend, scene, here, tmp_path, point, 64, normal)
        assert_lit(found, irradiance(image, point, normal), 2 * LAMP_SHAPE)


def test_a_plane_nearer_to_a_lamp_than_its_size(fresh_blend, tmp_path):
    """5 cm before a lamp of 40 cm, at its middle and at its rim."""
    image = lamp_map()
    scene, here = box_room(fresh_blend, tmp_path, image)
    prepare(scene)
    for x in (LAMP[0], LAMP[0] + LAMP_SIZE / 2):
        point = (x, LAMP[1], HIGH[2] - 0.05)
        found = rendered_irradiance(fresh_blend, scene, here, tmp_path, point, 64)
        assert_lit(found, irradiance(image, point, (0, 0, 1)), NEAR)


def test_a_lamp_half_hidden_by_a_real_board(fresh_blend, tmp_path):
    """The half that the panorama saw shines, from behind the board's edge; the board shades it."""
    image, (points, _) = lamp_map(), box_points()
    with np.errstate(divide="ignore", invalid="ignore"):
        on_board = points * (0.9 / points[..., 2:])
    hidden = (points[..., 2] > 0.9) & (on_board[..., 0] > 0.2) & (on_board[..., 0] < 0.75)
    image[hidden & (np.abs(on_board[..., 1]) < 1.2)] = WALL_RADIANCE
    scene, here = box_room(fresh_blend, tmp_path, image)
    add_surface(
        fresh_blend, scene, here, [(0.2, -1.2, 0.9), (0.75, -1.2, 0.9), (0.75, 1.2, 0.9), (0.2, 1.2, 0.9)]
    )
    assert prepare(scene).at_depth.count == 1
    (lamp,) = here.lights.objects
    corners = np.array([vertex.co for vertex in lamp.data.vertices])
    assert np.allclose(corners[:, 2], HIGH[2], atol=0.01)
    assert corners[:, 0].min() == pytest.approx(LAMP[0], abs=0.03)
    sees, shaded = (1.5, -0.3, -0.2), (-1.0, -0.3, -0.2)
    found = rendered_irradiance(fresh_blend, scene, here, tmp_path, sees, 64)
    assert_lit(found, irradiance(image, sees, (0, 0, 1)), 2 * LAMP_SHAPE)
    found = rendered_irradiance(fresh_blend, scene, here, tmp_path, shaded, 64)
    assert found[0] == pytest.approx(np.pi * WALL_RADIANCE, rel=0.01)


def test_where_depth_is_missing_the_lamp_shines_from_infinity(fresh_blend, tmp_path):
    """Half of the ceiling is not rebuilt; each lamp lights once, from where it is known to be."""
    far = (-1.0, 0.3)
    image = lamp_map((LAMP, LAMP_SIZE, LAMP_RADIANCE), (far, LAMP_SIZE, LAMP_RADIANCE))
    scene, here = box_room(fresh_blend, tmp_path, image, without=HIGH[2])
    (x, y, z), (_, low, _) = HIGH, LOW
    add_surface(fresh_blend, scene, here, [(0, low, z), (x, low, z), (x, y, z), (0, y, z)])
    prepared = prepare(scene)
    assert prepared.at_depth.count == 1
    assert prepared.coverage < 0.95
    point = np.array([0.8, 0.0, -0.5])
    directions = equirectangular.pixel_directions(WIDTH, HEIGHT).astype(float)
    points, _ = box_points()
    is_far = on_ceiling(points, far)
    weights = np.where(is_far, np.maximum(directions[..., 2], 0), 0)
    weights *= equirectangular.row_solid_angles(WIDTH, HEIGHT)[:, None]
    at_infinity = np.einsum("ij,ijk->k", weights, image - WALL_RADIANCE)
    expected = irradiance(np.where(is_far[..., None], WALL_RADIANCE, image), point, (0, 0, 1)) + at_infinity
    found = rendered_irradiance(fresh_blend, scene, here, tmp_path, point, 256)
    assert_lit(found, expected, 2 * LAMP_SHAPE)


BESIDE, BELOW = (0.0, 1.1, 0.2), (0.0, 0.01, -0.8)


def pictures(bpy, scene, folder, material, size, samples, eye=BESIDE):
    """Of a ball near the lamp, plain and with lamps; ``eye`` is the camera's place from the ball."""
    ball = small_scenes.add_ball(scene, material, 0.2, (LAMP[0], LAMP[1] - 0.3, 1.0))
    small_scenes.add_camera(bpy, scene, ball.location + Vector(eye), ball.location, width=0.36)
    found = []
    for most in (0, None):
        prepare(scene, most)
        found.append(small_scenes.render(scene, folder / "ball.exr", size, samples))
    return found


@pytest.mark.parametrize("finish", ["mirror", "glass"])
def test_mirror_and_glass_show_the_photograph(fresh_blend, tmp_path, finish):
    """But for pixels at the lamp's rim: it stands a little before the ceiling, with straight edges."""
    scene, _ = box_room(fresh_blend, tmp_path, lamp_map())
    glass = small_scenes.material(fresh_blend, small_scenes.GLASS, Roughness=0.0, IOR=1.3)
    material = small_scenes.mirror(fresh_blend) if finish == "mirror" else glass
    eye = BESIDE if finish == "mirror" else BELOW
    plain, with_lamps = pictures(fresh_blend, scene, tmp_path, material, (48, 48), 4, eye)
    assert (plain.max(axis=2) > 30).sum() > 5
    differs = np.abs(with_lamps - plain).max(axis=2) > MIRRORED * plain.max()
    assert differs.mean() < RIM_PIXELS
    assert with_lamps.mean() == pytest.approx(plain.mean(), rel=0.005)


def test_a_rough_ball_reflects_no_more_and_no_less(fresh_blend, tmp_path):
    scene, _ = box_room(fresh_blend, tmp_path, lamp_map())
    rough = small_scenes.material(fresh_blend, small_scenes.GLOSSY, Roughness=0.4)
    plain, with_lamps = pictures(fresh_blend, scene, tmp_path, rough, (24, 24), 256)
    assert with_lamps.mean(axis=(0, 1)) == pytest.approx(plain.mean(axis=(0, 1)), rel=GLOSSY_MEAN)


def white_dots(picture):
    """How many pixels are far above the median of those around them."""
    grey = picture.mean(axis=2)
    around = np.lib.stride_tricks.sliding_window_view(np.pad(grey, 1, mode="edge"), (3, 3))
    return int((grey > WHITE_DOT * np.median(around, axis=(2, 3))).sum())


def test_no_white_dots(fresh_blend, tmp_path):
    """A lamp of 10 cm at 16 samples: the plain map has dots."""
    scene, _ = box_room(fresh_blend, tmp_path, lamp_map((LAMP, 0.1, (900, 750, 600))))
    small_scenes.add_plane(scene, small_scenes.material(fresh_blend, small_scenes.DIFFUSE), 3, (0, 0, 0.5))
    small_scenes.add_camera(fresh_blend, scene, (-1.5, -1.5, 2), (0, 0, 0.5), field_of_view=1.0)
    dots = []
    for most in (0, None):
        prepare(scene, most)
        dots.append(white_dots(small_scenes.render(scene, tmp_path / "dots.exr", (48, 36), 16)))
    assert dots[0] > 3
    assert dots[1] == 0


def test_none_is_the_plain_map_again(fresh_blend, tmp_path):
    """Exactly, for the same seed, also after lamps were there; and nothing of them is left."""
    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    matte = small_scenes.material(fresh_blend, small_scenes.DIFFUSE)
    small_scenes.add_ball(scene, matte, 0.2, (0.5, 0, 1))
    small_scenes.add_camera(fresh_blend, scene, (0.5, -1, 1), (0.5, 0, 1), width=0.5)
    found = []
    for most in (0, None, 0):
        prepared = prepare(scene, most)
        found.append(small_scenes.render(scene, tmp_path / "again.exr", (24, 24), 8))
    assert np.array_equal(found[0], found[2])
    assert not np.array_equal(found[0], found[1])
    assert (prepared.at_depth.count, prepared.at_depth.reason) == (0, "no lights, as asked")
    assert not here.lights.objects
    assert here.residual is None


def test_lamps_are_not_in_the_depth_map(fresh_blend, tmp_path):
    from expanded_panoramas.cycles_integration import maps

    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene, 0)
    before = maps.render_depth(scene, here, 128).depth
    prepare(scene)
    assert here.lights.objects
    assert np.array_equal(maps.render_depth(scene, here, 128).depth, before)


def test_lamps_turn_with_the_origin(fresh_blend, tmp_path):
    from expanded_panoramas.cycles_integration.place import set_calibration

    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene)
    (lamp,) = here.lights.objects
    set_calibration(here, TURNS["tilted"], 2.0)
    fresh_blend.context.view_layer.update()
    middle = np.mean([lamp.matrix_world @ vertex.co for vertex in lamp.data.vertices], axis=0)
    assert middle == pytest.approx(TURNS["tilted"] @ (*LAMP, HIGH[2]) + (0, 0, 2.0), abs=0.03)


def test_lamps_are_neither_real_nor_new_objects(fresh_blend, tmp_path):
    """The artist's roles, and the sorting by them, leave them where they are."""
    from expanded_panoramas.cycles_integration import roles
    from expanded_panoramas.cycles_integration.place import sort_objects

    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene)
    (lamp,) = here.lights.objects
    material = lamp.data.materials[0]
    assert lamp not in roles.real_objects(scene)
    assert all(lamp not in roles.with_role(scene, role) for role, *_ in roles.ROLES)
    assert len(roles.real_objects(scene)) == 6
    sort_objects(scene, here)
    assert lamp.users_collection == (here.lights,)
    prepare(scene)
    (lamp,) = here.lights.objects
    assert lamp.users_collection == (here.lights,)
    assert lamp.data.materials[0].name == f"Panorama Lamp 0 ({scene.name})"
    assert material not in list(fresh_blend.data.materials)


def test_preparing_again_leaves_nothing_behind(fresh_blend, tmp_path):
    kinds = (
        "objects",
        "meshes",
        "materials",
        "lights",
        "images",
        "worlds",
        "node_groups",
        "cameras",
        "scenes",
    )

    def data_blocks():
        return {kind: len(getattr(fresh_blend.data, kind)) for kind in kinds}

    scene, _ = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene, 0)
    plain = data_blocks()
    prepare(scene)
    once = data_blocks()
    prepare(scene)
    assert data_blocks() == once != plain
    prepare(scene, 0)
    assert data_blocks() == plain


def test_no_more_than_asked_for_and_why(fresh_blend, tmp_path):
    image = lamp_map((LAMP, 0.3, (20, 20, 20)), ((-1.0, 0.3), 0.3, (60, 60, 60)))
    scene, here = box_room(fresh_blend, tmp_path, image)
    assert prepare(scene).at_depth.count == 2
    one = prepare(scene, 1).at_depth
    (lamp,) = here.lights.objects
    assert one.reason == f"1 lamp with {100 * one.share:.0f} % of the light"
    assert np.mean([vertex.co.x for vertex in lamp.data.vertices]) == pytest.approx(-1.0, abs=0.03)


def test_a_flat_map_is_left_alone(fresh_blend, tmp_path):
    scene, here = box_room(fresh_blend, tmp_path, np.full((HEIGHT, WIDTH, 3), 0.7, np.float32))
    prepared = prepare(scene)
    assert prepared.at_depth.count == len(here.lights.objects) == 0
    assert prepared.at_depth.reason == "no surface stands out of this map: left alone"


def test_two_scenes_do_not_share_lamps(fresh_blend, tmp_path):
    scene, here = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(scene)
    mine = set(here.lights.objects), {o.data.materials[0] for o in here.lights.objects}, here.residual
    fresh_blend.context.window.scene = fresh_blend.data.scenes.new("other")
    other, there = box_room(fresh_blend, tmp_path, lamp_map())
    prepare(other)
    assert len(there.lights.objects) == 1
    assert not set(there.lights.objects) & mine[0]
    assert not {o.data.materials[0] for o in there.lights.objects} & mine[1]
    assert there.residual != mine[2]
    prepare(other, 0)
    assert (set(here.lights.objects), here.residual) == (mine[0], mine[2])


@pytest.fixture
def furnished(fresh_blend, tmp_path):
    """The closed room, a lamp in its smooth photograph; a camera, and one that sees the lamp."""
    image = panoramas.smooth_panorama(tmp_path / "smooth.exr", 256)
    from expanded_panoramas.ibl_toolkit.images import read_panorama

    picture = read_panorama(image)
    picture[12:24, 60:76] = (90, 70, 50)
    scene, here = panoramas.room_place(fresh_blend, panoramas.write_panorama(tmp_path / "lit.exr", picture))
    camera = closed_room_truth.add_camera(scene)
    up = small_scenes.add_camera(fresh_blend, scene, (0.2, 0, 1.5), (0.2, 1, 2.6), field_of_view=1.2)
    prepared = prepare(scene, 8)
    assert prepared.at_depth.count
    assert prepared.at_infinity.count
    return scene, here, (camera, up)


def picture(scene, camera, path, **settings):
    from expanded_panoramas.cycles_integration.rendering import Picture, render_picture

    render_picture(scene, camera, Picture(48, 27, seed=1, **settings), path)
    return closed_room_truth.read_picture(path)


@pytest.mark.parametrize("method", ["catcher", "difference", "directional"])
def test_without_objects_the_picture_is_the_photograph(furnished, tmp_path, method):
    """Where the lamp is seen, too."""
    scene, _, cameras = furnished
    found = [picture(scene, camera, tmp_path / "p.exr", method=method, samples=4) for camera in cameras]
    assert found[1].max() > 50
    prepare(scene, 0)
    for camera, shown in zip(cameras, found, strict=True):
        plain = picture(scene, camera, tmp_path / "plain.exr", method="catcher", samples=1)
        assert np.abs(shown - plain).max() < EXACT * plain.max()


def test_single_shows_the_photograph_on_average(furnished, tmp_path):
    scene, _, cameras = furnished
    for camera in cameras:
        shown = picture(scene, camera, tmp_path / "p.exr", method="single", samples=64)
        plain = picture(scene, camera, tmp_path / "plain.exr", method="catcher", samples=1)
        assert shown.mean() == pytest.approx(plain.mean(), rel=SINGLE_MEAN)


@pytest.mark.parametrize("method", ["catcher", "single", "difference", "directional"])
def test_objects_appear_and_nothing_else_changes(furnished, tmp_path, method):
    """The lamp's shadow falls on the floor; pixels far from the objects stay the photograph's."""
    scene, _, (camera, _) = furnished
    plain = picture(scene, camera, tmp_path / "plain.exr", method="catcher", samples=1)
    closed_room_truth.add_objects(scene)
    shown = picture(scene, camera, tmp_path / "p.exr", method=method, samples=32)
    assert np.isfinite(shown).all()
    change = (shown - plain).mean(axis=2)
    assert (np.abs(change) > 0.1).mean() > 0.02
    assert change[12:20, 20:32].min() < -0.05
    far = np.zeros(change.shape, bool)
    far[:6, :12] = far[:6, -12:] = True
    assert psnr(shown, plain, far) > (FAR_SINGLE if method == "single" else FAR)
