"""What is known of a light whose shadow's far end is out of the picture."""

import math

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angles_from_direction
from ashe_live.light.shape.directions import (
    UNSEEN_END_RAD,
    FittedLight,
    corrected_for_cut_shadow,
    fitted_lights,
    information_on_displacement,
)
from ashe_live.light.shape.light_points import at_infinity
from tests.light.synthetic_masks import direction

DEG = math.pi / 180
CORRELATION = 0.3


def light(azimuth_deg: float, elevation_deg: float, deviation_deg: float) -> FittedLight:
    """Of a known azimuth, and a height that only deviates by so much."""
    deviations = np.array([1.0, deviation_deg]) * DEG
    correlation = np.array([(1.0, CORRELATION), (CORRELATION, 1.0)])
    return FittedLight(
        at_infinity(direction(azimuth_deg, elevation_deg)), correlation * np.outer(deviations, deviations)
    )


def height_deg(fitted: FittedLight) -> float:
    return math.degrees(math.asin(fitted.to_light_marker[2]))


def deviations_deg(fitted: FittedLight) -> Float:
    return np.degrees(np.sqrt(np.diag(fitted.covariance_rad2)))


def test_where_the_end_is_in_view_nothing_changes() -> None:
    before = light(40, 20, 3)
    after = corrected_for_cut_shadow(before, 1.0)
    assert after.to_light_marker == pytest.approx(before.to_light_marker, abs=1e-15)
    assert after.covariance_rad2 == pytest.approx(before.covariance_rad2)


def azimuth_deg_and_deviation(fitted: FittedLight) -> tuple[float, float]:
    azimuth, height = angles_from_direction(fitted.to_light_marker)
    return math.degrees(azimuth), float(deviations_deg(fitted)[0]) / math.cos(height)


@pytest.mark.parametrize("elevation_deg", [2.0, 30.0, 75.0])
@pytest.mark.parametrize("azimuth_deg", [0.0, 130.0, 250.0])
def test_only_the_height_is_less_sure(azimuth_deg: float, elevation_deg: float) -> None:
    before = light(azimuth_deg, elevation_deg, 3)
    after = corrected_for_cut_shadow(before, 0.0)
    assert azimuth_deg_and_deviation(after) == pytest.approx(azimuth_deg_and_deviation(before))
    assert deviations_deg(after)[1] > math.degrees(UNSEEN_END_RAD)
    assert after.covariance_rad2[0, 1] == pytest.approx(CORRELATION * np.prod(deviations_deg(after)) * DEG**2)


def test_with_half_of_the_end_in_view_a_quarter_of_the_way_down_and_half_of_the_doubt() -> None:
    here = light(40, 24, 3)
    none, half = corrected_for_cut_shadow(here, 0.0), corrected_for_cut_shadow(here, 0.5)
    assert 24 - height_deg(half) == pytest.approx((24 - height_deg(none)) / 4)
    assert deviations_deg(half)[1] == pytest.approx((3 + deviations_deg(none)[1]) / 2)


def test_what_an_end_out_of_view_leaves_open_is_kept_apart_from_errors_of_outlines() -> None:
    here = light(40, 24, 3)
    assert corrected_for_cut_shadow(here, 1.0).unseen_end == pytest.approx(0)
    assert corrected_for_cut_shadow(here, 0.0).unseen_end == pytest.approx(1)
    half = corrected_for_cut_shadow(here, 0.5)
    by_outlines = math.sqrt(1 - half.unseen_end) * deviations_deg(half)[1]
    assert by_outlines == pytest.approx(3 / 2)


@pytest.mark.parametrize("elevation_deg", [5.0, 40.0, 85.0])
def test_displacements_say_of_a_light_what_it_says_of_them(elevation_deg: float) -> None:
    here = light(130, elevation_deg, 3)
    covariance = np.linalg.inv(information_on_displacement(here))
    (again,) = fitted_lights(here.light[None], covariance)
    np.testing.assert_allclose(again.to_light_marker, here.to_light_marker)
    np.testing.assert_allclose(again.covariance_rad2, here.covariance_rad2)


def test_a_lamp_that_is_lowered_stays_as_far_away() -> None:
    lamp = FittedLight(np.append(3 * direction(40, 24), 2.0), light(40, 24, 3).covariance_rad2)
    lower, sun = corrected_for_cut_shadow(lamp, 0.2), corrected_for_cut_shadow(light(40, 24, 3), 0.2)
    assert np.linalg.norm(lower.light[:3]) / lower.light[3] == pytest.approx(1.5)
    np.testing.assert_allclose(lower.to_light_marker, sun.to_light_marker)


def test_a_shadow_whose_length_nothing_else_constrains_stands_for_all_lower_lights() -> None:
    """Heights from 0 to h, the larger the likelier: 2/3 of h in the mean, h / sqrt(18) about it."""
    after = corrected_for_cut_shadow(light(40, 24, 1e6), 0.0)
    assert height_deg(after) == pytest.approx(16, abs=0.2)
    spread = math.hypot(24 / math.sqrt(18), math.degrees(UNSEEN_END_RAD))
    assert deviations_deg(after)[1] == pytest.approx(spread, rel=0.02)


def test_a_height_that_is_known_otherwise_stays() -> None:
    after = corrected_for_cut_shadow(light(40, 24, 0.5), 0.0)
    assert 24 - 0.5 < height_deg(after) < 24
    assert deviations_deg(after)[1] == pytest.approx(math.degrees(UNSEEN_END_RAD), rel=0.01)


def test_the_less_of_the_end_is_in_view_the_lower_and_the_less_sure() -> None:
    found = [corrected_for_cut_shadow(light(40, 20, 1), share) for share in (0.0, 0.3, 0.6, 1.0)]
    assert np.all(np.diff([height_deg(each) for each in found]) > 0)
    assert np.all(np.diff([float(np.linalg.det(each.covariance_rad2)) for each in found]) < 0)


@pytest.mark.parametrize("elevation_deg", [1e-6, 0.5, 89.9, 90.0])
@pytest.mark.parametrize("deviation_deg", [1e-3, 1.0, 60.0])
def test_never_below_the_ground(elevation_deg: float, deviation_deg: float) -> None:
    after = corrected_for_cut_shadow(light(40, elevation_deg, deviation_deg), 0.0)
    assert 0 < height_deg(after) <= elevation_deg + 1e-6
    assert np.isfinite(after.covariance_rad2).all()
