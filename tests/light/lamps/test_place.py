"""Places of lights: their laws, and that what several objects tell adds up to where a lamp is."""

import math

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.light import Light
from ashe_live.core.transforms import angles_from_direction, normalised
from ashe_live.light.ground.glint import Glint
from ashe_live.light.lamps.lamp_borders import LampBorders
from ashe_live.light.lamps.place import Place, combined, place_by_borders, place_by_glint, places_by_glints
from ashe_live.light.shape.directions import FittedLight

LAMP = np.array([0.3, -0.2, 0.5])
TRUE = np.array([*LAMP[:2] / LAMP[2], 1 / LAMP[2]])
KNOWN = np.diag([400.0, 900.0, 25.0]) + 30.0


def seen_at(foot: Float, sigma_rad: float = 0.01, held: float = 0.0) -> Place:
    """What an object at `foot` (2,) tells of the lamp, if its nearness is held there and nothing tells it."""
    displacement = (LAMP[:2] - foot) / LAMP[2]  # as seen from the object's foot
    light = np.array([*(displacement + held * foot), 1.0, held])
    fitted = FittedLight(light, sigma_rad**2 * np.eye(2))
    return place_by_borders(fitted, LampBorders(0.0, 100.0, foot))


def test_two_objects_determine_where_a_lamp_is() -> None:
    one, other = seen_at(np.array([0.15, 0.0])), seen_at(np.array([-0.1, 0.12]))
    both = combined([one, other])
    np.testing.assert_allclose(both.mean, TRUE, rtol=1e-3)
    np.testing.assert_allclose(both.light[:3] / both.light[3], LAMP, rtol=1e-3)
    assert both.nearness_sigma < 0.1 < 50 < one.nearness_sigma


def glint_at(place_m: tuple[float, float], lamp_m: Float = LAMP) -> Glint:
    return Glint(np.zeros((2, 2), np.bool_), normalised(lamp_m - (*place_m, 0.0)), np.array(place_m))


def test_a_lamp_is_determined_by_a_glint_beside_an_object_and_by_two_glints_alone() -> None:
    beside = combined([seen_at(np.array([0.15, 0.0])), place_by_glint(glint_at((-0.2, 0.1)))])
    np.testing.assert_allclose(beside.mean, TRUE, rtol=1e-3)
    alone = combined([place_by_glint(glint_at(place_m)) for place_m in ((0.1, 0.1), (-0.2, 0.1))])
    np.testing.assert_allclose(alone.mean, TRUE, rtol=1e-6)
    assert beside.nearness_sigma < 0.3


def test_a_lamp_anywhere_on_its_glints_ray_agrees_with_it() -> None:
    glint = glint_at((-0.2, 0.1))
    place = place_by_glint(glint)
    for way_m in (0.1, 1.0, 100.0):
        x, y, z = np.append(glint.place_marker, 0.0) + way_m * glint.to_light_marker
        offset = np.array([x / z, y / z, 1 / z]) - place.mean
        assert offset @ place.information @ offset == pytest.approx(0, abs=1e-6)


def test_mirror_images_of_other_lights_are_left_out() -> None:
    light = combined([seen_at(np.array([0.15, 0.0])), seen_at(np.array([-0.1, 0.12]))])
    own, other = glint_at((0.0, 0.2)), glint_at((0.0, 0.2), np.array([-0.5, -0.5, 0.5]))
    (kept,) = places_by_glints([own, other], light)
    np.testing.assert_array_equal(kept.mean, place_by_glint(own).mean)
    first, second = places_by_glints([own, own], light)
    assert np.trace(first.information + second.information) < 2 * np.trace(kept.information)


def test_one_object_determines_the_direction_at_itself_whatever_the_nearness() -> None:
    foot = np.array([0.15, -0.05])
    place = seen_at(foot)
    at_object = np.column_stack([np.eye(2), -foot])
    sigma = np.sqrt(np.diag(at_object @ place.covariance @ at_object.T))
    assert (sigma < 0.05).all()
    np.testing.assert_allclose(at_object @ place.mean, at_object @ TRUE, atol=1e-6)


def test_it_does_not_matter_at_which_nearness_the_borders_were_aligned() -> None:
    foot = np.array([0.15, -0.05])
    for held in (0.0, 1.0, 2.0):
        np.testing.assert_allclose(seen_at(foot, held=held).mean, seen_at(foot).mean, atol=1e-9)


def test_the_surer_source_counts_more() -> None:
    first, second = (Place(np.full(3, value), weight * np.eye(3)) for value, weight in ((0.0, 1.0), (1.0, 3.0)))
    both = combined([first, second])
    np.testing.assert_allclose(both.mean, 0.75)
    np.testing.assert_allclose(both.covariance, 0.25 * np.eye(3))


@pytest.mark.parametrize("parameters", [TRUE, (0.0, 0.4, 0.0), (3.0, -2.0, 12.0), (0.01, 0.0, 0.05)])
def test_the_covariance_on_angles_is_that_of_samples(parameters: Float) -> None:
    mean = np.array(parameters)
    place = Place(mean, 1e6 * KNOWN)
    samples = np.random.default_rng(1).multivariate_normal(mean, place.covariance, 20000)
    east, up, inverse_distance = [], [], []
    azimuth, elevation = angles_from_direction(place.light[:3])
    for sample in samples[:4000]:
        light = Place(sample, KNOWN).light
        turned = angles_from_direction(light[:3])
        east.append(((turned[0] - azimuth + math.pi) % (2 * math.pi) - math.pi) * math.cos(elevation))
        up.append(turned[1] - elevation)
        inverse_distance.append(light[3])
    measured = np.cov([east, up, inverse_distance])
    scale = np.sqrt(np.diag(place.lamp_covariance))
    np.testing.assert_allclose(
        measured / np.outer(scale, scale), place.lamp_covariance / np.outer(scale, scale), atol=0.08
    )


@pytest.mark.parametrize("nearness", [-0.01, 0.0, 0.05, 12.0])
@pytest.mark.parametrize("displacement", [(0.0, 0.0), (30.0, 10.0), (1.0, -0.5)])
def test_extreme_places_are_finite(nearness: float, displacement: tuple[float, float]) -> None:
    place = Place(np.array([*displacement, nearness]), KNOWN)
    assert np.isfinite(place.lamp_covariance).all()
    assert (np.linalg.eigvalsh(place.lamp_covariance) > 0).all()
    light = Light(place.light[:3], inverse_distance=max(float(place.light[3]), 0.0))
    if nearness > 0:
        assert light.position_marker_m is not None
        np.testing.assert_allclose(light.position_marker_m, np.array([*displacement, 1.0]) / nearness)
