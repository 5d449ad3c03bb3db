from collections import Counter

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.environment_uv import corner_uvs, uv_error_px
from expanded_panoramas.ibl_toolkit.floor_shapes import polygon, rectangle
from expanded_panoramas.ibl_toolkit.meshes import Mesh
from expanded_panoramas.ibl_toolkit.solids import walls
from expanded_panoramas.ibl_toolkit.uv_subdivision import subdivide_for_uv

from .synthetic import POSES, pick

EXACT = 1e-12
WIDTH = 512
ROOM = rectangle([[-3, -2], [3, -2], [3, 2.5]])


@pytest.mark.parametrize("pose", POSES.values(), ids=POSES)
def test_corners_are_where_the_image_shows_them(pose):
    divided = subdivide_for_uv(walls(ROOM, 2.7, True), *pose, WIDTH, max_error_px=8)
    corners = [pick(pose, *divided.mesh.world_vertices[i]) for face in divided.mesh.faces for i in face]
    u, v = np.array(corners).T
    off_pole = np.abs(v - 0.5) < 0.5 - 1e-6
    assert divided.corner_uvs[:, 1] == pytest.approx(1 - v, abs=1e-7)
    turns = divided.corner_uvs[off_pole, 0] - u[off_pole]
    assert turns == pytest.approx(np.round(turns), abs=EXACT)


def test_a_face_across_the_seam_is_continuous_beyond_one():
    behind = Mesh([[-4, 1, 0], [-4, -1, 0], [-4, -1, 3], [-4, 1, 3]], ((0, 1, 2, 3),), np.eye(4))
    u = corner_uvs(behind, np.eye(3), 1.5)[:, 0]
    assert np.ptp(u) == pytest.approx(np.arctan(0.25) / np.pi)
    assert u.min() < 1 < u.max()


def test_a_face_over_a_pole_is_refused_until_divided():
    with pytest.raises(ValueError, match="face 0 holds a pole"):
        corner_uvs(ROOM.mesh, np.eye(3), 1.5)
    assert uv_error_px(ROOM.mesh, np.eye(3), 1.5, WIDTH) == np.inf
    divided = subdivide_for_uv(ROOM.mesh, np.eye(3), 1.5, WIDTH, max_error_px=8)
    assert np.isfinite(uv_error_px(divided.mesh, np.eye(3), 1.5, WIDTH))


@pytest.mark.parametrize("pose", POSES.values(), ids=POSES)
def test_error_stays_below_the_limit_at_points_of_any_face(pose):
    divided = subdivide_for_uv(walls(ROOM, 2.7, True), *pose, WIDTH, max_error_px=4)
    assert divided.error_px <= 4
    assert divided.error_px == pytest.approx(uv_error_px(divided.mesh, *pose, WIDTH))
    random = np.random.default_rng(3)
    for index in random.choice(len(divided.mesh.faces), 60):
        weights = random.dirichlet([1, 1, 1])
        u, v = weights @ divided.corner_uvs[3 * index : 3 * index + 3]
        right_u, right_v = pick(
            pose, *(weights @ divided.mesh.world_vertices[list(divided.mesh.faces[index])])
        )
        # Chord between both directions, from the angles alone.
        t, s, turn = (v - 0.5) * np.pi, (0.5 - right_v) * np.pi, (u - right_u) * 2 * np.pi
        angle = np.arccos(np.clip(np.sin(t) * np.sin(s) + np.cos(t) * np.cos(s) * np.cos(turn), -1, 1))
        assert angle * WIDTH / (2 * np.pi) <= 4 * 1.1  # the error is sampled on a grid


def test_division_keeps_the_surface_whole():
    l_shape = polygon([[-2, -1.5], [3, -1.5], [3, 1], [1, 1], [1, 4], [-2, 4]])
    for mesh in (l_shape.mesh, walls(l_shape, 2.7, True)):
        divided = subdivide_for_uv(mesh, *POSES["tilted"], WIDTH, max_error_px=4).mesh
        assert np.array_equal(divided.vertices[: len(mesh.vertices)], mesh.vertices)
        assert divided.area_vectors.sum(axis=0) == pytest.approx(mesh.area_vectors.sum(axis=0), abs=1e-9)
        assert open_sides(divided) == pytest.approx(open_sides(mesh))


def open_sides(mesh):
    """Length of the rim: sides that no other face walks the other way; T-junctions would add to it."""
    sides = Counter((face[i - 1], face[i]) for face in mesh.faces for i in range(len(face)))
    assert max(sides.values()) == 1
    points = mesh.world_vertices
    return sum(np.linalg.norm(points[a] - points[b]) for a, b in sides if (b, a) not in sides)


def test_less_error_takes_more_faces():
    counts = [len(subdivide_for_uv(ROOM.mesh, np.eye(3), 1.5, WIDTH, px).mesh.faces) for px in (8, 4, 2)]
    assert counts[0] < counts[1] < counts[2]
    with pytest.raises(ValueError, match="max_error_px is 0"):
        subdivide_for_uv(ROOM.mesh, np.eye(3), 1.5, WIDTH, 0)


def test_a_pole_on_a_side_becomes_one_vertex_for_both_its_faces():
    centred = rectangle(
        [[-3, -2], [3, -2], [3, 2]]
    ).mesh  # the nadir lies on the diagonal of any two triangles
    divided = subdivide_for_uv(centred, np.eye(3), 1.5, WIDTH, max_error_px=16).mesh
    at_nadir = np.linalg.norm(divided.world_vertices[:, :2], axis=1) < EXACT
    assert np.count_nonzero(at_nadir) == 1
    assert open_sides(divided) == pytest.approx(20)
