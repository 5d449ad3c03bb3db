import numpy as np
import pytest

from expanded_panoramas.ibl_toolkit.circle_fit import fit_circle

EXACT = 1e-9  # [m]


def on_circle(degrees, centre=(30.0, -7.0), radius=0.4):
    angles = np.radians(degrees)
    return np.array(centre) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def test_exact_points_give_the_circle_though_it_is_small_and_far():
    fit = fit_circle(on_circle([10, 50, 130]))
    assert fit.centre == pytest.approx([30, -7], abs=EXACT)
    assert (fit.radius, fit.residual_m) == pytest.approx((0.4, 0), abs=EXACT)
    assert fit.arc_deg == pytest.approx(120)


def test_residual_is_the_rms_distance():
    # Errors outwards and inwards by turns on four points: the best circle stays, each is 1 cm off it.
    square = on_circle([0, 90, 180, 270], (0, 0), 1.0) * np.array([[1.01], [0.99], [1.01], [0.99]])
    assert fit_circle(square).residual_m == pytest.approx(0.01, abs=1e-4)


def test_fit_is_the_smallest_sum_of_squares():
    points = on_circle(np.linspace(0, 150, 9), (0, 0), 1.0) + np.random.default_rng(1).normal(0, 0.02, (9, 2))
    fit = fit_circle(points)

    def cost(x, y, radius):
        return np.sum((np.hypot(*(points - (x, y)).T) - radius) ** 2)

    best = cost(*fit.centre, fit.radius)
    for step in np.concatenate([np.eye(3), -np.eye(3)]) * 1e-4:
        assert cost(*(np.append(fit.centre, fit.radius) + step)) > best


@pytest.mark.parametrize("arc", [40, 90, 300])
def test_conditioning_predicts_the_scatter_of_the_radius(arc):
    random, error = np.random.default_rng(2), 1e-5
    points = on_circle(np.linspace(0, arc, 6), (2, 1), 0.5)
    radii = [fit_circle(points + random.normal(0, error, points.shape)).radius for _ in range(400)]
    assert np.std(radii) / error == pytest.approx(fit_circle(points).conditioning, rel=0.15)


def test_short_arcs_warn_and_shorter_ones_are_refused():
    assert "span 45°" in fit_circle(on_circle([0, 20, 45])).warnings[0]
    assert fit_circle(on_circle([0, 40, 90])).warnings == ()
    with pytest.raises(ValueError, match=r"span 15\.0° .* 20° or more"):
        fit_circle(on_circle([0, 7, 15]))
