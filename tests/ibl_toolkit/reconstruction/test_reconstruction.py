import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.calibration import CalibrationPicks, Rectangle, calibrate
from expanded_panoramas.ibl_toolkit.panorama_set import Shape
from expanded_panoramas.ibl_toolkit.reconstruction import LIFT_M, ReconstructionError, reconstruct

from .synthetic import EXACT, POSES, calibration, pick, picks, room, shape

L_ROOM = [(-2, -1.5), (3, -1.5), (3, 1), (1, 1), (1, 4), (-2, 4)]
BOX = [(1.0, -0.5), (1.6, -0.2), (1.25, 0.5)]  # third: the corner opposite the second, 1.118 m from the side
LEVEL = POSES["level"]


def rebuilt(pose, *shapes, **more):
    return {piece.name: piece for piece in reconstruct(room(*shapes), calibration(pose), **more)}


def in_some_order(vertices, expected):
    if len(vertices) != len(expected):
        return False
    distances = np.linalg.norm(vertices[:, None] - np.array(expected, dtype=float), axis=-1)
    return max(distances.min(axis=1).max(), distances.min(axis=0).max()) < EXACT


@pytest.mark.parametrize("pose", POSES.values(), ids=POSES)
@pytest.mark.parametrize("winding", [1, -1], ids=["ccw", "cw"])
def test_l_shaped_room_from_any_pose(pose, winding):
    pieces = rebuilt(
        pose,
        shape("floor", "polygon", pose, L_ROOM[::winding]),
        Shape("walls", "walls", of="floor", top=pick(pose, 3, 0.5, 2.8), ceiling=True, role="ENVIRONMENT"),
    )
    base = [(x, y, 0) for x, y in L_ROOM]
    assert in_some_order(pieces["floor"].mesh.world_vertices, base)
    assert in_some_order(pieces["walls"].mesh.world_vertices, base + [(x, y, 2.8) for x, y in L_ROOM])
    assert pieces["walls"].size_m == pytest.approx((5, 5.5, 2.8), abs=EXACT)
    assert pieces["walls"].warnings == ()
    assert (len(pieces["floor"].mesh.faces), len(pieces["walls"].mesh.faces)) == (1, 7)


def test_normals_look_into_the_room_and_out_of_furniture():
    pieces = rebuilt(
        LEVEL,
        shape("floor", "polygon", LEVEL, L_ROOM),
        Shape("walls", "walls", of="floor", height=2.8, ceiling=True),
        shape("box", "box", LEVEL, BOX, height=0.7),
        shape("column", "cylinder", LEVEL, [(-1, 2), (-1.5, 2.5), (-1, 3)], height=2.0),
    )
    area = 5 * 2.5 + 3 * 3
    assert pieces["floor"].mesh.area_vectors == pytest.approx(np.array([[0, 0, area]]))
    # Divergence theorem: over a closed surface facing outwards, Σ area · normal · point / 3 is the volume.
    walls, floor = pieces["walls"].mesh, pieces["floor"].mesh
    assert flux(walls) + flux(floor) == pytest.approx(-area * 2.8)
    assert walls.area_vectors[-1] == pytest.approx(np.array([0, 0, -area]))
    width, depth, height = pieces["box"].size_m
    assert flux(pieces["box"].mesh) == pytest.approx(width * depth * height)
    assert flux(pieces["column"].mesh) == pytest.approx(np.pi * 0.25 * 2.0, rel=0.01)
    assert len(pieces["box"].mesh.faces) == 5


def flux(mesh):
    """Volume enclosed with a floor at z = 0, which adds nothing."""
    points = np.array([mesh.world_vertices[face[0]] for face in mesh.faces])
    return np.sum(mesh.area_vectors * points) / 3


@pytest.mark.parametrize("pose", POSES.values(), ids=POSES)
def test_box_and_cylinder_from_their_tops(pose):
    pieces = rebuilt(
        pose,
        shape("box", "box", pose, BOX, top=pick(pose, *BOX[0], 0.72)),
        shape(
            "column", "cylinder", pose, [(-2, 3.5), (-2.5, 3), (-2, 2.5)], top=pick(pose, *near_side(), 2.4)
        ),
    )
    side = np.hypot(0.6, 0.3)
    depth = abs(0.6 * 1.0 - 0.3 * 0.25) / side
    assert pieces["box"].size_m == pytest.approx((side, depth, 0.72), abs=EXACT)
    assert pieces["column"].size_m == pytest.approx((1, 1, 2.4), abs=1e-8)
    assert pieces["column"].mesh.world_from_local[:3, 3] == pytest.approx([-2, 3, 0], abs=EXACT)
    assert pieces["box"].warnings == pieces["column"].warnings == ()


def near_side():
    """The point of the column nearest to the panorama."""
    centre = np.array([-2.0, 3.0])
    return centre * (1 - 0.5 / np.linalg.norm(centre))


def test_walls_of_a_concave_room_are_measured_where_they_are_met_first():
    # Towards (2, 1) the outline is met at x = 2, and again at x = 3 and x = 4.
    u_room = [(-1, -1), (4, -1), (4, 3), (3, 3), (3, 0.5), (2, 0.5), (2, 3), (-1, 3)]
    pieces = rebuilt(
        LEVEL,
        shape("floor", "polygon", LEVEL, u_room),
        Shape("walls", "walls", of="floor", top=pick(LEVEL, 2, 1, 3.1)),
    )
    assert pieces["walls"].size_m[2] == pytest.approx(3.1, abs=EXACT)
    assert len(pieces["walls"].mesh.faces) == 8


def test_walls_may_come_before_their_floor_and_stand_over_a_rectangle():
    pieces = rebuilt(
        LEVEL,
        Shape("walls", "walls", of="floor", height=2.5),
        shape("floor", "rectangle", LEVEL, [(-2, -1), (2, -1), (0, 3)]),
    )
    assert pieces["walls"].size_m == pytest.approx((4, 4, 2.5), abs=EXACT)


def test_walls_seen_from_outside_are_built_with_a_warning():
    pieces = rebuilt(
        LEVEL,
        shape("floor", "polygon", LEVEL, [(2, -1), (4, -1), (4, 1), (2, 1)]),
        Shape("walls", "walls", of="floor", top=pick(LEVEL, 2, 0.3, 2.0)),
    )
    assert pieces["walls"].size_m[2] == pytest.approx(2.0, abs=EXACT)
    assert "outside" in pieces["walls"].warnings[0]


def test_flat_shapes_that_overlap_are_lifted_level_by_level():
    def square(name, x, y, side):
        return shape(name, "square", LEVEL, [(x, y), (x + side, y + side)])

    pieces = rebuilt(
        LEVEL,
        square("floor", -3, -3, 6),
        square("rug", 1, 1, 1),
        square("tile", 2, 1, 0.9),
        square("mat", 1.5, 1.5, 0.2),
    )
    lifts = {name: piece.lift_m / LIFT_M for name, piece in pieces.items()}
    assert lifts == {"floor": 0, "rug": 1, "tile": 1, "mat": 2}  # rug and tile only share a side
    assert pieces["mat"].mesh.world_vertices[:, 2] == pytest.approx(2 * LIFT_M)
    assert pieces["mat"].size_m[2] == 0


def test_top_beside_its_point_is_reported():
    turned = np.radians(4)
    x, y = BOX[0]
    beside = (x * np.cos(turned) - y * np.sin(turned), x * np.sin(turned) + y * np.cos(turned))
    pieces = rebuilt(LEVEL, shape("box", "box", LEVEL, BOX, top=pick(LEVEL, *beside, 0.7)))
    assert pieces["box"].residual_m == pytest.approx(np.hypot(x, y) * np.sin(turned))
    assert "4.0°" in pieces["box"].warnings[0]


def test_sides_of_a_circle_follow_the_image():
    def sides(width):
        circle = shape("rug", "circle", LEVEL, [(1, 0), (2, 1), (3, 0)])
        return len(rebuilt(LEVEL, circle, image_width=width)["rug"].mesh.vertices)

    # The sagitta of a side, seen from the panorama, stays below half a pixel, and one side less would not do.
    nearest = np.hypot(1.5, 1.0)
    for width in (512, 8192):
        allowed = np.pi / width * nearest
        assert 1 - np.cos(np.pi / sides(width)) <= allowed < 1 - np.cos(np.pi / (sides(width) - 1))


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: shape("s", "polygon", LEVEL, [(1, 0), (2, 0), (3, 0)]), "shape 's' .*one line"),
        (lambda: shape("s", "polygon", LEVEL, [(1, 0), (2, 1), (2, 0), (1, 1)]), "sides 1–2 and 3–4"),
        (lambda: shape("s", "polygon", LEVEL, [(1, 0), (2, 1), (1, 0)]), "2 distinct points"),
        (lambda: shape("s", "rectangle", LEVEL, [(1, 0), (2, 0), (3, 0)]), "opposite side"),
        (lambda: shape("s", "rectangle", LEVEL, [(1, 0), (1, 0), (3, 0)]), "one whole side"),
        (lambda: shape("s", "square", LEVEL, [(1, 1), (1, 1)]), "opposite corners"),
        (lambda: shape("s", "circle", LEVEL, [(1, 1), (2, 2), (3, 3)]), "one line"),
        (lambda: shape("s", "circle", LEVEL, [(2, 0), (2.005, 0.1), (2.005, -0.1)]), r"span \d+\.\d°"),
        (lambda: Shape("s", "polygon", [(0.5, 0.4), (0.6, 0.7), (0.7, 0.7)]), "horizon"),
        (lambda: shape("s", "box", LEVEL, BOX, top=pick(LEVEL, -1, 1, 1)), "beside the first point"),
        (lambda: shape("s", "box", LEVEL, BOX, top=pick(LEVEL, *BOX[0], -0.1)), "height of -0.100 m"),
        (
            lambda: shape("s", "cylinder", LEVEL, [(2, 0), (3, 1), (4, 0)], top=pick(LEVEL, 2, 3, 1)),
            "no part",
        ),
        (lambda: shape("s", "cylinder", LEVEL, [(1, 0), (0, 1), (-1, 0)], height=2), "inside it"),
        (lambda: Shape("s", "walls", of="nothing", height=2.0), "of is 'nothing'"),
    ],
)
def test_refused_with_the_shape_and_the_reason(made, message):
    with pytest.raises(ReconstructionError, match=message) as refusal:
        reconstruct(room(made()), calibration(LEVEL))
    assert str(refusal.value).startswith("shape 's'")


def test_pose_and_room_from_picks_alone():
    """The pose too comes from picks of the floor, so the world's +x is the rug's first side."""
    true_pose = POSES["tilted"]
    rug = picks(true_pose, [(1, -1), (3, -1), (3, 1), (1, 1)])
    found = calibrate(CalibrationPicks((Rectangle(rug, "FLOOR"),), camera_height=true_pose[1]), (4096, 2048))
    pieces = reconstruct(
        room(Shape("rug", "rectangle", rug[:3]), Shape("box", "box", rug[:3], height=1.0)), found
    )
    assert pieces[0].size_m == pytest.approx((2, 2, 0), abs=1e-6)
    assert pieces[1].to_json()["size"] == pytest.approx([2, 2, 1], abs=1e-6)
