"""An explanation fitted again with its light near: at a nearness that is held, or that the steps of light move."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest

from ashe_live.core.transforms import angle_between
from ashe_live.light.estimators.preset import BALANCED, FAST
from ashe_live.light.estimators.proxy import ProxyEstimator
from ashe_live.light.explanation.explain import explained_near
from ashe_live.light.explanation.explanation import Explanation
from ashe_live.light.explanation.sharpen import Sharpener
from ashe_live.light.lamps.kinds import SUN
from ashe_live.light.lamps.near_fits import fitted_near, in_all_views
from ashe_live.light.pixels.view import View
from ashe_live.light.shape.layout import nearness_of
from tests.light.lamps.test_hypotheses import FIT, LAMP_M, by_a_sun
from tests.light.painted_regions import painted_region
from tests.light.painted_scenes import BOX
from tests.light.painted_views import painted_from

NEARNESS = 1 / LAMP_M[2]
HEADINGS_DEG = (90, 50)


def no_fit(several: Sequence[tuple[Explanation, float]]) -> list[Explanation | None]:
    return [None for _ in several]


def first_nearness(explanation: Explanation | None) -> float:
    assert explanation is not None
    return float(nearness_of(explanation.lights[0].light))


@pytest.mark.parametrize("factor", [0.75, 1.3])
def test_steps_of_light_move_the_only_lamp_towards_where_it_is(factor: float) -> None:
    sun, sharpener = by_a_sun(painted_region(BOX, ground="bricks", lamp_m=LAMP_M))
    near = fitted_near(sun, factor * NEARNESS, FIT, sharpener)
    moved = abs(first_nearness(near) / NEARNESS - 1)
    assert 0 < moved < 0.8 * abs(factor - 1)


def test_a_sun_stays_at_infinity_and_a_lamp_beside_another_light_where_it_is_held() -> None:
    lamp, sharpener = by_a_sun(painted_region(BOX, ground="bricks", lamp_m=LAMP_M))
    assert first_nearness(fitted_near(lamp, 0.0, FIT, sharpener)) == 0
    two = replace(lamp, lights=lamp.lights * 2)
    assert first_nearness(fitted_near(two, NEARNESS, FIT, sharpener)) == pytest.approx(NEARNESS, rel=1e-6)


def test_what_does_not_fit_in_the_only_view_is_no_explanation() -> None:
    sun, sharpener = by_a_sun(painted_region(BOX, ground="bricks", lamp_m=LAMP_M))
    assert fitted_near(sun, NEARNESS, no_fit, sharpener) is None


@cache
def in_two_views() -> tuple[Explanation, Sharpener]:
    first, other = (painted_from(heading, BOX, lamp_m=np.array(LAMP_M), size=(320, 240)) for heading in HEADINGS_DEG)
    _, trace = ProxyEstimator(FAST.assuming(SUN)).traced(first.tracked, [other.tracked])
    likeliest = trace.judged[int(np.argmax(trace.probabilities))]
    assert likeliest.alignment.elsewhere
    return likeliest, Sharpener.of([View.of(each.tracked, BALANCED.fine_width_px) for each in (first, other)])


def test_two_views_bring_a_lamp_nearer_to_where_it_is_whether_or_not_it_fits_in_one() -> None:
    one, sharpener = in_two_views()
    for fit in (no_fit, partial(explained_near, preset=FAST.fine_fit)):
        near = fitted_near(one, 1.3 * NEARNESS, fit, sharpener)
        assert near is not None
        assert abs(first_nearness(near) / NEARNESS - 1) < 0.15
        assert np.degrees(angle_between(near.lights[0].to_light_marker, np.array(LAMP_M))) < 2
        assert near.split is one.split
        assert near.alignment.elsewhere


def test_of_what_two_views_hold_at_a_nearness_and_what_fits_in_one_the_likelier_is_kept() -> None:
    one, sharpener = in_two_views()
    (sun,) = explained_near([(one, 0.0)], FAST.fine_fit)
    assert first_nearness(sun) == 0
    for again in (None, sun):
        held = in_all_views(one, again, 1.1 * NEARNESS, None, sharpener)
        assert first_nearness(held) == pytest.approx(1.1 * NEARNESS, rel=1e-6)
