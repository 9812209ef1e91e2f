"""Steps of light across outlines: where they are, which way they rise, and when there is none."""

import math
from functools import cache

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ashe_live.core.arrays import Float, Float32, unit_circle
from ashe_live.light.edges.outline_points import evenly_spaced
from ashe_live.light.edges.steps import (
    LEAST_SIGMA_PX,
    MOST_UNLIKE,
    RISE_SHARE,
    RISE_SLACK,
    LightPicture,
    Steps,
    steps_across,
)
from ashe_live.light.pixels.view import View
from tests.light.painted_scenes import BOX, paint

SHAPE = (96, 128)
CENTRE = np.array([64.0, 48.0])
RADIUS, REACH_PX, FINER = 24.0, 4.0, 8
LIT = np.array([0.3, 0.35, 0.4])
ANY = np.array([np.nan])


def disc(radius: float = RADIUS) -> Float:
    """(128, 2) a closed outline."""
    return np.asarray(CENTRE + radius * unit_circle(128))


@cache
def covered(radius: float, blur_px: float) -> Float:
    """(h, w) how much of each pixel a disc covers, blurred as a camera does."""
    y, x = (np.indices((FINER * SHAPE[0], FINER * SHAPE[1])) + 0.5) / FINER - 0.5
    inside = np.hypot(x - CENTRE[0], y - CENTRE[1]) < radius
    blurred = cv2.GaussianBlur(inside.astype(np.float64), (0, 0), FINER * blur_px)
    return cv2.resize(blurred, SHAPE[::-1], interpolation=cv2.INTER_AREA)


def picture(radius: float, ratio: float, blur_px: float = 0.7, noise: float = 0.0, slope: float = 0.0) -> Float32:
    """(h, w, 3) linear light: a disc with so much of the light around it, blurred in linear light."""
    small = (1 + (ratio - 1) * covered(radius, blur_px))[..., None] * LIT
    small *= np.exp(slope * (np.arange(SHAPE[1]) - CENTRE[0]))[:, None]
    return np.asarray(small + np.random.default_rng(0).normal(0, 1, small.shape) * noise, np.float32)


def steps_of(linear: Float32, hull: Float | None = None, reach_px: float = REACH_PX, rise: float = np.nan) -> Steps:
    return steps_across(linear, evenly_spaced([disc() if hull is None else hull]), reach_px, np.array([rise]))


@pytest.mark.parametrize("offset_px", [-2.4, -1.0, -0.3, 0.0, 0.2, 0.7, 1.6, 2.7])
@pytest.mark.parametrize("ratio", [0.08, 0.25, 0.6, 1.6, 4.0])
@pytest.mark.parametrize("blur_px", [0.4, 1.2])
def test_a_step_is_found_where_half_of_the_light_is_reached(blur_px: float, ratio: float, offset_px: float) -> None:
    """However deep: in the log of light, half of a step to a tenth would be a third of it."""
    found = steps_of(picture(RADIUS + offset_px, ratio, blur_px))
    assert (found.information > 0).all()
    # Parallel profiles through a circle lie a little outside of it, by their squared distance over its diameter.
    assert np.median(found.offset_px) == pytest.approx(offset_px, abs=0.1)
    assert found.offset_px.std() < 0.1


def test_a_wide_penumbra_has_its_middle_where_it_is() -> None:
    found = steps_of(picture(RADIUS + 0.5, 0.2, blur_px=2.0))
    assert np.median(found.offset_px) == pytest.approx(0.5, abs=0.15)


@pytest.mark.parametrize("ratio", [0.2, 0.5, 3.0])
def test_a_rise_is_the_logs_difference_going_out(ratio: float) -> None:
    """To 5 %: a little less than what is expected is found, a little more than its sigmas allow is not."""
    here, sign = picture(RADIUS, ratio), -np.sign(math.log(ratio))

    def found_at_most(share: float) -> Steps:
        """The steps, if so much of the true rise is the most that the expected rise allows."""
        most = share * abs(math.log(ratio))
        expected = (most - MOST_UNLIKE * RISE_SLACK) / (1 + MOST_UNLIKE * RISE_SHARE)
        return steps_of(here, rise=sign * expected)

    assert (found_at_most(1.05).information > 0).all()
    assert not found_at_most(0.92).information.any()


def test_slow_shading_moves_no_step() -> None:
    plain, shaded = (steps_of(picture(RADIUS, 0.3, slope=slope)) for slope in (0.0, 0.01))
    np.testing.assert_allclose(shaded.offset_px, plain.offset_px, atol=0.05)


def test_the_fainter_a_step_the_less_is_known() -> None:
    known = [steps_of(picture(RADIUS, ratio, noise=0.01)).information.mean() for ratio in (0.2, 0.7, 0.9)]
    assert known[0] > known[1] > known[2]
    assert known[0] <= 1 / LEAST_SIGMA_PX**2


def test_errors_are_as_large_as_they_are_said_to_be() -> None:
    found = steps_of(picture(RADIUS, 0.6, noise=0.02))
    squares = (found.offset_px**2 * found.information)[found.information > 0]
    assert 0.1 < squares.mean() < 2


def test_a_flat_picture_has_no_step() -> None:
    assert not steps_of(np.full((*SHAPE, 3), 0.3, np.float32)).information.any()


def test_a_step_beyond_the_reach_is_not_taken() -> None:
    found = steps_of(picture(RADIUS + 6.0, 0.2))
    assert (found.information > 0).mean() < 0.05


def test_of_two_steps_the_nearer_one_is_taken_if_both_are_as_clear() -> None:
    both = picture(RADIUS - 3.0, 0.5) * picture(RADIUS + 1.0, 0.5) / LIT.astype(np.float32)
    assert np.median(steps_of(both).offset_px) == pytest.approx(1.0, abs=0.3)


def test_of_two_steps_the_one_that_rises_as_the_shadow_should_is_taken() -> None:
    """The nearer and stronger one may be the ground's pattern."""
    both = picture(RADIUS - 0.5, 1 / 5.0) * picture(RADIUS + 3.0, 0.6) / LIT.astype(np.float32)
    assert np.median(steps_of(both, rise=-math.log(0.2)).offset_px) == pytest.approx(-0.5, abs=0.3)
    assert np.median(steps_of(both, rise=-math.log(0.6)).offset_px) == pytest.approx(3.0, abs=0.3)


def test_a_step_of_quite_another_rise_is_not_the_shadows() -> None:
    here = picture(RADIUS, 0.3)
    assert (steps_of(here, rise=-math.log(0.3)).information > 0).all()
    for rise in (math.log(0.3), 0.2, 4.0):
        assert not steps_of(here, rise=rise).information.any()


def test_a_mirrored_picture_has_mirrored_steps() -> None:
    here = picture(RADIUS + 0.7, 0.3, noise=0.005)
    mirror = disc() * (-1, 1) + (SHAPE[1] - 1, 0)
    plain = steps_across(here, evenly_spaced([disc()]), REACH_PX, ANY)
    mirrored = steps_across(np.ascontiguousarray(here[:, ::-1]), evenly_spaced([mirror]), REACH_PX, ANY)
    assert np.sort(mirrored.offset_px[0]) == pytest.approx(np.sort(plain.offset_px[0]), abs=1e-3)


def test_several_outlines_are_measured_as_each_is_alone() -> None:
    here, hulls = picture(RADIUS, 0.3), [disc(), disc(RADIUS - 2), disc(RADIUS + 1)[::-1]]
    together = steps_across(here, evenly_spaced(hulls), REACH_PX, ANY.repeat(3))
    for i, hull in enumerate(hulls):
        np.testing.assert_allclose(together.offset_px[i], steps_of(here, hull).offset_px[0], atol=1e-3)


@settings(max_examples=40)
@given(st.integers(0, 2**31), st.floats(0, 1), st.floats(1, 12), st.floats(-300, 300))
def test_no_picture_makes_numbers_that_are_none(seed: int, level: float, reach_px: float, away_px: float) -> None:
    noise = np.random.default_rng(seed).uniform(0, level, (*SHAPE, 3)).astype(np.float32)
    found = steps_of(noise, disc() + away_px, reach_px)
    for values in (found.offset_px, found.information):
        assert np.isfinite(values).all()
    assert (np.abs(found.offset_px) <= reach_px).all()
    assert (found.information <= 1 / LEAST_SIGMA_PX**2).all()


def test_only_ground_in_the_picture_is_reliable() -> None:
    scene = paint(BOX)
    here = LightPicture.of(View.of(scene.tracked, 640))
    y, x = np.argwhere(scene.sheet)[len(np.argwhere(scene.sheet)) // 2]
    points = np.array([(300.0, 470.0), (-1.0, 100.0), (639.0, 100.0), (np.nan, 5.0), (x, y), (1e9, -1e9)])
    assert here.is_reliable_at(points).tolist() == [True, False, False, False, False, False]
