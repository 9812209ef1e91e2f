"""A body in the frame of a guess, and what it is in the marker's."""

import numpy as np
import pytest

from ashe_live.light.body import Body
from ashe_live.light.proxies import FAMILIES
from tests.light.painted_bodies import body_of
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX, CYLINDER, Caster
from tests.light.synthetic_masks import direction


def painted(caster: Caster) -> Body:
    return body_of(painted_region(caster), caster)


def test_a_boxs_corners_are_in_metres_where_it_stands() -> None:
    points = painted(BOX).proxy.spheroids_marker
    expected = np.concatenate([np.roll(corners, 2, axis=0) for corners in (BOX.base(), BOX.top())])
    np.testing.assert_allclose(points[:, :3], expected, atol=1e-12)
    np.testing.assert_array_equal(points[:, 3:], 0)


def test_a_cylinders_rings_are_in_metres_where_it_stands() -> None:
    (x, y), radius = CYLINDER.at, CYLINDER.width_m / 2
    expected = [(x, y, 0, radius, 0), (x, y, CYLINDER.height_m, radius, 0)]
    np.testing.assert_allclose(painted(CYLINDER).proxy.spheroids_marker, expected, atol=1e-12)


def test_a_radius_has_no_sign() -> None:
    body = painted(CYLINDER)
    turned = body.moved(np.array([0, 0, 0, 0, 0, -2 * body.shape[3], -2 * body.shape[4]]))
    np.testing.assert_allclose(turned.proxy.spheroids_marker, body.proxy.spheroids_marker)


def test_lights_are_unit_vectors_from_which_the_shadow_falls() -> None:
    here = painted_region(BOX)
    lights = [here.scene.to_light, direction(30.0, 5.0), direction(0.0, 90.0)]
    for towards, light in zip(body_of(here, BOX, *lights).to_lights_marker, lights, strict=True):
        np.testing.assert_allclose(towards, light, atol=1e-12)


@pytest.mark.parametrize("name", FAMILIES)
def test_steps_go_to_slants_first_and_back_again(name: str) -> None:
    start = body_of(painted_region(BOX), BOX, direction(30.0, 40.0), direction(110.0, 70.0))
    count = len(FAMILIES[name].spread)
    body = Body(start.guess, FAMILIES[name], start.slants, np.linspace(-1, 1, count))
    step = np.arange(4.0 + count)
    there = body.moved(step)
    np.testing.assert_array_equal(there.slants, body.slants + step[:4].reshape(2, 2))
    np.testing.assert_array_equal(there.shape, body.shape + step[4:])
    np.testing.assert_allclose(there.moved(-step).proxy.spheroids_marker, body.proxy.spheroids_marker, atol=1e-12)
    assert (body.proxy.spheroids_marker[:, 3:] >= 0).all()
