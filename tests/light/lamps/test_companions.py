"""Other objects: those count whose light agrees with what is known without them, and each only once."""

import math

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.lamps.companions import companions
from ashe_live.light.lamps.place import Place
from ashe_live.light.lamps.sources import SeenObject
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.directions import FittedLight
from ashe_live.light.shape.light_points import at_infinity
from tests.light.painted_bodies import explanation_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, Caster
from tests.light.synthetic_masks import direction

OTHER = Caster("cylinder", at=(-0.02, 0.16), rgb=(0.1, 0.25, 0.5))
SURE_RAD2 = math.radians(2) ** 2 * np.eye(2)


def covariance_of(_explanation: Explanation, probability: float) -> Float:
    return SURE_RAD2 / probability


def whole_view() -> View:
    return View.of(painted_region(BOX).scene.tracked, 320)


def seen(caster: Caster, azimuth_deg: float = 200.0) -> Explanation:
    here = painted_region(caster)
    light = FittedLight(at_infinity(direction(azimuth_deg, 40.0)), SURE_RAD2)
    return explanation_of(here, caster, lights=(light,))


def place_of(explanation: Explanation) -> Place:
    """The light of an explanation as a sun's, whose nearness is known to half of one over a metre."""
    x, y, z, _ = explanation.lights[0].light
    return Place(np.array([x / z, y / z, 0.0]), np.diag([400.0, 400.0, 4.0]))


@pytest.fixture(scope="module")
def first() -> SeenObject:
    return SeenObject(seen(BOX), 0.9, SURE_RAD2, 1.0)


def found(first: SeenObject, *candidates: tuple[Explanation, float]) -> list[Explanation]:
    others = companions(first, place_of(first.explanation), candidates, covariance_of, whole_view())
    return [each.explanation for each in others]


def test_an_object_in_the_same_light_counts(first: SeenObject) -> None:
    other = seen(OTHER)
    assert found(first, (other, -1.0)) == [other]


def test_one_in_another_light_does_not(first: SeenObject) -> None:
    assert found(first, (seen(OTHER, 245.0), 2.0)) == []


def test_one_that_is_hardly_likely_does_not(first: SeenObject) -> None:
    assert found(first, (seen(OTHER), -6.0)) == []


def test_the_object_itself_and_its_other_explanations_count_no_second_time(first: SeenObject) -> None:
    assert found(first, (first.explanation, 2.0), (seen(BOX), 2.0)) == []
    one, again = seen(OTHER), seen(OTHER)
    assert found(first, (one, 0.5), (again, 1.0)) == [again]


def test_the_surer_it_is_the_smaller_its_covariance(first: SeenObject) -> None:
    (unsure,), (sure,) = (
        companions(first, place_of(first.explanation), [(seen(OTHER), log_odds)], covariance_of, whole_view())
        for log_odds in (-2.0, 2.0)
    )
    assert sure.probability > unsure.probability
    assert np.linalg.det(sure.covariance_rad2) < np.linalg.det(unsure.covariance_rad2)


def test_to_agree_with_what_is_known_makes_no_direction_more_exact(first: SeenObject) -> None:
    """However exactly the light is known: what counts tells its direction as well as its own evidence says."""
    known = place_of(first.explanation)
    for sharper in (1.0, 10.0):
        place = Place(known.mean, sharper * known.information)
        (other,) = companions(first, place, [(seen(OTHER), -0.5)], covariance_of, whole_view())
        np.testing.assert_allclose(other.covariance_rad2, SURE_RAD2 * (1 + math.exp(0.5)))
