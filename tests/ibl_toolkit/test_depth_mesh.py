"""A depth map comes back as a mesh that lies where the map says."""

import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit import equirectangular
from expanded_panoramas.ibl_toolkit.depth_mesh import mesh_from_depth

TILT = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def box_depth(width):
    directions = equirectangular.pixel_directions(width, width // 2).astype(float)
    with np.errstate(divide="ignore"):
        return np.min(np.array([2.0, 3.0, 1.5]) / np.abs(directions), axis=2)


def test_vertices_lie_on_the_map_in_the_world():
    mesh = mesh_from_depth(np.full((16, 32), 2.0), TILT, 1.5).mesh
    distances = np.linalg.norm(mesh.world_vertices - (0, 0, 1.5), axis=1)
    assert np.allclose(distances, 2.0, atol=1e-6)
    first = equirectangular.direction_from_uv(np.array([0.5 / 32, 0.5 / 16])) * 2.0
    assert np.allclose(mesh.world_vertices[0] - (0, 0, 1.5), TILT @ first, atol=1e-6)


def test_the_mesh_is_closed_and_looks_inwards():
    mesh = mesh_from_depth(box_depth(64), np.eye(3), 1.5).mesh
    edges = {}
    for face in mesh.faces:
        for one, other in zip(face, (*face[1:], face[0]), strict=True):
            edges[one, other] = edges.get((one, other), 0) + 1
    assert all(count == 1 and (other, one) in edges for (one, other), count in edges.items())
    middles = np.array([mesh.world_vertices[list(face)].mean(axis=0) for face in mesh.faces]) - (0, 0, 1.5)
    assert (np.sum(mesh.area_vectors * middles, axis=1) < 0).all()


def test_the_error_of_a_box_room_falls_with_the_width():
    coarse, fine = (mesh_from_depth(box_depth(512), np.eye(3), 1.5, width) for width in (64, 256))
    assert len(fine.mesh.faces) > 10 * len(coarse.mesh.faces)
    assert coarse.median_error < 0.01
    assert fine.median_error < 1e-3
    assert fine.percentile_95_error < 0.01


def test_the_sky_stays_open():
    depth = box_depth(64)
    depth[:16] = np.inf
    mesh = mesh_from_depth(depth, np.eye(3), 1.5).mesh
    assert mesh.world_vertices[:, 2].max() < 1.5
    assert np.isfinite(mesh.vertices).all()


@pytest.mark.parametrize(
    ("depth", "message"),
    [
        (np.full((16, 30), 1.0), "30 × 16; expected 2:1"),
        (np.full((16, 32), np.inf), "nothing to mesh"),
        (np.full((16, 32), -1.0), "512 depths that are not positive"),
        (np.full((16, 32), np.nan), "512 depths that are not positive"),
    ],
)
def test_bad_maps_are_refused(depth, message):
    with pytest.raises(ValueError, match=message):
        mesh_from_depth(depth, np.eye(3), 1.5)
