"""The direction at the marker between a sun's and a lamp's, by how likely each is."""

import math

import numpy as np
import pytest

from ashe_live.bench.metrics import tangent_offset
from ashe_live.core.arrays import Float
from ashe_live.core.light import Light
from ashe_live.core.transforms import angle_between, radius_of_68_percent
from ashe_live.light.lamps.doubt import with_doubt
from ashe_live.light.lamps.place import Place
from ashe_live.light.shape.directions import displacement_of

FOOT = np.array([0.2, -0.1])  # of the object whose shadow tells the direction there
SUN = Light(np.array([0.5, 0.2, 0.8]), 0.02**2 * np.eye(2), 0.03, 0.9)


# Deviance of a sun that leaves it even with a lamp known to be at 1 ± 0.1 per metre: of all nearnesses that a lamp may
# have, the picture singles out a small part, sqrt(2 pi) 0.1 wide, of the prior's density 2 N(1; 0, 1.5).
EVEN = -2 * math.log(math.sqrt(2 * math.pi) * 0.1 * 2 * math.exp(-0.5 / 1.5**2) / (math.sqrt(2 * math.pi) * 1.5))


def place(nearness: float, sigma: float) -> Place:
    """Of a lamp that the object sees in the sun's direction."""
    seen = np.column_stack([np.eye(2), -FOOT])
    information = seen.T @ seen / 0.02**2
    information[2, 2] += 1 / sigma**2
    at_foot = displacement_of(SUN.to_light_marker)
    return Place(np.array([*(at_foot + nearness * FOOT), nearness]), information)


def off_deg(light: Light, to_light: Float) -> float:
    return math.degrees(angle_between(light.to_light_marker, to_light))


def test_a_sure_sun_stays() -> None:
    found = with_doubt(SUN, place(0.9, 0.3), place(-0.3, 0.2), -20.0)
    assert off_deg(found, SUN.to_light_marker) < 0.05
    assert found.confidence == pytest.approx(SUN.confidence, rel=0.01)


def test_what_is_surely_a_lamp_is_where_the_lamp_is() -> None:
    lamp = place(1.0, 0.1)
    found = with_doubt(SUN, lamp, place(0.9, 0.1), 200.0)
    assert off_deg(SUN, lamp.light[:3]) > 8
    assert off_deg(found, lamp.light[:3]) < 0.3


def test_between_the_two_it_is_as_unsure_as_they_are_apart() -> None:
    lamp = place(1.0, 0.1)
    found = with_doubt(SUN, lamp, place(1.0, 0.1), EVEN)
    apart = angle_between(SUN.to_light_marker, lamp.light[:3])
    for each in (SUN.to_light_marker, lamp.light[:3]):
        assert off_deg(found, each) == pytest.approx(math.degrees(apart) / 2, rel=0.1)
    assert found.covariance_rad2 is not None
    assert np.linalg.eigvalsh(found.covariance_rad2)[1] == pytest.approx((apart / 2) ** 2, rel=0.35)


def test_a_lamp_far_from_where_a_sun_would_be_takes_its_share_of_the_confidence() -> None:
    lamp = place(4.0, 0.1)
    assert off_deg(SUN, lamp.light[:3]) > 25
    found = with_doubt(SUN, lamp, place(0.2, 0.2), 6.0)  # a sun by what the ground tells, but for a tenth
    assert SUN.confidence is not None
    assert found.confidence is not None
    assert 0.8 * SUN.confidence < found.confidence < 0.95 * SUN.confidence


def test_outlines_of_several_views_that_show_a_suns_shadow_outweigh_glossy_ground() -> None:
    lamp = place(1.0, 0.1)
    assert off_deg(with_doubt(SUN, lamp, place(0.5, 0.2), 40.0), SUN.to_light_marker) > 4
    found = with_doubt(SUN, lamp, place(0.5, 0.2), 40.0, by_outlines=-30.0)
    assert off_deg(found, SUN.to_light_marker) < 0.05
    assert found.confidence == pytest.approx(SUN.confidence, rel=0.01)


def test_outlines_count_as_the_ground_does() -> None:
    """A deviance of 2 ln 4 less is four times the odds of a sun, whichever witness it comes from."""
    lamp = place(1.0, 0.1)
    by_outlines = with_doubt(SUN, lamp, place(1.0, 0.1), EVEN, by_outlines=-2 * math.log(4))
    by_ground = with_doubt(SUN, lamp, place(1.0, 0.1), EVEN - 2 * math.log(4))
    assert off_deg(by_outlines, by_ground.to_light_marker) < 0.01


def test_a_low_sun_is_as_sure_by_itself_as_it_was_measured() -> None:
    low = Light(np.array([math.cos(0.35), 0.0, math.sin(0.35)]), np.diag([0.02, 0.1]) ** 2, 0.1, 0.9)
    higher = Place(np.array([1.2, 0.0, 1.0]), np.diag([1e4, 1e4, 1e2]))
    found = with_doubt(low, higher, place(1.0, 0.1), EVEN)
    # Between 20 and 40 degrees of elevation the sun alone would be within 10 degrees in 92 percent, the two are in 76.
    assert found.confidence == pytest.approx(0.9 * 0.76 / 0.92, abs=0.04)


def test_sigma_is_the_radius_that_holds_the_truth_in_68_percent() -> None:
    rng = np.random.default_rng(1)
    lamp = place(1.0, 0.1)
    found = with_doubt(SUN, lamp, place(1.0, 0.1), EVEN - 2 * math.log(4))  # the sun is four times as likely
    assert found.sigma_rad is not None
    assert found.covariance_rad2 is not None
    assert SUN.covariance_rad2 is not None
    as_sun = rng.multivariate_normal(
        tangent_offset(found.to_light_marker, SUN.to_light_marker), SUN.covariance_rad2, 8000
    )
    as_lamp = rng.multivariate_normal(
        tangent_offset(found.to_light_marker, lamp.light[:3]), lamp.lamp_covariance[:2, :2], 2000
    )
    errors = np.linalg.norm(np.vstack([as_sun, as_lamp]), axis=1)
    assert np.mean(errors < found.sigma_rad) == pytest.approx(0.68, abs=0.02)
    # A few far lamps widen the covariance, not the circle that holds most of the probability.
    assert found.sigma_rad < 0.6 * radius_of_68_percent(found.covariance_rad2)


def test_a_lamp_is_nearer_than_infinity_even_where_evidence_points_beyond() -> None:
    beyond = place(-0.1, 0.5)
    found = with_doubt(SUN, beyond, place(2.0, 0.1), 40.0)
    # Of N(-0.1, 0.5²) with the prior, what is positive has a mean of 0.35 / m.
    expected = displacement_of(SUN.to_light_marker) + 0.35 * FOOT
    assert off_deg(found, np.append(expected, 1.0)) < 1.5
    assert off_deg(SUN, np.append(expected, 1.0)) > 3


@pytest.mark.parametrize(("nearness", "sigma"), [(3.0, 1.5), (1.5, 0.8), (1.0, 0.1), (2.5, 1.0)])
def test_the_odds_of_a_lamp_are_those_of_all_the_nearnesses_that_lamps_have(nearness: float, sigma: float) -> None:
    """By numerical integration over half a normal distribution of 1.5 / m, where the evidence is normal as well."""
    deviance = (nearness / sigma) ** 2
    found = with_doubt(SUN, place(nearness, sigma), place(50.0, 0.1), deviance)
    k = np.linspace(0, 20, 20001)
    prior = 2 * np.exp(-0.5 * (k / 1.5) ** 2) / (1.5 * math.sqrt(2 * math.pi))
    weights = prior * np.exp(-0.5 * ((k - nearness) / sigma) ** 2)
    odds = weights.sum() * (k[1] - k[0]) / math.exp(-0.5 * deviance)
    at_sun, at_lamp = displacement_of(SUN.to_light_marker), (weights @ k) / weights.sum() * FOOT
    expected = at_sun + odds / (1 + odds) * at_lamp
    np.testing.assert_allclose(displacement_of(found.to_light_marker), expected, atol=1e-3 * np.linalg.norm(at_lamp))


@pytest.mark.parametrize("nearness", [-5.0, -0.01, 0.0, 0.05, 12.0])
@pytest.mark.parametrize("sigma", [1e-3, 0.5, 50.0])
@pytest.mark.parametrize("deviance", [-1e6, 0.0, 1e6])
def test_extreme_places_are_finite(nearness: float, sigma: float, deviance: float) -> None:
    found = with_doubt(SUN, place(nearness, sigma), place(nearness, sigma), deviance)
    assert np.isfinite(found.to_light_marker).all()
    assert found.covariance_rad2 is not None
    assert (np.linalg.eigvalsh(found.covariance_rad2) > 0).all()
