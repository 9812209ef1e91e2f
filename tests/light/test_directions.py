"""What is known of displacements, said of directions."""

import math

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.directions import UNSEEN_END_RAD, fitted_lights, with_ends_seen
from tests.light.painted_bodies import slant_of
from tests.light.synthetic_masks import direction

INFORMATION = np.array([(900.0, 200.0), (200.0, 500.0)])


def covariance_of(information: Float, slant: Float) -> Float:
    (light,) = fitted_lights(slant[None], np.linalg.inv(information))
    return light.covariance_rad2


@pytest.mark.parametrize("elevation_deg", [2.0, 30.0, 75.0])
@pytest.mark.parametrize("azimuth_deg", [0.0, 130.0, 250.0])
def test_where_no_end_is_seen_the_height_is_less_sure_and_the_azimuth_as_before(
    azimuth_deg: float, elevation_deg: float
) -> None:
    slant = slant_of(direction(azimuth_deg, elevation_deg))
    before = covariance_of(INFORMATION, slant)
    after = covariance_of(with_ends_seen(INFORMATION, slant[None], [0.0]), slant)
    assert after - before == pytest.approx(np.diag([0, UNSEEN_END_RAD**2]), abs=1e-6)


def test_where_the_end_is_seen_nothing_changes() -> None:
    slant = slant_of(direction(40, 20))
    assert with_ends_seen(INFORMATION, slant[None], [1.0]) == pytest.approx(INFORMATION)


def test_the_less_of_the_end_is_seen_the_less_is_known() -> None:
    slant = slant_of(direction(40, 20))
    known = [float(np.linalg.det(with_ends_seen(INFORMATION, slant[None], [seen]))) for seen in (0.0, 0.3, 0.6, 1.0)]
    assert np.all(np.diff(known) > 0)


def test_each_light_has_an_end_of_its_own() -> None:
    slants = np.array([slant_of(direction(40, 20)), slant_of(direction(200, 50))])
    both = np.kron(np.eye(2), INFORMATION)
    changed = with_ends_seen(both, slants, [0.0, 1.0])
    assert changed[2:, 2:] == pytest.approx(INFORMATION)
    assert np.linalg.det(changed[:2, :2]) < np.linalg.det(INFORMATION)


def test_a_light_overhead_has_no_length_to_be_unsure_of() -> None:
    assert with_ends_seen(INFORMATION, np.zeros((1, 2)), [0.0]) == pytest.approx(INFORMATION)
    assert math.isfinite(with_ends_seen(INFORMATION, np.full((1, 2), 1e-12), [0.0]).sum())
