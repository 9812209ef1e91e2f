"""Tangents from the light's vanishing point hold for any shape, and tell of wrong directions."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ashe_live.core.arrays import Float
from ashe_live.core.transforms import angle_between
from ashe_live.light.outline_fit.tangents import lights_refined_by_tangents, tangent_gaps
from ashe_live.light.shape.layout import light_parameters
from ashe_live.light.shape.light_points import at_infinity
from ashe_live.light.shape.outlines.silhouettes import Outlines, observe_outlines
from tests.light.synthetic_masks import MaskedScene, ball, camera_towards, direction, render

VIEW = camera_towards((0.08, 0.0), 0.4, 40.0)
LIGHT = direction(140.0, 40.0)
LAMP = np.array([*((0.1, 0.0, 0.05) + 0.3 * direction(140.0, 45.0)), 1.0])


def floating_scene(light: Float = LIGHT) -> MaskedScene:
    """A blob that no family describes, off the ground, so that nothing of its shadow is hidden."""
    rng = np.random.default_rng(1)
    points = ball(0.1, 0.0, 0.03)[0] * (1.0, 1.0, 0.6) + (0.0, 0.0, 0.05)
    spikes = rng.normal(size=(5, 3)) * 0.03 + (0.1, 0.0, 0.08)
    return render([np.concatenate([points, spikes])], [light], VIEW)


def seen(scene: MaskedScene) -> tuple[Float, Outlines]:
    outlines = observe_outlines(scene.body, scene.shadows, None, 48)
    assert outlines is not None
    x, y = outlines.centre_px
    return np.array([[1, 0, -x], [0, 1, -y], [0, 0, 1]]) @ scene.camera.K @ scene.T_cam_marker[:3], outlines


def test_they_meet_for_the_true_light_whatever_the_shape() -> None:
    P, outlines = seen(floating_scene())
    gaps = tangent_gaps(P, outlines.body, outlines.shadows[0], at_infinity(LIGHT)).px
    assert (np.abs(gaps) < 0.6).all()


def test_they_meet_for_the_true_lamp_and_not_for_a_sun_in_its_direction() -> None:
    P, outlines = seen(floating_scene(LAMP))
    sun = at_infinity(LAMP[:3] - (0.1, 0.0, 0.05))
    gaps, wrong = (tangent_gaps(P, outlines.body, outlines.shadows[0], each).px for each in (LAMP, sun))
    assert (np.abs(gaps) < 0.6).all()
    assert np.abs(wrong).max() > 2.0


def test_they_find_the_lamp_of_a_known_height() -> None:
    P, outlines = seen(floating_scene(LAMP))
    across = np.array([LAMP[1], -LAMP[0], 0.0, 0.0]) / np.hypot(*LAMP[:2])
    start = LAMP[None] + 0.05 * across
    found, _ = lights_refined_by_tangents(P, outlines, start, 25.0 * np.eye(2), None)
    assert found[0, 2] / found[0, 3] == pytest.approx(LAMP[2])
    assert abs((found / found[:, 3:] - LAMP)[0] @ across) < 0.4 * 0.05


@pytest.mark.parametrize("azimuth_deg", [125.0, 155.0])
def test_they_part_for_a_wrong_one(azimuth_deg: float) -> None:
    P, outlines = seen(floating_scene())
    wrong = direction(azimuth_deg, 40.0)
    gaps = tangent_gaps(P, outlines.body, outlines.shadows[0], at_infinity(wrong)).px
    assert np.abs(gaps).max() > 3.0


@pytest.mark.parametrize("light", [(-1.0, 0.9, 1.0, 0.0), (-0.7, 0.8, 1.0, 0.0), (-1.4, 1.5, 1.0, 0.5)])
def test_their_derivatives_are_exact(light: tuple[float, ...]) -> None:
    P, outlines = seen(floating_scene())
    at = np.array(light)
    by_light = tangent_gaps(P, outlines.body, outlines.shadows[0], at).by_light
    for axis, step in enumerate(1e-6 * np.eye(4)[:2]):
        ahead, back = (tangent_gaps(P, outlines.body, outlines.shadows[0], each).px for each in (at + step, at - step))
        # The gaps' scale changes too, in proportion to the gap; that is left out of the derivative.
        assert np.allclose(by_light[..., axis], (ahead - back) / 2e-6, rtol=0.3, atol=2.0)


def test_they_find_the_light_without_a_body() -> None:
    P, outlines = seen(floating_scene())
    start = direction(148.0, 46.0)
    lights, covariance = lights_refined_by_tangents(P, outlines, at_infinity(start[None]), 1e-2 * np.eye(2), None)
    found = lights[0, :3]
    assert math.degrees(angle_between(found, LIGHT)) < 2.0
    assert math.degrees(angle_between(found, LIGHT)) < 0.5 * math.degrees(angle_between(start, LIGHT))
    assert (np.linalg.eigvalsh(covariance) > 0).all()


def test_a_shadow_that_is_cut_bounds_the_light_but_makes_it_no_more_certain() -> None:
    """Its seen part is beyond what a higher light would cast; a lower one is as likely as before."""
    P, outlines = seen(floating_scene())
    shadow = outlines.shadows[0]
    cut = replace(outlines, shadows=(replace(shadow, certain=np.zeros_like(shadow.certain)),))
    information = np.array([[2e-2, 5e-3], [5e-3, 1e-2]])
    moved = []
    for azimuth_deg in (125.0, 140.0, 155.0):
        wrong = direction(azimuth_deg, 40.0)
        start = at_infinity(wrong[None])
        lights, covariance = lights_refined_by_tangents(P, cut, start, information, None)
        np.testing.assert_allclose(covariance, np.linalg.inv(information), rtol=1e-9)
        moved.append(float(np.abs(light_parameters(lights) - light_parameters(start)).max()))
    assert max(moved) > 0.01


def test_a_light_behind_the_object_is_no_division_by_zero() -> None:
    P, outlines = seen(floating_scene())
    towards_centre = -np.linalg.inv(P[:, :3]) @ (0.0, 0.0, 1.0)
    light = at_infinity(towards_centre)
    gaps = tangent_gaps(P, outlines.body, outlines.shadows[0], light)
    assert np.array_equal(gaps.px, np.zeros(2))
    assert np.array_equal(gaps.by_light, np.zeros((2, 2)))
