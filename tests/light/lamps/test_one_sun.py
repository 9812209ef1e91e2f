"""A sun by several objects: as sure as independent measurements make it, and no surer of what they err by alike."""

import math

import numpy as np
import pytest

from ashe_live.core.light import Light
from ashe_live.core.transforms import angle_between, direction_from_angles, tangent_basis
from ashe_live.light.lamps.one_sun import by_all_objects, place_of_sun
from ashe_live.light.lamps.sources import SeenObject
from ashe_live.light.shape.directions import FittedLight
from tests.light.lamps.test_hypotheses import FIT, LAMP_M, by_a_sun, hypotheses
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, Caster

SHARED = math.radians(0.4) ** 2 * np.eye(2)


def seen(azimuth_deg: float, elevation_deg: float, sigma_deg: float) -> FittedLight:
    """A sun as an object shows it, with errors of its own of so many degrees along either axis, and shared ones."""
    direction = direction_from_angles(math.radians(azimuth_deg), math.radians(elevation_deg))
    return FittedLight(np.append(direction, 0.0), math.radians(sigma_deg) ** 2 * np.eye(2) + SHARED)


def together(*objects: FittedLight) -> Light:
    first = objects[0]
    return by_all_objects(Light(first.to_light_marker, first.covariance_rad2, 0.1, 0.9), objects, lambda _: SHARED)


def test_two_objects_that_are_as_exact_meet_in_the_middle_and_halve_the_variance_of_their_own() -> None:
    light = together(seen(30, 50, 2.0), seen(30, 54, 2.0))
    middle = direction_from_angles(math.radians(30), math.radians(52))
    assert angle_between(light.to_light_marker, middle) < math.radians(0.02)
    assert light.covariance_rad2 == pytest.approx(math.radians(2.0) ** 2 / 2 * np.eye(2) + SHARED, rel=0.01, abs=1e-5)


def test_the_vaguer_object_counts_by_its_information() -> None:
    light = together(seen(30, 50, 1.0), seen(30, 55, 2.0))
    expected = direction_from_angles(math.radians(30), math.radians(50 + 5 * (1 / 4) / (1 + 1 / 4)))
    assert angle_between(light.to_light_marker, expected) < math.radians(0.02)


def test_an_object_that_constrains_only_the_azimuth_moves_only_that() -> None:
    exact, vague = math.radians(0.5) ** 2, math.radians(40.0) ** 2
    of_azimuth = FittedLight(seen(33, 45, 1.0).light, np.diag([exact, vague]) + SHARED)
    first = seen(30, 40, 2.0)
    light = together(first, of_azimuth)
    east, up = tangent_basis(first.to_light_marker) @ (light.to_light_marker - first.to_light_marker)
    assert east > math.radians(1.8)
    assert abs(up) < math.radians(0.15)


def test_near_the_zenith_covariances_are_turned_with_their_axes() -> None:
    """Two suns 2° beside the zenith on opposite sides: what is up for one is down for the other."""
    narrow, wide = math.radians(0.5) ** 2, math.radians(4.0) ** 2
    several = [FittedLight(seen(azimuth, 88, 1.0).light, np.diag([wide, narrow]) + SHARED) for azimuth in (0, 180)]
    light = together(*several)
    assert angle_between(light.to_light_marker, np.array([0.0, 0.0, 1.0])) < math.radians(0.1)


def test_near_the_zenith_what_is_stated_keeps_its_axes_in_space() -> None:
    """Two suns 2° beside the zenith, a quarter turn apart, both uncertain along x: their mean is so, too."""
    narrow, wide = math.radians(0.5) ** 2, math.radians(4.0) ** 2
    # At the first, up is along x; at the other one, east is.
    along_x = {0: np.diag([narrow, wide]), 90: np.diag([wide, narrow])}
    several = [FittedLight(seen(azimuth, 88, 1.0).light, own + SHARED) for azimuth, own in along_x.items()]
    light = together(*several)
    basis = tangent_basis(light.to_light_marker)
    assert light.covariance_rad2 is not None
    in_space = (basis.T @ light.covariance_rad2 @ basis)[:2, :2]
    assert in_space == pytest.approx(np.diag([wide, narrow]) / 2 + SHARED, rel=0.02, abs=1e-6)


def test_more_objects_never_make_the_shared_error_smaller() -> None:
    light = together(*(seen(30, 50, 1.0) for _ in range(50)))
    assert (np.linalg.eigvalsh(light.covariance_rad2) >= SHARED[0, 0]).all()


def test_what_an_object_errs_by_itself_is_what_the_pose_leaves_in_its_own_direction() -> None:
    """A marker that may be turned about x by 2° moves a sun in the east sideways, and one 12° aside up as well.

    The second object shows the elevation to 1°, and it alone; it is no surer of that where the pose says less.
    """
    of_turn = np.diag(np.radians([2.0, 0.2, 0.2]) ** 2)

    def by_pose(to_light: np.ndarray) -> np.ndarray:
        east, up = tangent_basis(to_light)
        by_turn = np.array([up, -east])
        return by_turn @ of_turn @ by_turn.T + SHARED

    def shown(azimuth_deg: float, own_deg: tuple[float, float]) -> FittedLight:
        direction = direction_from_angles(math.radians(azimuth_deg), math.radians(40))
        own = np.diag(np.radians(own_deg) ** 2)
        return FittedLight(np.append(direction, 0.0), own + by_pose(direction))

    first, second = shown(45, (1.0, 1.0)), shown(33, (30.0, 1.0))
    light = by_all_objects(Light(first.to_light_marker, first.covariance_rad2, 0.1, 0.9), [first, second], by_pose)
    own = light.covariance_rad2 - by_pose(first.to_light_marker)
    assert math.degrees(math.sqrt(own[1, 1])) == pytest.approx(1 / math.sqrt(2), rel=0.05)


def test_the_place_of_a_sun_is_at_infinity_in_its_direction() -> None:
    place = place_of_sun(seen(30, 50, 1.0))
    assert place.light == pytest.approx(seen(30, 50, 1.0).light)
    assert place.nearness_sigma < 0.01


@pytest.mark.parametrize("caster", [BOX, CYLINDER], ids=lambda caster: caster.shape)
def test_what_a_lamps_explanation_says_of_a_sun_is_seen_from_its_object(caster: Caster) -> None:
    """The lamp's own direction is that at the marker, which differs by 12 degrees."""
    here = painted_region(caster, ground="bricks", lamp_m=LAMP_M)
    sun, sharpener = by_a_sun(here)
    lamp = hypotheses(here).decided(sun, FIT, sharpener)
    assert lamp.lights[0].is_lamp
    body = lamp.lit.body
    from_object = np.array(LAMP_M) - (*body.frame.origin_marker, body.middle_m)
    assert angle_between(from_object, np.array(LAMP_M)) > math.radians(11)
    covariance = lamp.lights[0].covariance_rad2
    as_sun = SeenObject(lamp, 0.9, covariance, 2.0).as_sun
    assert angle_between(as_sun.to_light_marker, from_object) < math.radians(5)
    unchanged = SeenObject(sun, 0.9, covariance, 2.0).as_sun
    np.testing.assert_allclose(unchanged.to_light_marker, sun.lights[0].to_light_marker)
