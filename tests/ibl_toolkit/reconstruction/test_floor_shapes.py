import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.floor_shapes import circle, polygon, rectangle, square

EXACT = 1e-12  # [m]


def turned(points, degrees):
    angle = np.radians(degrees)
    return np.array(points) @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize("degrees", [0, 30, 90, 135, 200, 300])
@pytest.mark.parametrize("side", [1, -1], ids=["left", "right"])
def test_rectangle_lies_on_the_side_of_its_third_point(degrees, side):
    corners = turned([(1, 1), (4, 1), (4, 1 + 2 * side), (1, 1 + 2 * side)], degrees)
    third = turned([(2, 1 + 2 * side)], degrees)[0]
    shape = rectangle([corners[0], corners[1], third])
    assert same_corners(shape.outline, corners)
    assert same_corners(shape.mesh.world_vertices[:, :2], corners)
    assert shape.size_m == pytest.approx((3, 2), abs=EXACT)
    assert shape.mesh.world_from_local[:2, 0] == pytest.approx(corners[1] - corners[0], abs=EXACT)
    assert shape.mesh.area_vectors[0] == pytest.approx([0, 0, 6])
    assert shape.residual_m == 0


@pytest.mark.parametrize("degrees", [0, 30, 90, 135, 200, 300])
def test_square_has_the_picked_corners(degrees):
    corners = turned([(1, 1), (3, 1), (3, 3), (1, 3)], degrees)
    shape = square([corners[0], corners[2]])
    assert same_corners(shape.outline, corners)
    assert same_corners(shape.mesh.world_vertices[:, :2], corners)
    assert shape.mesh.area_vectors[0] == pytest.approx([0, 0, 4])


def same_corners(found, expected):
    distances = np.linalg.norm(found[:, None] - expected, axis=-1)
    return max(distances.min(axis=0).max(), distances.min(axis=1).max()) < EXACT


def test_rectangle_says_how_far_its_third_point_lies_beyond_the_side():
    assert rectangle([(0, 1), (2, 1), (2.25, 3)]).residual_m == pytest.approx(0.25)
    assert rectangle([(0, 1), (2, 1), (-0.5, 3)]).residual_m == pytest.approx(0.5)


def test_local_geometry_is_of_unit_size():
    for shape in (
        rectangle([(0, 1), (2, 1), (2, 4)]),
        polygon([(0, 1), (7, 1), (3, 4)]),
        circle([(1, 0), (2, 1), (3, 0)], 1.5),
    ):
        assert np.abs(shape.mesh.vertices[:, :2]).max() == pytest.approx(0.5)
        assert shape.mesh.world_vertices[:, :2] == pytest.approx(shape.outline, abs=EXACT)


def test_polygon_drops_only_what_is_exactly_redundant():
    corners = [(0, 0), (2, 0), (4, 0), (4, 0), (4, 2), (0, 2), (0, 0)]
    assert len(polygon(corners).outline) == 4
    corners[1] = (2, 1e-4)
    assert len(polygon(corners).outline) == 5


@pytest.mark.parametrize(
    "points",
    [
        [(0, 0), (4, 0), (2, 0), (2, 3)],  # a spike: out and back along one line
        [(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)],  # a corner that touches a side
        [(0, 0), (2, 2), (4, 0), (4, 4), (2, 2), (0, 4)],  # two corners in one place
    ],
)
def test_outlines_that_touch_themselves_are_refused(points):
    with pytest.raises(ValueError, match="of the outline meet"):
        polygon(points)


def test_thin_polygons_are_refused_with_their_area():
    with pytest.raises(ValueError, match="area 5e-06 m²"):
        polygon([(0, 0), (1, 0), (0.5, 1e-5)])
