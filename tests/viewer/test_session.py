"""What the session knows, says and asks the worker for."""

import dataclasses

import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.transforms import direction_from_angles, rigid
from ashe_live.core.types import Frame
from ashe_live.errors import UserError
from ashe_live.light.live.worker_messages import WorkerFailure
from ashe_live.models.mesh import Model, Motion
from ashe_live.models.placement import UNMOVED, placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.viewer.display import bare_scene
from ashe_live.viewer.estimates.held_empty_table import EMPTY_FOR_S
from ashe_live.viewer.estimates.not_there_yet import ANSWER_ALONE
from ashe_live.viewer.estimates.sharpening import CHECKED_EVERY_S, EVERY_S, FUTILE
from ashe_live.viewer.hands.hand import NEEDS_MARKER
from ashe_live.viewer.hands.requests import Command, Drag, Request
from ashe_live.viewer.notice import NOTICE_S
from ashe_live.viewer.status import WITHOUT_IT, guidance, light_line
from tests.viewer.scripted_session import lying, on_cube, placed


def test_the_first_steady_frame_is_estimated_once(make, fakes):
    session = make(on_first_steady=True)
    for index in range(2):
        session.take(fakes.tracked(index), 0.0)
    assert not session.watch.is_estimating
    assert session.first.awaits_steady
    session.take(fakes.tracked(2), 0.0)
    assert session.watch.is_estimating
    assert session.answered(fakes.estimate(2), 0.0).estimate is session.estimate
    for index in range(3, 20):
        session.take(fakes.tracked(index), 0.0)
    assert [frozen.frame.index for frozen in session.worker.requested] == [2]


def test_the_estimate_holds_wherever_the_clip_goes(make, fakes):
    session = make(on_first_steady=True)
    session.take(fakes.tracked(40), 0.0)
    assert session.request_estimate(0.0)
    session.worker.answer = fakes.estimate(40)
    held = session.poll(0.0).estimate
    for index in (41, 3, 2, 1, 90, 0, 1):  # on, sought back, stepped back, sought on, started again
        session.take(fakes.tracked(index), 1.0)
        session.poll(1.0)
        assert session.estimate is held
        assert session.shown is session.lit_by
        assert session.shown.seen_in is session.answer.frozen


@pytest.mark.parametrize("command", [Command.TOGGLE_LIGHT, Command.TOGGLE_STEPS])
def test_nobody_who_waits_for_an_estimate_is_advised_to_ask_for_one(shown, command):
    session = shown()
    session.press(command)
    assert "Space estimates it" in session.notice.text
    session.press(command)
    session.press(Command.ESTIMATE)
    session.press(command)
    assert "it is being estimated" in session.notice.text


def test_the_estimate_goes_with_the_frame_it_was_made_from(make, fakes):
    session = make()
    session.take(fakes.tracked(4), 0.0)
    session.request_estimate(0.0)
    session.take(fakes.tracked(5), 0.0)
    session.answered(fakes.estimate(4), 0.0)
    assert session.answer.frozen.frame.index == session.estimate.frame_index == 4


def test_a_second_request_meanwhile_is_refused_and_said(make, fakes):
    session = make()
    session.take(fakes.tracked(1), 0.0)
    assert session.request_estimate(0.0)
    session.take(fakes.tracked(2), 0.0)
    assert not session.request_estimate(0.0)
    assert "still" in session.notice.shown(0.0)
    session.answered(fakes.estimate(1), 0.0)
    assert session.answer.frozen.frame.index == 1


@pytest.mark.parametrize("has_frame", [False, True])
def test_without_a_marker_it_says_so_instead_of_estimating(make, fakes, has_frame):
    session = make()
    if has_frame:
        session.take(fakes.tracked(has_marker=False), 0.0)
    assert not session.request_estimate(0.0)
    assert session.notice.shown(0.0) == "no marker in view", "nobody can turn a clip towards one"
    assert not session.watch.is_estimating
    session.watch.camera_may_move = True
    assert not session.request_estimate(1.0)
    assert "point the camera at it" in session.notice.shown(1.0)


def test_a_failure_is_said_and_keeps_the_last_light(shown, fakes):
    session = shown()
    session.request_estimate(0.0)
    session.worker.answer = good = fakes.estimate()
    session.poll(0.0)
    session.request_estimate(1.0)
    assert session.answered(WorkerFailure(0, "the light estimator's process has died"), 1.0) is None
    assert session.estimate is good
    assert "has died" in session.notice.shown(1.0)
    assert not session.watch.is_estimating


def test_what_a_frame_brings_with_it_is_said_once_until_it_is_something_else(make, fakes):
    """As that there are two equal markers, which every frame says for as long as it is so."""
    session, now_s = make(), 0.0
    for note, is_said in ((None, False), ("a", True), ("a", False), ("b", True), (None, False), ("b", True)):
        session.say("before", now_s)
        session.take(dataclasses.replace(fakes.tracked(), note=note), now_s)
        assert session.notice.text == (note if is_said else "before")
        now_s += 1.0
    begun = make()
    begun.take(dataclasses.replace(fakes.tracked(), note="a"), 0.0)
    assert begun.notice.text == "a"


def test_a_model_that_cannot_be_read_is_said(make):
    session = make()
    session.table.shelf.error = UserError("broken.glb is damaged", "export it again")
    session.poll(0.0)
    assert "broken.glb" in session.notice.shown(0.0)


def test_notices_fade_but_the_last_is_remembered(make):
    session = make()
    session.say("hello", 10.0)
    assert session.notice.shown(10.0 + NOTICE_S) == "hello"
    assert session.notice.shown(10.1 + NOTICE_S) is None
    assert session.notice.text == "hello"


def test_keys_choose_models(make):
    session = make()
    for request, name in (
        (Request(Command.CHOOSE_MODEL, 2), "mug"),
        (Request(Command.NEXT_MODEL), "tree"),
        (Request(Command.NEXT_MODEL), "cube"),
        (Request(Command.PREVIOUS_MODEL), "tree"),
        (Request(Command.CHOOSE_MODEL, 8), "tree"),
    ):
        assert session.handle(request, 0.0)
        assert session.table.model_name == name
    assert "4 models" in session.notice.shown(0.0)


def test_switches_toggle(shown):
    session = shown()
    for command, switch in (
        (Command.TOGGLE_LIGHT, "shows_light"),
        (Command.TOGGLE_STEPS, "shows_steps"),
        (Command.COVER_MARKER, "covers_marker"),
        (Command.TOGGLE_HUD, "shows_hud"),
    ):
        holder = session if switch == "covers_marker" else session.view
        before = getattr(holder, switch)
        for expected in (not before, before):
            session.press(command)
            assert getattr(holder, switch) is expected


def test_the_help_is_shown_and_hidden_by_its_key(make):
    session = make()
    for expected in (True, False):
        session.press(Command.HELP)
        assert session.view.help.is_shown is expected


def test_a_sheet_is_covered_and_a_cube_is_not_unless_somebody_chooses(make, fakes):
    session, sheet = make(), fakes.tracked()
    cube = on_cube(sheet)
    for tracked, is_covered in ((sheet, True), (cube, False)):
        session.take(tracked, 0.0)
        assert session.covers_marker is is_covered
    for chosen in (True, False):
        session.press(Command.COVER_MARKER)
        for tracked in (sheet, cube):
            session.take(tracked, 0.0)
            assert session.covers_marker is chosen


def test_without_a_marker_in_view_nothing_is_covered_or_shown_unseen(make, fakes):
    session, in_view = make(), fakes.tracked()
    for tracked in (None, dataclasses.replace(in_view, marker=None)):
        if tracked is not None:
            session.take(tracked, 0.0)
        session.press(Command.COVER_MARKER)
        assert session.view.wants_cover is None
        assert "no marker in view" in session.notice.shown(0.0)


def test_without_a_marker_in_view_the_hand_moves_nothing_and_says_why(make, fakes):
    session, in_view = make(), fakes.tracked()
    for tracked in (None, dataclasses.replace(in_view, marker=None)):
        if tracked is not None:
            session.take(tracked, 0.0)
        for command in (Command.MOVE_LIGHT, Command.MOVE_MODEL):
            for argument in ((1, 0), Drag((1.0, 2.0), (30.0, 40.0), is_first=True)):
                session.say("before", 0.0)
                assert session.press(command, argument)
                assert session.notice.shown(0.0) == NEEDS_MARKER
        assert (session.hand.light, session.hand.placement) == (None, UNMOVED)


def test_a_model_takes_a_covered_cubes_place_once_the_ground_over_it_is_drawn(make, fakes):
    session = make()
    session.take(on_cube(fakes.tracked()), 0.0)
    beside = session.hand.placement
    assert beside != UNMOVED
    session.press(Command.COVER_MARKER)
    # The cover is made once it is wanted, and may be dropped for another light or another place of the cube.
    for is_drawn, expected in ((False, beside), (True, UNMOVED), (False, beside), (True, UNMOVED)):
        session.view.cover_is_drawn = is_drawn
        session.poll(1.0)
        assert session.hand.placement == expected
    session.press(Command.COVER_MARKER, now_s=2.0)
    session.poll(2.0)
    assert session.hand.placement == beside


def test_what_led_to_an_answer_is_asked_for_only_to_be_shown(shown, fakes):
    session = shown()

    def estimated(now_s: float) -> Image | None:
        session.request_estimate(now_s)
        session.worker.answer, session.worker.picture = fakes.estimate(), picture
        session.poll(now_s)
        return session.answer.steps_bgr

    picture = np.zeros((8, 8, 3), np.uint8)
    toggle = Request(Command.TOGGLE_STEPS)
    assert estimated(0.0) is None
    assert session.notice.text is None
    session.handle(toggle, 1.0)
    assert session.notice.shown(1.0) == ANSWER_ALONE
    session.handle(toggle, 2.0)
    assert session.notice.shown(2.0) is None
    session.handle(toggle, 3.0)
    assert estimated(10.0) is picture
    assert session.notice.shown(10.0) is None
    session.handle(toggle, 11.0)
    session.handle(toggle, 12.0)
    assert session.answer.steps_bgr is picture
    assert session.notice.shown(12.0) is None
    picture = None  # as of an estimator that keeps no trace
    assert estimated(20.0) is None
    assert session.notice.shown(20.0) == ANSWER_ALONE


def test_what_was_said_to_be_missing_is_not_said_once_it_is_there(shown, fakes):
    toggles = {Command.TOGGLE_LIGHT: "the arrow", Command.TOGGLE_STEPS: "nothing has been estimated"}
    for command, said in toggles.items():
        session = shown()
        session.press(command)
        assert said in session.notice.shown(0.1)
        session.request_estimate(0.2)
        session.worker.answer, session.worker.picture = fakes.estimate(), np.zeros((8, 8, 3), np.uint8)
        session.poll(0.3)
        assert session.notice.shown(0.3) is None
    session = shown()
    session.press(Command.TOGGLE_LIGHT)
    session.press(Command.MOVE_LIGHT, (1, 0), 0.1)  # by hand
    assert session.notice.shown(0.1) is None


@pytest.mark.parametrize("command", [Command.TOGGLE_LIGHT, Command.TOGGLE_STEPS])
def test_what_is_missing_is_not_spoken_of_any_more_once_it_is_hidden_again(shown, command):
    session = shown()
    session.press(command)
    assert session.notice.shown(0.1) is not None
    session.press(command, now_s=0.1)
    assert session.notice.shown(0.1) is None


def test_no_arrow_is_missing_where_it_is_there_or_is_hidden(shown, fakes):
    known, unknown = shown(), shown()
    known.estimated(fakes.estimate())
    for now_s in (1.0, 2.0):
        known.press(Command.TOGGLE_LIGHT, now_s=now_s)
        assert known.notice.text is None
    unknown.press(Command.TOGGLE_LIGHT)
    unknown.say("something else", 1.0)
    unknown.press(Command.TOGGLE_LIGHT, now_s=1.0)
    assert not unknown.view.shows_light
    assert unknown.notice.text == "something else"


def test_the_answer_alone_is_no_longer_spoken_of_beside_its_steps(shown, fakes):
    session = shown()
    for now_s, picture in ((0.0, None), (1.0, np.zeros((8, 8, 3), np.uint8))):
        session.request_estimate(now_s)
        session.worker.answer, session.worker.picture = fakes.estimate(), picture
        session.poll(now_s)
        if picture is None:
            session.press(Command.TOGGLE_STEPS, now_s=now_s)
            assert session.notice.shown(now_s) == ANSWER_ALONE
    assert session.notice.shown(1.0) is None


def test_what_needs_the_window_is_left_to_it(make):
    left = {command for command in Command if not make().handle(Request(command), 0.0)}
    names = ("PAUSE", "RESTART", "STEP", "SEEK", "SPEED", "LOOP", "OPEN")
    names += ("SNAPSHOT", "CUT_OUT", "RECORD", "QUALITY", "FULLSCREEN", "LEAVE", "FOLLOW_OTHER", "KEEP_LIGHT")
    names += ("FIELD_OF_VIEW", "NEXT_CAMERA")
    assert left == {Command[name] for name in names}


def run_steadily(session, fakes, answers, until_s: float, has_marker=lambda _s: True) -> None:
    """Thirty frames a second, each request answered by the frame after it."""
    for index in range(round(until_s * 30)):
        now_s = index / 30
        session.worker.answer = answers(now_s) if session.watch.is_estimating else None
        session.poll(now_s)
        session.take(fakes.tracked(index, has_marker(now_s)), now_s)


def test_automatically_it_estimates_until_that_gains_nothing_and_then_only_what_has_changed(make, fakes):
    session = make(automatic=True)
    session.watch.key_views = fakes.KeyViews(fakes.tracked(1000))
    run_steadily(session, fakes, lambda _s: fakes.estimate(), 20.0)
    worker = session.worker
    gaps_s = np.diff([frozen.frame.time_s for frozen in worker.requested])
    assert worker.known[: FUTILE + 1] == [None] * (FUTILE + 1)
    assert gaps_s[:FUTILE] == pytest.approx(EVERY_S, abs=0.1)
    assert all(known is not None for known in worker.known[FUTILE + 1 :])
    assert gaps_s[FUTILE:] == pytest.approx(CHECKED_EVERY_S, abs=0.1)


def test_a_known_light_is_followed_and_shown_elsewhere_only_once_it_has_moved(make, fakes):
    session = make(automatic=True)
    session.watch.key_views = fakes.KeyViews(fakes.tracked(1000))
    run_steadily(session, fakes, lambda _s: fakes.estimate(sigma_rad=0.01), 10.0)
    worker, held = session.worker, session.estimate
    worker.follows, worker.answer = True, None
    for now_s, degrees, is_taken in ((20.0, 1.0, False), (40.0, 2.0, False), (60.0, 4.0, True)):
        session.take(fakes.tracked(int(now_s)), now_s)
        assert worker.known[-1].light is held.light
        towards = direction_from_angles(np.radians(degrees) / np.cos(np.radians(45)), np.radians(45))
        worker.answer = fakes.estimate(int(now_s), towards=towards, sigma_rad=0.01)
        assert (session.poll(now_s) is not None) is is_taken
        assert (session.estimate is not held) is is_taken
    assert session.answer.frozen.frame.index == 60


def test_a_changed_scene_is_estimated_anew_and_its_views_are_dropped(make, fakes):
    session = make(automatic=True)
    session.watch.key_views = fakes.KeyViews(fakes.tracked(1000))
    run_steadily(session, fakes, lambda _s: fakes.estimate(), 10.0)
    assert session.watch.sharpening.is_settled
    lamp = fakes.estimate(7, towards=(0.0, -1.0, 1.0))
    before = session.estimate
    for index, now_s in ((7, 30.0), (8, 31.0)):  # that it is no hand in passing is seen in a second frame
        assert session.estimate is before
        session.take(fakes.tracked(index), now_s)
        session.worker.outdated, session.worker.answer = (0,), lamp
        session.poll(now_s)
    assert session.estimate is lamp
    assert session.watch.key_views.views == ()
    assert not session.watch.sharpening.is_settled


def test_automatically_nothing_is_asked_without_a_steady_marker(make, fakes):
    session = make(automatic=True)
    run_steadily(session, fakes, lambda _s: fakes.estimate(), 3.0, lambda now_s: round(now_s * 30) % 3 > 0)
    assert session.worker.requested == []
    assert session.notice.text is None


def test_an_outlier_changes_neither_light_nor_masks_and_a_changed_light_does(make, fakes):
    session = make(automatic=True)
    run_steadily(session, fakes, lambda _s: fakes.estimate(), 3.0)
    before = session.estimate, session.answer.frozen
    for answers in range(3):
        session.take(fakes.tracked(1000 + answers), 9.0 + 2 * answers)
        assert session.watch.is_estimating
        assert (session.answered(fakes.estimate(with_light=False), 9.0) is None) is (answers < 2)
        assert ((session.estimate, session.answer.frozen) == before) is (answers < 2)
    assert session.estimate.light is None


def test_what_a_person_asks_for_is_shown_whatever_was_held(shown, fakes):
    session = shown()
    for now_s, towards in ((0.0, (1.0, 0.0, 1.0)), (1.0, (0.0, -1.0, 1.0))):
        assert session.estimated(fakes.estimate(towards=towards), now_s).estimate is session.estimate
        assert session.estimate.light.to_light_marker == pytest.approx(np.array(towards) / np.sqrt(2))
    session.estimated(fakes.estimate(with_light=False), 2.0)
    assert session.estimate.light is None


def orbit(fakes, count: int, step_deg: float = 2.0, first: int = 100):
    return [fakes.tracked(first + at, tilt_deg=step_deg * at) for at in range(count)]


def test_an_answer_rests_on_the_frozen_frame_and_the_key_views_at_hand(make, fakes):
    session = make()
    views = orbit(fakes, 4)
    session.watch.key_views = fakes.KeyViews(*views)
    frozen = fakes.tracked(102)  # one of them, before it was scaled
    session.take(frozen, 0.0)
    session.request_estimate(0.0)
    assert session.worker.requested == [frozen]
    assert [view.frame.index for view in session.worker.others] == [100, 101, 103]


def test_while_the_camera_moves_the_answer_is_sharpened_until_that_gains_nothing(shown, fakes):
    session = shown()
    session.estimated(fakes.estimate(0, sigma_rad=0.07))
    sigmas = [0.06, 0.04]  # and no better than the next
    for at in range(60):
        now_s = 1.0 + at
        session.watch.key_views = fakes.KeyViews(*orbit(fakes, 2 + at // 2))
        session.take(fakes.tracked(at), now_s)
        if session.watch.is_estimating:
            assert not session.watch.is_awaited
            frozen = session.worker.requested[-1]
            assert frozen is session.watch.key_views.views[-1]
            others = [view.frame.index for view in session.worker.others]
            session.worker.answer = fakes.estimate(
                frozen.frame.index, sigma_rad=sigmas.pop(0) if sigmas else 0.02, others=others, span_rad=0.1
            )
            session.poll(now_s)
    assert session.estimate.light.sigma_rad == 0.02
    assert session.watch.sharpening.is_settled
    # The first one, three that gained, three that did not, and where the views spanned half as much again.
    assert 1 + 3 + FUTILE <= len(session.worker.requested) <= 1 + 3 + FUTILE + 5
    assert "views over 6°" in light_line(session)


def test_a_light_by_hand_is_not_sharpened(shown, fakes):
    session = shown()
    session.estimated(fakes.estimate())
    session.set_by_hand(1.0)
    session.watch.key_views = fakes.KeyViews(*orbit(fakes, 6))
    session.take(fakes.tracked(1), 5.0)
    assert not session.watch.is_estimating


def test_a_key_switches_it_on_and_holds_the_light_when_it_is_switched_off(make, fakes):
    session = make()
    session.press(Command.AUTOMATIC)
    run_steadily(session, fakes, lambda _s: fakes.estimate(), 3.0)
    session.press(Command.AUTOMATIC, now_s=3.0)
    held, asked = session.estimate, len(session.worker.requested)
    assert held is not None
    for index in range(100):
        session.take(fakes.tracked(index), 4.0 + index)
    assert (session.estimate, len(session.worker.requested)) == (held, asked)


def test_a_light_by_hand_is_shown_at_once_and_said_to_be_so(shown):
    session = shown()
    session.set_by_hand(1.0)
    assert session.shown is session.lit_by is session.hand.light
    assert session.estimate is None
    assert light_line(session).startswith("light by hand: azimuth")
    assert "±" not in light_line(session)
    assert bare_scene(session).illumination is session.hand.light


def test_what_was_said_of_a_light_by_hand_goes_with_it(shown):
    session = shown()
    session.press(Command.LIGHT_DISTANCE, -5, 1.0)
    assert "lamp" in session.notice.shown(1.0)
    session.press(Command.RESET, now_s=1.5)
    assert session.notice.shown(1.5) == "the light is no longer by hand: Ctrl+Z takes that back"
    session.press(Command.UNDO, now_s=2.0)
    assert session.hand.light is not None


def test_undoing_goes_back_through_all_lights_that_were_shown_an_estimate_among_them(shown, fakes):
    """Two lights by hand, then an estimate: what came before it is the second of them."""
    session = shown()
    session.estimated(fakes.estimate())
    shown = [session.lit_by]
    for now_s in (1.0, 10.0):
        session.set_by_hand(now_s)
        shown.append(session.lit_by)
    session.estimated(fakes.estimate(), 20.0)
    assert session.hand.light is None
    for before in reversed(shown[1:]):
        session.press(Command.UNDO, now_s=30.0)
        assert session.lit_by is before
    session.press(Command.UNDO, now_s=30.0)
    assert session.hand.light is None


def test_a_new_estimate_ends_the_light_by_hand_and_one_asked_for_before_does_not(shown, fakes):
    session = shown()
    session.request_estimate(1.0)
    session.set_by_hand(2.0)
    session.answered(fakes.estimate(), 3.0)
    assert session.estimate is not None
    assert session.lit_by is session.hand.light is not None
    session.estimated(fakes.estimate(), 4.0)
    assert session.hand.light is None
    assert session.lit_by.lights is session.estimate.lights


def test_an_estimate_asked_for_again_while_it_is_made_ends_the_light_by_hand(shown, fakes):
    session = shown()
    session.request_estimate(1.0)
    session.set_by_hand(2.0)
    session.press(Command.ESTIMATE, now_s=3.0)
    assert session.notice.shown(3.0) == "still estimating"
    session.answered(fakes.estimate(), 4.0)
    assert session.hand.light is None
    assert session.lit_by.lights is session.estimate.lights


def test_what_is_done_to_the_model_meanwhile_does_not_make_the_light_by_hand_any_newer(shown, fakes):
    session = shown()
    session.set_by_hand(1.0)
    session.request_estimate(2.0)
    session.press(Command.TURN_MODEL, 1, 3.0)
    session.answered(fakes.estimate(), 4.0)
    assert session.hand.light is None
    assert session.lit_by.lights is session.estimate.lights


def test_what_is_compared_with_the_video_stays_so_while_something_is_moved(shown):
    session = shown()
    session.press(Command.BEFORE_AFTER)
    parts = session.view.parts
    session.set_by_hand(1.0)
    session.press(Command.TURN_MODEL, 1, 2.0)
    assert session.view.parts is parts


def test_a_light_by_hand_that_is_brought_back_by_undoing_counts_from_then(shown, fakes):
    session = shown(automatic=True)
    session.set_by_hand(1.0)
    session.press(Command.RESET, now_s=2.0)
    session.press(Command.AUTOMATIC, now_s=3.0)
    assert session.request_estimate(4.0)
    session.press(Command.UNDO, now_s=5.0)
    brought_back = session.hand.light
    assert brought_back is not None
    assert not session.automatic
    session.answered(fakes.estimate(), 6.0)
    assert session.lit_by is brought_back


def test_what_a_person_asks_for_while_nobodys_estimate_is_made_counts_from_when_they_asked(make, fakes):
    session = make()
    worker = session.worker
    session.take(fakes.tracked(0), 0.0)
    session.request_estimate(0.0)
    worker.answer = fakes.estimate(0, sigma_rad=0.07)
    session.poll(0.5)
    session.watch.key_views = fakes.KeyViews(*orbit(fakes, 4))
    session.take(fakes.tracked(1), 1.0)
    assert session.watch.is_estimating
    assert not session.watch.is_awaited
    session.set_by_hand(2.0)
    session.take(fakes.tracked(2), 3.0)
    assert session.request_estimate(3.0)
    assert session.watch.is_awaited
    assert not session.request_estimate(3.1), "one person's request waits at a time"
    assert worker.requested[-1].frame.index == 2, "the one that nobody waits for is given up, and not waited for"
    worker.answer = fakes.estimate(2)
    assert session.poll(5.0).estimate is session.estimate
    assert session.hand.light is None, "Space came after the hand, and so replaces its light"


def test_an_estimate_without_a_light_leaves_the_one_by_hand(shown, fakes):
    session = shown()
    session.set_by_hand(1.0)
    session.estimated(fakes.estimate(with_light=False), 2.0)
    assert session.lit_by is session.hand.light is not None
    assert "stays as set by hand" in session.notice.shown(2.1)


def test_a_light_by_hand_ends_the_automatic_and_the_awaited_estimate(shown, fakes):
    session = shown(on_first_steady=True, automatic=True)
    session.set_by_hand(0.0)
    assert not session.automatic
    assert session.notice.shown(0.0) == "the light is by hand: A watches it again"
    for index in range(1, 30):
        session.take(fakes.tracked(index), index / 10)
    assert not session.watch.is_estimating
    assert session.hand.light is not None


@pytest.mark.parametrize("with_light", [True, False])
def test_after_a_light_by_hand_the_light_is_watched_again(shown, fakes, with_light):
    session = shown(automatic=True)
    session.set_by_hand(0.0)
    session.press(Command.AUTOMATIC, now_s=1.0)
    assert session.watch.is_awaited
    session.answered(fakes.estimate(with_light=with_light), 2.0)
    assert session.automatic is with_light
    assert (session.hand.light is None) is with_light
    asked = len(session.worker.requested)
    for index in range(1, 60):
        session.take(fakes.tracked(index), 2.0 + index / 10)
    assert (len(session.worker.requested) > asked) is with_light


def test_a_key_watches_the_light_with_all_views_before_it_and_holds_it(shown, fakes):
    session = shown()
    session.estimated(fakes.estimate())
    before = session.watch.sharpening
    session.press(Command.AUTOMATIC, now_s=1.0)
    assert session.automatic
    assert session.notice.shown(1.0).startswith("the light is watched")
    assert session.watch.sharpening is not before, "what gained nothing then may gain something now"
    session.press(Command.AUTOMATIC, now_s=2.0)
    assert not session.automatic
    assert session.notice.shown(2.0).startswith("the light is held")
    # Also while the estimate that is to replace a light by hand is still being made.
    session.set_by_hand(3.0)
    for now_s, is_watched in ((4.0, True), (5.0, False)):
        session.press(Command.AUTOMATIC, now_s=now_s)
        assert session.automatic is is_watched


def test_where_nothing_was_set_by_hand_no_clear_light_is_not_said_to_stay_so(shown, fakes):
    session = shown(automatic=True)
    session.estimated(fakes.estimate(with_light=False))
    assert session.notice.text is None
    assert session.automatic


def test_once_its_light_is_known_a_model_beside_the_cube_stands_out_of_the_shadow_of_that(make, fakes):
    for to_light in ((1.0, 0.0, 1.0), (-1.0, 0.0, 1.0), (0.0, 1.0, 1.0), (0.0, -1.0, 1.0)):
        session = make()
        session.take(on_cube(fakes.tracked()), 0.0)
        session.estimated(fakes.estimate(towards=to_light))
        place = np.array(session.hand.placement.shift_m)
        assert -place @ to_light[:2] < 0.5 * np.linalg.norm(place)


def test_without_a_marker_a_light_by_hand_stays_and_is_not_said_to_be_watched(shown, fakes):
    session = shown()
    session.set_by_hand(0.0)
    session.take(dataclasses.replace(fakes.tracked(1), marker=None), 1.0)
    session.press(Command.AUTOMATIC, now_s=1.0)
    assert not session.automatic
    assert "no marker in view" in session.notice.shown(1.0)


def test_an_estimator_that_fails_is_asked_less_and_less_urgently(make, fakes):
    session = make(automatic=True)
    urgent = []
    for index in range(300):
        now_s = index / 10
        session.take(fakes.tracked(index), now_s)
        if session.watch.is_estimating:
            urgent.append(session.worker.is_awaited)
            session.answered(WorkerFailure(index, "it died"), now_s)
    assert urgent[0]
    assert not any(urgent[FUTILE:])
    assert len(urgent) < FUTILE + 30.0 / CHECKED_EVERY_S + 1


def test_reset_gives_light_and_model_back_to_the_estimate(shown, fakes):
    session = shown()
    session.estimated(fakes.estimate())
    before = session.poll(5.0), bare_scene(session)
    session.set_by_hand(6.0)
    for command in (Command.SCALE_MODEL, Command.TURN_MODEL):
        session.press(command, 3, 6.0)
    session.press(Command.MOVE_MODEL, (2, 2), 6.0)
    assert bare_scene(session).placement != before[1].placement
    session.press(Command.RESET, now_s=7.0)
    session.poll(7.0)
    session.poll(9.0)
    assert bare_scene(session) == before[1]
    assert session.lit_by.lights is session.estimate.lights


def test_where_the_model_stands_does_not_touch_the_light(shown, fakes):
    session = shown()
    session.estimated(fakes.estimate())
    session.press(Command.MOVE_MODEL, (1, 0), 1.0)
    session.press(Command.SCALE_MODEL, 1, 1.0)
    assert session.hand.light is None
    assert light_line(session).startswith("light: azimuth")


def test_another_source_forgets_all_of_the_one_before(shown, fakes):
    session = shown(at_frame=4, automatic=True, truth=(0.0, 0.0, 1.0))
    session.estimated(fakes.estimate())
    session.press(Command.SCALE_MODEL, 2, 1.0)
    session.request_estimate(1.0)
    session.begin_anew(is_photo=True)
    session.worker.answer = None
    assert not session.watch.is_estimating
    assert session.estimate is session.answer is None
    assert session.lit_by is session.shown
    assert session.shown.light is session.shown.seen_in is session.shown.real_object is None
    assert session.true_to_light_marker is None
    assert bare_scene(session).placement == UNMOVED
    assert session.automatic
    assert session.watch.held.estimate is None
    assert session.watch.key_views.views == ()
    session.take(fakes.tracked(9), 2.0)  # a photo is steady at once
    assert session.watch.is_estimating
    assert session.worker.requested[-1].frame.index == 9


def test_a_models_file_is_shown_by_its_name(make, tmp_path):
    session = make()
    session.table.shelf.add(str(tmp_path / "chair.obj"))
    assert session.table.model_name == "chair.obj"


@pytest.mark.parametrize("is_photo", [False, True])
def test_the_light_of_another_source_is_estimated_by_itself(make, fakes, is_photo):
    """Also where that of the one before, a camera, waited for a key; a photo has one frame, and that is steady."""
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.begin_anew(is_photo)
    for index in range(1 if is_photo else 60):
        session.take(fakes.tracked(index), index / 30)
    assert len(session.worker.requested) == 1


def test_the_last_frame_of_a_short_clip_is_estimated_once(shown, fakes):
    session = shown(on_first_steady=True)
    assert session.settle_for_last(0.0)
    assert not session.settle_for_last(0.0)
    session.answered(fakes.estimate(), 0.0)
    assert not session.settle_for_last(0.0)
    assert [frozen.frame.index for frozen in session.worker.requested] == [0]


@pytest.mark.parametrize("when", [{}, {"on_first_steady": True, "at_frame": 9}])
def test_the_last_frame_is_not_estimated_where_nobody_asked_for_it(make, shown, fakes, when):
    session = shown(**when)
    assert not session.settle_for_last(0.0)
    unseen = make(on_first_steady=True)
    assert not unseen.settle_for_last(0.0), "not even a frame"
    unseen.take(fakes.tracked(0, has_marker=False), 0.0)
    assert not unseen.settle_for_last(0.0)
    assert unseen.first.awaits_steady, "the next round may show one"
    assert unseen.notice.text is None


def test_only_an_estimate_that_a_person_waits_for_is_urgent(make, fakes):
    session = make(automatic=True)
    urgent = []
    now_s = 0.0
    for index in range(12):
        now_s += CHECKED_EVERY_S
        session.take(fakes.tracked(index), now_s)
        if session.watch.is_estimating:
            urgent.append(session.worker.is_awaited)
            session.answered(fakes.estimate(index), now_s)
    assert urgent[0]  # there is no light yet
    assert len(urgent) > 2
    assert not any(urgent[1:])
    session.request_estimate(now_s)
    assert session.worker.is_awaited


def test_what_is_left_out_of_a_model_is_reported_in_the_window_and_the_terminal(make, capsys):
    session = make()
    session.table.shelf.words = ["duck.glb: points and lines are left out"]
    session.poll(1.0)
    assert session.notice.shown(1.0) == "duck.glb: points and lines are left out"
    assert capsys.readouterr().err == "ashe-live: duck.glb: points and lines are left out\n"
    session.poll(2.0)
    assert capsys.readouterr().err == ""


def test_long_messages_stay_long_enough_to_be_read(make):
    session = make()
    session.say("word " * 100, 0.0)
    assert session.notice.shown(NOTICE_S + 1) is not None
    session.say("short", 0.0)
    assert session.notice.shown(NOTICE_S + 1) is None


def test_a_key_stands_the_model_on_another_side(make):
    session = make()
    assert session.press(Command.TURN_UP)
    assert session.table.shelf.turned == 1
    assert session.notice.shown(0.0) == "cube: z is up"


def test_of_several_changes_the_one_to_another_side_is_undone_in_its_turn(make):
    session = make()
    for number, command in enumerate((Command.TURN_MODEL, Command.TURN_UP, Command.TURN_UP, Command.UNDO)):
        session.press(command, 1, 10.0 * number)
    assert session.notice.shown(30.0) == "undone: cube: z is up"
    assert session.hand.placement.turn_rad != 0
    for command, said in ((Command.UNDO, "undone: cube: y is up"), (Command.UNDO, "undone: model as before")):
        session.press(command, now_s=40.0)
        assert session.notice.shown(40.0) == said
    assert session.hand.placement.turn_rad == 0


def test_another_model_is_not_stood_on_another_side_by_undoing(make):
    session = make()
    session.press(Command.TURN_UP)
    session.press(Command.CHOOSE_MODEL, 1, 1.0)
    session.poll(1.0)
    session.press(Command.UNDO, now_s=2.0)
    assert session.table.shelf.turned == 1
    assert "nothing was done" in session.notice.shown(2.0)


def test_what_was_done_to_the_light_is_undone_also_after_another_model_was_chosen(shown):
    session = shown()
    session.poll(0.0)
    session.set_by_hand(0.0)
    first = session.hand.light
    session.press(Command.SCALE_MODEL, 3, 10.0)
    session.press(Command.MOVE_LIGHT, (0, 1), 20.0)
    session.press(Command.NEXT_MODEL, now_s=30.0)
    session.poll(30.0)
    session.press(Command.TURN_MODEL, 1, 40.0)
    for light, said in ((session.hand.light, "model"), (first, "light"), (None, "light")):
        session.press(Command.UNDO, now_s=50.0)
        assert session.hand.light is light
        assert session.hand.placement == UNMOVED
        assert session.notice.shown(50.0) == f"undone: {said} as before"
    session.press(Command.UNDO, now_s=60.0)
    assert "nothing was done" in session.notice.shown(60.0)


def test_a_moving_model_goes_on_until_it_is_stopped(make, shown, fakes):
    session = make()
    session.press(Command.STOP_MOTION)
    assert session.notice.shown(0.0) == "cube stands still: it has no animation that is played"
    session.table.shelf.moves = True
    session.take(fakes.tracked(0), 10.0)
    shown = []
    for now_s in (10.5, 11.0, 11.5, 12.0):
        session.poll(now_s)
        shown.append(bare_scene(session).time_s)
        session.press(Command.STOP_MOTION, now_s=now_s)
    assert shown == [0.5, 0.5, 1.0, 1.0]
    session.take(fakes.tracked(1), 3.0)  # a clock that goes back, as a clip's
    assert session.table.motion_s == 1.0


def test_what_is_said_of_a_motion_is_what_is_seen(make, fakes):
    still = box((0.05, 0.05, 0.05))
    motion = Motion(np.stack([still.vertices] * 2), np.stack([still.normals] * 2), 2.0)
    session = make()
    shelf = session.table.shelf
    session.take(fakes.tracked(), 0.0)
    session.poll(0.0)
    shelf.moves = True
    for command, said in (
        (Command.NEXT_MODEL, "lantern moves: K stops it"),
        (Command.STOP_MOTION, "lantern stands still: K changes that"),
        (Command.NEXT_MODEL, "mug stands still: K changes that"),
    ):
        session.press(command, now_s=10.0)
        session.notice.withdraw(session.notice.text)  # a hint hides nothing that was said
        session.poll(10.1)
        assert session.notice.text == said
    # One that moves is left beside one that cannot.
    shelf.shown = placed_on_marker(Model("moving", (dataclasses.replace(still, motion=motion),)), 0.08)
    session.press(Command.ADD_MODEL, now_s=40.0)
    shelf.moves, shelf.shown = False, fakes.Shelf.shown
    session.press(Command.STOP_MOTION, now_s=50.0)
    assert session.notice.shown(50.0) == "another model moves: K stops it"


def test_before_and_after(shown):
    session = shown()
    shown = []
    for _ in range(5):
        scene = bare_scene(session)
        shown.append((session.view.parts, scene.shows_model, scene.casts_shadow, scene.is_split))
        assert (scene.model is not None) is (scene.shows_model or scene.casts_shadow)
        session.press(Command.BEFORE_AFTER)
    assert [each[1] for each in shown] == [True, True, False, False, True]
    assert [each[2] for each in shown] == [True, False, True, False, True]
    assert [each[3] for each in shown] == [False, False, False, False, True]
    assert session.view.parts == shown[0][0]
    session.press(Command.BEFORE_AFTER)
    session.press(Command.RESET)
    assert bare_scene(session).casts_shadow


def test_each_model_stays_where_it_was_put(shown):
    session = shown()
    session.poll(0.0)
    session.press(Command.SCALE_MODEL, 3)
    large = session.hand.placement
    session.press(Command.NEXT_MODEL)
    session.poll(0.0)
    assert session.hand.placement == UNMOVED
    session.press(Command.TURN_MODEL, 2)
    session.press(Command.PREVIOUS_MODEL)
    session.poll(0.0)
    assert session.hand.placement == large


def test_the_light_stays_in_the_room_while_the_marker_is_turned(make, fakes):
    session = make()
    session.take(lying(fakes.tracked(0), 0), 0.0)
    session.estimated(fakes.estimate(0))
    session.poll(10.0)
    room = session.shown.light.to_light_marker
    for index, turn_deg in enumerate((20, 200, 40), 1):
        place = placed(turn_deg)
        session.take(dataclasses.replace(fakes.tracked(index), T_room_marker=place), 10.0 + index)
        # Without a window nobody polls.
        assert place[:3, :3] @ session.shown.light.to_light_marker == pytest.approx(room)
        session.poll(10.0 + index)
        assert place[:3, :3] @ session.shown.light.to_light_marker == pytest.approx(room)
        assert session.lit_by is session.shown
        assert session.estimate_now.light.to_light_marker == pytest.approx(session.shown.light.to_light_marker)
        before = session.shown
        session.take(dataclasses.replace(session.tracked, marker=None), 10.05 + index)
        assert session.lit_by is before
        session.take(
            dataclasses.replace(fakes.tracked(index + 9), T_room_marker=session.tracked.T_room_marker), 10.1 + index
        )
        session.poll(10.1 + index)
        assert session.shown is before  # so that nothing is drawn anew
    # A new answer is by the marker as it lies now, and is reached from where the light was in the room.
    session.estimated(fakes.estimate(13), 20.0)
    assert place[:3, :3] @ session.shown.light.to_light_marker == pytest.approx(room)
    session.poll(30.0)
    assert session.shown.light.to_light_marker == pytest.approx(room)


def test_a_light_by_hand_stays_in_the_room_while_the_marker_is_turned(make, fakes):
    session = make()
    session.take(lying(fakes.tracked(0), 30), 0.0)
    session.press(Command.MOVE_LIGHT, (3, 2))
    room = placed(30)[:3, :3] @ session.hand.light.light.to_light_marker
    for index, turn_deg in enumerate((50, 130), 1):
        place = placed(turn_deg)
        session.take(dataclasses.replace(fakes.tracked(index), T_room_marker=place), float(index))
        assert session.shown is session.lit_by is session.hand.light
        assert place[:3, :3] @ session.shown.light.to_light_marker == pytest.approx(room)
    # A key press goes on from there, and undoing it gives the light back to where it was in the room.
    session.press(Command.MOVE_LIGHT, (0, -5), 10.0)
    assert place[2, :3] @ session.lit_by.light.to_light_marker < room[2] - 0.05
    place = placed(200)
    session.take(dataclasses.replace(fakes.tracked(3), T_room_marker=place), 11.0)
    session.press(Command.UNDO, now_s=12.0)
    session.poll(12.0)
    assert place[:3, :3] @ session.shown.light.to_light_marker == pytest.approx(room)


def test_nobody_asks_about_a_sheet_that_is_held_still_above_the_table_where_its_light_was_found(make, fakes):
    session = make(automatic=True, steady_frames=1)
    on_table = lying(fakes.tracked(0), 0)
    lifted = dataclasses.replace(on_table, T_room_marker=rigid(np.eye(3), (0.0, 0.0, 0.2)))

    def requests_made(first: int, place) -> int:
        before = len(session.worker.requested)
        for index in range(first, first + 5):
            session.take(dataclasses.replace(place, frame=fakes.tracked(index).frame), float(index))
            session.worker.answer = fakes.estimate(index)
            session.poll(float(index))
        return len(session.worker.requested) - before

    assert requests_made(0, on_table) > 1
    assert requests_made(5, lifted) == 0
    assert requests_made(10, on_table) > 1


def test_nobody_asks_about_a_picture_in_which_the_marker_is_being_moved(make, fakes):
    session = make(automatic=True, steady_frames=1)
    session.take(lying(fakes.tracked(0), 0), 0.0)
    assert len(session.worker.requested) == 1
    session.answered(fakes.estimate(0), 0.0)
    for index in range(1, 60):
        session.take(lying(fakes.tracked(index), index), float(index))
    assert len(session.worker.requested) == 1
    session.take(dataclasses.replace(fakes.tracked(60), T_room_marker=session.tracked.T_room_marker), 60.0)
    assert len(session.worker.requested) == 2


@pytest.mark.parametrize("other", ["none", "place", "camera"])
def test_a_frame_in_doubt_is_compared_with_those_of_its_place_and_camera_alone(make, fakes, other):
    """Beside a frame by another focal length, or from where the marker lay, poses do not fit each other."""
    session = make()
    watch, worker = session.watch, session.worker
    session.take(lying(fakes.tracked(0), 0), 0.0)
    session.estimated(fakes.estimate())
    watch.key_views = fakes.KeyViews(lying(fakes.tracked(1), 0))
    doubted = lying(fakes.tracked(2), 0)
    assert watch.ask_in_background(doubted, 1.0)
    worker.answer, worker.outdated = fakes.estimate(2), (0,)
    watch.wait(0.0)
    seen = lying(fakes.tracked(3), 40 if other == "place" else 0)
    if other == "camera":
        seen = dataclasses.replace(seen, camera=Camera.from_hfov(seen.camera.size, 70.0))
    assert watch.ask_in_background(seen, 2.0)
    assert (worker.doubted is doubted) is (other == "none")


def seen_at(fakes, time_s: float, index: int = 0):
    tracked = fakes.tracked(index)
    return dataclasses.replace(tracked, frame=Frame(tracked.frame.image_bgr, index, time_s))


def test_the_empty_table_goes_with_requests_until_it_is_old(make, fakes):
    session = make()
    worker = session.worker
    session.press(Command.EMPTY_TABLE)
    assert session.notice.text == "no marker in view"
    empty = seen_at(fakes, 0.0)
    session.take(empty, 0.0)
    session.press(Command.EMPTY_TABLE)
    for now_s, is_given in ((5.0, True), (EMPTY_FOR_S + 1, False)):
        session.take(seen_at(fakes, now_s, 1), now_s)
        assert session.request_estimate(now_s)
        assert (worker.empty is empty) is is_given
        worker.answer = fakes.estimate()
        session.poll(now_s)
    session.begin_anew(is_photo=False)
    assert session.watch.empty_table.frame is None


@pytest.mark.parametrize(("now_s", "turned_deg", "said"), [(400.0, 0.0, "minutes ago"), (5.0, 30.0, "elsewhere")])
def test_that_the_empty_table_no_longer_counts_is_said_once_to_who_has_shown_it(make, fakes, now_s, turned_deg, said):
    for is_shown in (True, False):
        session = make()
        session.take(lying(seen_at(fakes, 0.0), 0), 0.0)
        if is_shown:
            session.press(Command.EMPTY_TABLE)
        else:  # found by an estimate, of which the user knows nothing
            session.watch.empty_table.found(session.tracked)
        session.take(lying(seen_at(fakes, now_s, 1), turned_deg), now_s)
        session.request_estimate(now_s)
        session.poll(now_s)
        assert (said in (session.notice.text or "")) is is_shown
        session.say("", now_s)
        session.poll(now_s)
        assert said not in (session.notice.text or "")


def test_a_frame_in_which_nothing_stands_there_is_the_empty_table(make, fakes):
    session = make()
    session.watch.camera_may_move = True
    frozen = fakes.tracked()
    session.take(frozen, 0.0)
    session.request_estimate(0.0)
    assert WITHOUT_IT not in guidance(session)
    session.worker.answer, session.worker.shows_empty_table = fakes.estimate(with_light=False), True
    session.poll(0.0)
    assert session.watch.empty_table.frame is frozen
    assert WITHOUT_IT not in guidance(session)  # it has been said what is missing
    session.watch.empty_table.frame = None
    assert WITHOUT_IT in guidance(session)


def test_a_paper_cube_needs_no_empty_table(make, fakes):
    session = make()
    session.take(on_cube(fakes.tracked()), 0.0)
    session.press(Command.EMPTY_TABLE)
    assert session.watch.empty_table.frame is None
    assert "cube" in session.notice.text


def test_an_estimator_of_one_frame_makes_no_use_of_the_empty_table(make, fakes):
    session = make()
    session.worker.takes_one_frame = True
    session.take(fakes.tracked(), 0.0)
    session.press(Command.EMPTY_TABLE)
    assert session.watch.empty_table.frame is None
    assert "no use" in session.notice.text
    session.watch.camera_may_move = True
    session.estimated(fakes.estimate(with_light=False))
    assert WITHOUT_IT not in guidance(session)
