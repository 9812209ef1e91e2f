"""When another estimate is worth its work."""

import dataclasses
import math

from ashe_live.core.camera import Camera
from ashe_live.viewer.estimates.sharpening import CHECKED_EVERY_S, EVERY_S, FUTILE, RENEWED_AFTER_S, Sharpening


def orbit(fakes, count: int, step_deg: float, first: int = 0) -> tuple:
    return tuple(fakes.tracked(first + at, tilt_deg=step_deg * at) for at in range(count))


def asked(views, now_s: float = 0.0) -> Sharpening:
    sharpening = Sharpening()
    sharpening.asked(views, now_s)
    return sharpening


def test_views_that_span_more_are_worth_another_estimate_and_the_same_again_are_not(fakes):
    views = orbit(fakes, 3, 2.0)
    sharpening = asked(views)
    assert not sharpening.is_due_for(views, 10.0)
    assert not sharpening.is_due_for((*views, fakes.tracked(9, tilt_deg=4.2)), 10.0)
    assert sharpening.is_due_for((*views, fakes.tracked(9, tilt_deg=7.0)), 10.0)


def test_a_hands_trembling_is_no_wider_span_by_whatever_factor_it_grows(fakes):
    still = orbit(fakes, 2, 0.2)
    settled = asked(still)
    for _ in range(FUTILE):
        settled.answered(False)
    for sharpening, wider_deg in ((asked(still), 0.6), (settled, 1.5)):
        assert not sharpening.is_due_for((still[0], fakes.tracked(9, tilt_deg=wider_deg)), 10.0)
        assert sharpening.is_due_for((still[0], fakes.tracked(9, tilt_deg=wider_deg + 2.0)), 10.0)


def test_where_nothing_is_seen_nothing_is_worth_an_estimate():
    sharpening = Sharpening()
    assert sharpening.span_rad == 0
    assert not sharpening.is_due_for((), 10.0)


def test_one_estimate_at_a_time_and_not_too_often(fakes):
    sharpening = asked(orbit(fakes, 2, 2.0), 100.0)
    wider = orbit(fakes, 4, 2.0)
    assert not sharpening.is_due_for(wider, 100.0 + EVERY_S / 2)
    assert sharpening.is_due_for(wider, 100.0 + 1.01 * EVERY_S)


def test_new_views_over_the_same_span_are_worth_it_once_there_are_enough(fakes):
    views = orbit(fakes, 6, 3.0)
    sharpening = asked(views)
    assert not sharpening.is_due_for((*views[:5], fakes.tracked(20, tilt_deg=15.0)), 10.0)
    renewed = (*views[:3], *orbit(fakes, 6, 3.0, first=30)[3:])
    assert sharpening.is_due_for(renewed, 10.0)


def test_one_new_view_of_few_and_two_of_many_are_not_enough(fakes):
    for count, new in ((3, 1), (9, 2)):
        views = orbit(fakes, count, 3.0)
        others = orbit(fakes, count, 3.0, first=30)
        assert not asked(views).is_due_for((*views[:-new], *others[-new:]), 10.0)
        assert asked(views).is_due_for(others, 10.0)


def test_a_clip_that_begins_again_is_not_estimated_from_less_than_is_known(fakes):
    sharpening = asked(orbit(fakes, 8, 4.0))
    for count in range(1, 7):
        assert not sharpening.is_due_for(orbit(fakes, count, 4.0, first=100), 10.0 * count)


def test_it_ends_when_nothing_is_gained_and_goes_on_where_much_more_is_seen(fakes):
    sharpening = Sharpening()
    for at in range(FUTILE):
        assert not sharpening.is_settled
        sharpening.asked(orbit(fakes, 3 + at, 4.0), float(at))
        sharpening.answered(is_sharper=False)
    assert sharpening.is_settled
    assert not sharpening.is_due_for(orbit(fakes, 6, 4.0), 10.0)
    assert sharpening.is_due_for(orbit(fakes, 8, 4.0), 10.0)
    for is_sharper in (True, *[False] * (FUTILE - 1)):
        sharpening.answered(is_sharper)
        assert not sharpening.is_settled


def test_a_watched_scene_is_looked_at_less_often_once_nothing_is_gained_and_estimated_again_in_the_end(fakes):
    sharpening = asked(orbit(fakes, 1, 0.0), 100.0)
    assert sharpening.is_due_again(100.0 + EVERY_S)
    for _ in range(FUTILE):
        assert not sharpening.is_up_to_date(100.0 + EVERY_S)
        sharpening.answered(is_sharper=False)
    assert not sharpening.is_due_again(100.0 + EVERY_S)
    assert sharpening.is_due_again(100.0 + CHECKED_EVERY_S)
    assert sharpening.is_up_to_date(100.0 + CHECKED_EVERY_S)
    later_s = 101.0 + RENEWED_AFTER_S
    assert not sharpening.is_up_to_date(later_s)
    assert math.isclose(sharpening.span_rad, 0.0)
    sharpening.asked(orbit(fakes, 1, 0.0), later_s)
    sharpening.verified()
    assert sharpening.is_up_to_date(later_s + CHECKED_EVERY_S)


def test_views_by_a_focal_length_that_has_become_known_are_worth_it_all_the_same(fakes):
    sharpening = Sharpening()
    views = orbit(fakes, 6, 3.0)
    for at in range(FUTILE):
        sharpening.asked(views, float(at))
        sharpening.answered(is_sharper=False)
    again = orbit(fakes, 6, 3.0, first=50)
    assert not sharpening.is_due_for(again, 10.0)
    known = Camera.from_hfov(again[0].camera.size, 50)
    by_it = tuple(dataclasses.replace(view, camera=known) for view in again)
    assert sharpening.is_due_for(by_it, 10.0)
    assert asked(views[:1]).is_due_for(by_it[:1], 10.0)
    # What was learned by the other is forgotten: how wide its views were, too.
    sharpening.asked(by_it[:3], 10.0)
    for _ in range(FUTILE):
        assert not sharpening.is_settled
        sharpening.answered(is_sharper=False)
    assert sharpening.is_due_for(by_it, 20.0)
