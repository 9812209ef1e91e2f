"""Which of several answers stands: the sharpest about one light, the new one once the light has changed."""

import dataclasses
import math

import cv2
import numpy as np
import pytest

from ashe_live.core.camera import Camera
from ashe_live.core.light import Illumination, Light, LightEstimate
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between, direction_from_angles, radius_of_68_percent, rigid, tangent_basis
from ashe_live.core.types import Frame, MarkerPose, TrackedFrame
from ashe_live.light.live.held_answer import AS_SHARP, AS_SURE, CHANGED_AFTER, RESTS_NO_LONGER, HeldAnswer, agree
from ashe_live.light.views.in_view import share_shown

SUN = direction_from_angles(0.7, 0.8)
LAMP = direction_from_angles(3.0, 0.6)
NONE = LightEstimate("test", 0, Illumination(), "no shadow found")


def turned(direction, east_deg: float, up_deg: float):
    return direction + np.radians([east_deg, up_deg]) @ tangent_basis(direction)


def light(direction, sigma_deg=2.0, confidence=0.8, depth: float = 0.4) -> Light:
    covariance = np.radians(sigma_deg) ** 2 * np.eye(2)
    sigma_rad = radius_of_68_percent(covariance)
    return Light(direction, covariance, sigma_rad, confidence, shadow_rgb_ratio=np.full(3, depth))


def estimate(*lights: Light, views: int = 1) -> LightEstimate:
    span_rad = None if views == 1 else 0.05 * views
    return LightEstimate("test", 0, Illumination(lights), views=tuple(range(views)), span_rad=span_rad)


def held(*offered: LightEstimate) -> HeldAnswer:
    answer = HeldAnswer()
    for each in offered:
        answer.offer(each)
    return answer


def error_deg(answer: HeldAnswer, truth) -> float:
    return math.degrees(angle_between(answer.estimate.light.to_light_marker, truth))


@pytest.mark.parametrize(
    ("one", "other", "is_same"),
    [
        (light(SUN, depth=0.3), light(SUN, depth=0.42), True),
        (light(SUN, depth=0.3), light(SUN, depth=0.5), False),
        (light(SUN, depth=0.0), light(SUN, depth=4e-4), True),  # both are black
        (light(SUN, depth=0.0), light(SUN, depth=0.05), False),
        (light(SUN, 0.1), light(turned(SUN, 5, 0), 0.1), True),  # masks change from frame to frame
        (light(SUN, 0.1), light(turned(SUN, 9, 0), 0.1), False),
        (light(SUN, 0.1), light(turned(SUN, 9, 0), 3.0), True),  # of which one is as vague
        (light(SUN, 0.1), Light(turned(SUN, 20, 0)), True),  # who states no error may be off by this
        (light(SUN, 0.1), Light(turned(SUN, 40, 0)), False),
    ],
)
def test_two_answers_agree_by_the_errors_of_both_and_whichever_came_first(one, other, is_same) -> None:
    assert agree(estimate(one), estimate(other)) is is_same
    assert agree(estimate(other), estimate(one)) is is_same


def test_a_sharper_answer_replaces_the_one_held_and_is_said_to_gain() -> None:
    answer = held(estimate(light(turned(SUN, 2, 0), 4.0)))
    assert answer.offer(estimate(light(SUN, 1.0), views=7))
    assert error_deg(answer, SUN) < 1e-6
    assert not answer.is_news


def test_a_vaguer_or_more_doubtful_answer_about_the_same_light_takes_nothing_away() -> None:
    answer = held(estimate(light(SUN, 1.0, 0.9)))
    for vague in (light(turned(SUN, 1, 0), 4.0, 0.95), light(turned(SUN, 1, 0), 1.0, 0.6)):
        assert not answer.offer(estimate(vague))
        assert answer.estimate.light.sigma_rad < math.radians(1.6)
        assert answer.estimate.light.confidence == 0.9


def test_watching_on_never_makes_anybody_less_sure_of_an_unchanged_light() -> None:
    rng = np.random.default_rng(5)
    answer, sure, sharp = HeldAnswer(), [], []
    for _ in range(60):
        near = light(turned(SUN, *rng.normal(0, 1, 2)), rng.uniform(1, 5), rng.uniform(0.5, 0.95))
        answer.offer(estimate(near))
        sure.append(answer.estimate.light.confidence)
        sharp.append(answer.estimate.light.sigma_rad)
    assert sure[-1] >= max(sure) - AS_SURE
    assert sharp[-1] <= AS_SHARP * min(sharp)


def test_from_more_views_a_much_sharper_answer_is_taken_though_it_is_rated_a_little_less_sure() -> None:
    answer = held(estimate(light(SUN, 3.6, 0.91), views=4))
    assert answer.offer(estimate(light(SUN, 2.8, 0.88), views=6))
    assert answer.offer(estimate(light(SUN, 2.0, 0.86), views=8))
    assert not answer.offer(estimate(light(SUN, 1.0, 0.80), views=12)), "not step by step to any confidence"
    assert answer.estimate.light.confidence == 0.86


def test_answers_that_are_each_a_little_vaguer_do_not_take_the_light_step_by_step_to_any_uncertainty() -> None:
    answer = held(*(estimate(light(SUN, 2.0 * 1.08**step)) for step in range(9)))
    assert answer.estimate.light.sigma_rad <= AS_SHARP * light(SUN, 2.0).sigma_rad
    assert answer.offer(estimate(light(SUN, 1.5))), "a sharper one is taken as ever"


def test_a_surer_answer_that_is_as_sharp_gains_too() -> None:
    answer = held(estimate(light(SUN, 2.0, 0.7)))
    assert answer.offer(estimate(light(SUN, 2.0, 0.8)))
    assert not answer.offer(estimate(light(SUN, 2.0, 0.8)))


def test_a_doubtful_answer_that_seems_sharper_does_not_keep_out_newer_ones_that_are_as_good_as_the_held_one() -> None:
    answer = held(estimate(light(SUN, 2.0, 0.9)))
    assert not answer.offer(estimate(light(SUN, 0.5, 0.6)))
    newer = estimate(light(SUN, 2.0, 0.9))
    answer.offer(newer)
    assert answer.estimate is newer


def test_an_answer_as_good_is_taken_as_it_is_newer_but_gains_nothing() -> None:
    answer = held(estimate(light(SUN)))
    newer = estimate(light(turned(SUN, 1, 0)))
    assert not answer.offer(newer)
    assert answer.estimate is newer
    assert not answer.is_news


def test_an_outlier_changes_nothing() -> None:
    answer = held(estimate(light(SUN)))
    before = answer.estimate
    for outlier in (estimate(light(LAMP, confidence=0.95)), NONE):
        assert not answer.offer(outlier)
        assert answer.estimate is before
        assert answer.is_disputed
    assert not answer.offer(estimate(light(SUN)))
    assert not answer.is_disputed
    assert error_deg(answer, SUN) < 1e-6


def test_outliers_between_answers_that_confirm_the_held_one_are_never_believed() -> None:
    """Also where these are vaguer than the held one, and so not taken."""
    answer = held(estimate(light(SUN)))
    for _ in range(2 * CHANGED_AFTER):
        assert not answer.offer(estimate(light(LAMP)))
        assert not answer.offer(estimate(light(SUN, 4.0)))
    assert error_deg(answer, SUN) < 1e-6


def test_a_doubtful_first_answer_gives_way_at_once_to_a_surer_one() -> None:
    assert error_deg(held(estimate(light(LAMP, confidence=0.3)), estimate(light(SUN))), SUN) < 1e-6
    assert error_deg(held(NONE, estimate(light(SUN, confidence=0.3))), SUN) < 1e-6


def test_more_views_disprove_a_less_sure_answer_from_one_at_once() -> None:
    alone = estimate(light(LAMP, confidence=0.7))
    assert error_deg(held(alone, estimate(light(SUN, confidence=0.9), views=5)), SUN) < 1e-6
    assert error_deg(held(alone, estimate(light(SUN, confidence=0.6), views=5)), LAMP) < 1e-6


def test_more_frames_from_one_side_or_fewer_from_several_disprove_nothing_at_once() -> None:
    few = estimate(light(LAMP, confidence=0.7), views=3)
    sure = light(SUN, confidence=0.9)
    for views, span_rad in ((5, few.span_rad), (2, 2 * few.span_rad)):
        new = dataclasses.replace(estimate(sure, views=views), span_rad=span_rad)
        assert error_deg(held(few, new), LAMP) < 1e-6
    assert error_deg(held(few, estimate(sure, views=5)), SUN) < 1e-6


OTHERS = [estimate(light(LAMP)), estimate(light(SUN), light(LAMP)), estimate(light(SUN, depth=0.75)), NONE]


@pytest.mark.parametrize("other", OTHERS, ids=["another lamp", "a second lamp", "a thin cloud", "a thick cloud"])
def test_another_light_is_believed_after_a_few_answers(other) -> None:
    answer = held(*[estimate(light(SUN))] * 5)
    assert [answer.offer(other) for _ in range(CHANGED_AFTER)] == [False] * (CHANGED_AFTER - 1) + [True]
    assert answer.estimate is other
    assert answer.is_news


def test_where_the_views_show_that_the_scene_has_changed_a_light_is_believed_at_once_but_no_light_is_not() -> None:
    """A hand before the camera changes the scene as well."""
    for confidence in (0.8, 0.4):
        answer = held(estimate(light(SUN, confidence=confidence)))
        answer.offer(NONE, is_of_changed_scene=True)
        assert answer.estimate.light is not None
        assert answer.offer(estimate(light(LAMP, confidence=0.6)), is_of_changed_scene=True)
        assert error_deg(answer, LAMP) < 1e-6
        assert answer.is_news


def test_that_there_is_no_light_any_more_is_believed_where_its_shadows_are_gone_or_it_stays_so() -> None:
    out = held(estimate(light(SUN)))
    assert out.offer(NONE, is_of_changed_scene=True, has_lost_shadows=True)
    assert out.estimate is NONE
    covered = held(estimate(light(SUN)))
    seen = [covered.offer(NONE, is_of_changed_scene=True) for _ in range(RESTS_NO_LONGER)]
    assert seen == [False] * (RESTS_NO_LONGER - 1) + [True]
    of_one_scene = held(estimate(light(SUN)))
    assert not of_one_scene.offer(NONE, has_lost_shadows=True), "a single answer may be wrong"


def test_a_doubtful_light_of_a_changed_scene_contradicts_a_sure_one_only_if_it_is_seen_again_and_again() -> None:
    """A hand that rests before the camera."""
    answer, other = held(estimate(light(SUN, confidence=0.9))), estimate(light(LAMP, confidence=0.45))
    for left in reversed(range(RESTS_NO_LONGER)):
        assert error_deg(answer, SUN) < 1e-6
        assert answer.offer(other, is_of_changed_scene=True) is (left == 0)
    assert error_deg(answer, LAMP) < 1e-6
    doubted = held(estimate(light(SUN, confidence=0.45)))
    assert doubted.offer(other, is_of_changed_scene=True)
    same = held(estimate(light(SUN, confidence=0.9)))
    elsewhere = estimate(light(SUN, confidence=0.45))
    assert same.offer(elsewhere, is_of_changed_scene=True)
    assert same.estimate is elsewhere, "the object has been moved"


def test_outliers_that_contradict_each_other_are_never_believed() -> None:
    answer = held(estimate(light(SUN)))
    for azimuth in range(6):
        answer.offer(estimate(light(direction_from_angles(float(azimuth) + 2, 0.3))))
    assert error_deg(answer, SUN) < 1e-6


def test_two_lights_are_the_same_whichever_seems_stronger() -> None:
    assert agree(estimate(light(SUN), light(LAMP)), estimate(light(LAMP), light(SUN)))
    assert not agree(estimate(light(SUN), light(LAMP)), estimate(light(SUN), light(turned(LAMP, 30, 0))))


def test_azimuths_on_both_sides_of_the_zenith_are_near_each_other() -> None:
    around = [estimate(light(direction_from_angles(azimuth, math.radians(88)))) for azimuth in (0, 1.57, 3.14, 4.71)]
    assert all(agree(around[0], each) for each in around)


def test_a_slow_sun_is_followed() -> None:
    answer = HeldAnswer()
    for step in range(60):
        now = direction_from_angles(0.7 + math.radians(step), 0.8)
        answer.offer(estimate(light(now)))
        assert error_deg(answer, now) < 4


def test_a_light_in_single_frames_has_moved_by_more_than_its_uncertainty_or_is_the_held_one() -> None:
    """Of two it is enough that one has moved."""
    for sigma_deg in (1.0, 4.0):
        lights = [light(SUN, sigma_deg), light(LAMP, sigma_deg)]
        twice_deg = math.degrees(2 * lights[0].sigma_rad)
        for moved_deg, has_moved in ((twice_deg - 0.5, False), (twice_deg + 2.0, True)):
            answer = held(before := estimate(*lights))
            answer.offer(estimate(light(turned(SUN, 40, 0))))
            now = estimate(lights[0], light(turned(LAMP, moved_deg, 0), sigma_deg))
            assert answer.follow(now) is answer.is_news is has_moved
            assert answer.estimate is (now if has_moved else before)
            assert not answer.is_disputed


@pytest.mark.parametrize("turn_deg", [30.0, 170.0])
def test_a_light_is_the_same_after_the_marker_was_turned(turn_deg: float) -> None:
    """It is compared with later answers by the marker's frame as it lies then; what disagreed before still does."""
    answer, lies = HeldAnswer(), np.eye(4)
    answer.move_to(seen(lies))
    answer.offer(estimate(light(SUN, 1.0, 0.9)))
    answer.offer(estimate(light(LAMP, 1.0, 0.9)))
    turned_by = rigid(cv2.Rodrigues(np.radians([0, 0, turn_deg]))[0], [0.02, 0.0, 0.0])
    answer.move_to(seen(turned_by))
    sun, lamp = (turned_by[:3, :3].T @ each for each in (SUN, LAMP))
    assert error_deg(answer, sun) < 1e-6
    assert answer.estimate.light.confidence == 0.9
    for _ in range(CHANGED_AFTER - 1):
        assert not answer.is_news
        answer.offer(estimate(light(lamp, 1.0, 0.9)))
    assert answer.is_news
    assert error_deg(answer, lamp) < 1e-6


def test_before_there_is_an_answer_and_where_no_marker_is_seen_nothing_is_moved() -> None:
    """And nothing is out of view."""
    elsewhere = seen(rigid(cv2.Rodrigues(np.radians([0, 0, 40.0]))[0], [0.02, 0.0, 0.0]))
    nowhere = dataclasses.replace(seen(np.eye(4)), marker=None)
    answer = HeldAnswer()
    assert not answer.is_news
    assert answer.is_shown
    for frame in (seen(np.eye(4)), elsewhere, nowhere):
        answer.move_to(frame)
        assert answer.estimate is None
        assert answer.is_shown
    assert not answer.follow(NONE)
    answer.move_to(elsewhere)
    answer.offer(found := estimate(light(SUN)))
    answer.move_to(nowhere)
    assert answer.estimate is found
    assert answer.is_shown


def test_a_marker_that_is_lifted_and_put_back_has_lost_nothing() -> None:
    answer, lying = HeldAnswer(), seen(np.eye(4))
    answer.move_to(lying)
    body = Proxy("box", np.array([[0.1, 0, 0, 0.03, 0.0], [0.1, 0, 0.1, 0.03, 0.0]]))
    found = estimate(light(SUN, 1.0, 0.9))
    found = dataclasses.replace(found, illumination=dataclasses.replace(found.illumination, real_object=body))
    answer.offer(found)
    answer.move_to(seen(rigid(cv2.Rodrigues(np.radians([60.0, 0, 0]))[0], [0.0, 0.0, 0.2])))
    assert answer.estimate.illumination.real_object is None
    back = rigid(np.eye(3), [0.01, 0.0, 0.0])
    answer.move_to(seen(back))
    assert answer.estimate.illumination.real_object.foot_marker == pytest.approx([0.09, 0.0, 0.0])
    answer.move_to(lying)
    assert answer.estimate is found


def test_a_frame_need_show_no_more_than_half_of_what_the_answers_own_did() -> None:
    """Of the long shadow of a low sun much is out of the picture from the first."""
    body = Proxy("box", np.array([[0.0, 0, 0, 0.02, 0.0], [0.0, 0, 0.1, 0.02, 0.0]]))
    there = seen(np.eye(4))
    for elevation_deg, share in ((60, 1.0), (12, 0.8), (4, 0.4)):
        answer = HeldAnswer(there)
        found = estimate(light(direction_from_angles(0.0, math.radians(elevation_deg)), 1.0, 0.9))
        found = dataclasses.replace(found, illumination=dataclasses.replace(found.illumination, real_object=body))
        answer.offer(found)
        assert share_shown(found, there) <= share
        answer.move_to(there)
        assert answer.is_shown
        nearer = there.marker.T_cam_marker.copy()
        nearer[:2, 3] += 0.4  # object and shadow are beside the picture
        answer.move_to(dataclasses.replace(there, marker=dataclasses.replace(there.marker, T_cam_marker=nearer)))
        assert not answer.is_shown


def seen(T_room_marker) -> TrackedFrame:
    camera = Camera.from_hfov((64, 48), 60)
    pose = MarkerPose(rigid(np.diag([1, -1, -1]), [0, 0, 0.4]), np.zeros((4, 2)), 0.08, 0.1, None)
    frame = Frame(np.zeros((48, 64, 3), np.uint8), 0, 0.0)
    return TrackedFrame(frame, camera, pose, T_room_marker=T_room_marker)
