"""Lamps whose shadow may be none: the mean of several places, and what the light on the ground tells by itself."""

import numpy as np
import pytest

from ashe_live.bench.metrics import tangent_offset
from ashe_live.core.transforms import angle_between, radius_of_68_percent
from ashe_live.light.estimators.preset import BALANCED
from ashe_live.light.explanation.explain import Proposal, explained
from ashe_live.light.ground.shadow_shift import shadow_ratio
from ashe_live.light.labels.associate import Split
from ashe_live.light.lamps.fall.fall_off import FallOff
from ashe_live.light.lamps.fall.lit_samples import clear_of
from ashe_live.light.lamps.kinds import AUTO
from ashe_live.light.lamps.lit_by_lamp import lit_ground_of
from ashe_live.light.lamps.mixture import PlaceMixture
from ashe_live.light.lamps.place import Place
from ashe_live.light.lamps.sources import PlaceEvidence, SeenObject, place_by_the_rest
from ashe_live.light.pixels.view import View
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX

ONE = Place(np.array([0.5, 0.2, 1.5]), np.diag([2e3, 3e3, 20.0]))
OTHER = Place(np.array([0.3, 0.6, 2.0]), np.diag([300.0, 200.0, 10.0]))
LAMP_M = (-0.3, -0.1, 0.45)
WITHIN_99 = 11.3  # squared Mahalanobis distance in three dimensions


# Known across the way to the light's foot and hardly along it, as by a shadow without an end.
LONG = Place(np.array([0.9, -0.7, 1.5]), np.array([[400.0, 440.0, 0.0], [440.0, 500.0, 0.0], [0.0, 0.0, 20.0]]))


@pytest.mark.parametrize("place", [ONE, LONG], ids=["round", "long"])
def test_a_place_that_is_certain_stays_as_it_is(place: Place) -> None:
    alone = PlaceMixture.of([place, OTHER], np.array([1.0, 0.0]))
    np.testing.assert_allclose(alone.mean.mean, place.mean)
    np.testing.assert_allclose(alone.mean.covariance, place.covariance, rtol=1e-6, atol=1e-12)
    of_direction = place.lamp_covariance[:2, :2]
    assert alone.errors.radius(0.68) == pytest.approx(radius_of_68_percent(of_direction), rel=0.02)


def test_two_places_have_the_mean_covariance_and_radius_of_samples_of_both() -> None:
    rng = np.random.default_rng(1)
    both = PlaceMixture.of([ONE, OTHER], np.array([0.7, 0.3]))
    samples = np.vstack(
        [rng.multivariate_normal(each.mean, each.covariance, count) for each, count in ((ONE, 7000), (OTHER, 3000))]
    )
    np.testing.assert_allclose(both.mean.mean, samples.mean(axis=0), atol=0.02)
    np.testing.assert_allclose(both.mean.covariance, np.cov(samples.T), rtol=0.1, atol=2e-3)
    lights = np.column_stack([samples[:, :2], np.ones(len(samples))])
    errors = [np.linalg.norm(tangent_offset(both.mean.light[:3], each / np.linalg.norm(each))) for each in lights]
    assert np.mean(np.array(errors) < both.errors.radius(0.68)) == pytest.approx(0.68, abs=0.03)
    # What is far and unlikely widens the covariance more than the circle that holds most of the probability.
    assert both.errors.radius(0.68) < radius_of_68_percent(both.mean.lamp_covariance[:2, :2])


@pytest.fixture(name="seen", scope="module")
def seen_by_a_lamp() -> PlaceEvidence:
    here = painted_region(BOX, lamp_m=LAMP_M)
    (rough,) = explained([Proposal(here.region, here.materials, Split(here.body, here.shadow))], BALANCED.fine_fit)
    assert rough is not None
    coarse = View.of(here.scene.tracked, BALANCED.coarse_width_px)
    ground = lit_ground_of(coarse, BALANCED.ground, AUTO)
    assert ground is not None
    fall_off = FallOff.of(coarse, ground, clear_of(here.unlit))
    assert fall_off is not None
    return PlaceEvidence(
        [SeenObject(rough, 0.5, 1e-3 * np.eye(2), 1.0)], [shadow_ratio(here.ground, here.true_shift)], fall_off
    )


def test_the_ground_locates_a_lamp_whatever_a_wrong_shadow_implied(seen: PlaceEvidence) -> None:
    lamp = np.array(LAMP_M)
    true = np.append(lamp[:2], 1.0) / lamp[2]
    found = []
    for aside in ((0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5)):
        wrong = Place(true + np.array([*aside, 0.0]), np.diag([1e3, 1e3, 10.0]))
        place = place_by_the_rest(seen, wrong)
        offset = place.mean - true
        assert offset @ place.information @ offset < WITHIN_99
        found.append(place.light[:3])
    assert max(np.degrees(angle_between(one, found[0])) for one in found) < 2


def test_where_the_ground_is_not_seen_a_wrong_shadow_leaves_the_hemisphere(seen: PlaceEvidence) -> None:
    wrong = Place(np.array([0.5, 0.2, 1.5]), np.diag([1e3, 1e3, 10.0]))
    found = place_by_the_rest(PlaceEvidence(seen.objects, seen.ratios, None), wrong)
    np.testing.assert_allclose(found.mean, wrong.mean)
    assert 30 < np.degrees(radius_of_68_percent(found.lamp_covariance[:2, :2])) < 90
