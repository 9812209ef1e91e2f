"""What the session knows, says and asks the worker for."""

import dataclasses

import numpy as np
import pytest

from ashe_live.core.arrays import Image
from ashe_live.core.camera import Camera
from ashe_live.core.proxy import Proxy
from ashe_live.core.transforms import angle_between, direction_from_angles, rigid
from ashe_live.core.types import Frame, Illumination, Light
from ashe_live.errors import UserError
from ashe_live.light.live.worker_messages import WorkerFailure
from ashe_live.models.mesh import Model, Motion
from ashe_live.models.placement import UNMOVED, Placement, placed_on_marker
from ashe_live.models.primitives import box
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.display import bare_scene
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.estimates.held_empty_table import EMPTY_FOR_S
from ashe_live.viewer.estimates.not_there_yet import ANSWER_ALONE
from ashe_live.viewer.estimates.sharpening import CHECKED_EVERY_S, EVERY_S, FUTILE
from ashe_live.viewer.hands.requests import Command, Request
from ashe_live.viewer.notice import NOTICE_S
from ashe_live.viewer.session import Session
from ashe_live.viewer.status import (
    LAMP_AMONG_MANY,
    LAMP_BELOW,
    LAMP_INSIDE,
    OUT_OF_PICTURE,
    WITHOUT_IT,
    camera_line,
    guidance,
    light_line,
    marker_line,
    source_lines,
    status_lines,
)


@pytest.fixture
def make(fakes):
    """A session with fakes behind it: `when` its first estimate is made, and after how many frames it is steady."""

    def make(truth=None, automatic=False, steady_frames=3, **when) -> Session:
        first = FirstEstimate(Steadiness(steady_frames), **when)
        return Session(fakes.Shelf(), fakes.Worker(), first, truth, automatic=automatic)

    return make


def test_the_first_steady_frame_is_estimated_once(make, fakes):
    session = make(on_first_steady=True)
    for index in range(2):
        session.take(fakes.tracked(index), 0.0)
    assert not session.watch.is_estimating
    assert session.first.awaits_steady
    session.take(fakes.tracked(2), 0.0)
    assert session.watch.is_estimating
    session.watch._worker.answer = fakes.estimate(2)
    assert session.poll(0.0).estimate is session.estimate
    for index in range(3, 20):
        session.take(fakes.tracked(index), 0.0)
    assert [frozen.frame.index for frozen in session.watch._worker.requested] == [2]


def test_of_a_looped_clip_that_is_never_steady_the_next_rounds_first_frame_is_estimated(make, fakes):
    session = make(on_first_steady=True, steady_frames=9)
    for index in (0, 1, 3, 5, 0):
        assert not session.watch.is_estimating
        session.take(fakes.tracked(index), 0.0)
    assert [frozen.frame.index for frozen in session.watch._worker.requested] == [0]


def test_a_chosen_frame_is_estimated_and_no_other(make, fakes):
    session = make(on_first_steady=True, at_frame=7)
    for index in range(20):
        session.take(fakes.tracked(index), 0.0)
    assert [frozen.frame.index for frozen in session.watch._worker.requested] == [7]


def test_when_the_chosen_frame_came_too_late_the_next_one_is_taken(make, fakes):
    session = make(at_frame=7)
    for index in (5, 6, 9, 10):
        session.take(fakes.tracked(index), 0.0)
    assert [frozen.frame.index for frozen in session.watch._worker.requested] == [9]


def test_the_estimate_holds_wherever_the_clip_goes(make, fakes):
    session = make(on_first_steady=True)
    session.take(fakes.tracked(40), 0.0)
    assert session.request_estimate(0.0)
    session.watch._worker.answer = fakes.estimate(40)
    held = session.poll(0.0).estimate
    for index in (41, 3, 2, 1, 90, 0, 1):  # on, sought back, stepped back, sought on, started again
        session.take(fakes.tracked(index), 1.0)
        session.poll(1.0)
        assert session.estimate is held
        assert session.shown is session.lit_by
        assert session.shown.seen_in is session.answer.frozen


@pytest.mark.parametrize("command", [Command.TOGGLE_LIGHT, Command.TOGGLE_STEPS])
def test_nobody_who_waits_for_an_estimate_is_advised_to_ask_for_one(make, fakes, command):
    session = make()
    session.take(fakes.tracked(0), 0.0)
    session.handle(Request(command), 0.0)
    assert "Space estimates it" in session.notice.text
    session.handle(Request(command), 0.0)
    session.handle(Request(Command.ESTIMATE), 0.0)
    session.handle(Request(command), 0.0)
    assert "it is being estimated" in session.notice.text


def test_without_a_policy_nothing_is_estimated_unasked(make, fakes):
    session = make()
    for index in range(20):
        session.take(fakes.tracked(index), 0.0)
    assert not session.watch.is_estimating
    assert session.handle(Request(Command.ESTIMATE), 0.0)
    assert session.watch.is_estimating


def test_the_estimate_goes_with_the_frame_it_was_made_from(make, fakes):
    session = make()
    session.take(fakes.tracked(4), 0.0)
    session.request_estimate(0.0)
    session.take(fakes.tracked(5), 0.0)
    session.watch._worker.answer = fakes.estimate(4)
    session.poll(0.0)
    assert session.answer.frozen.frame.index == session.estimate.frame_index == 4


def test_a_second_request_meanwhile_is_refused_and_said(make, fakes):
    session = make()
    session.take(fakes.tracked(1), 0.0)
    assert session.request_estimate(0.0)
    session.take(fakes.tracked(2), 0.0)
    assert not session.request_estimate(0.0)
    assert "still" in session.notice.shown(0.0)
    session.watch._worker.answer = fakes.estimate(1)
    session.poll(0.0)
    assert session.answer.frozen.frame.index == 1


@pytest.mark.parametrize("has_frame", [False, True])
def test_without_a_marker_it_says_so_instead_of_estimating(make, fakes, has_frame):
    session = make()
    if has_frame:
        session.take(fakes.tracked(has_marker=False), 0.0)
    assert not session.request_estimate(0.0)
    assert "no marker in view" in session.notice.shown(0.0)
    assert not session.watch.is_estimating


def test_a_failure_is_said_and_keeps_the_last_light(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.request_estimate(0.0)
    session.watch._worker.answer = good = fakes.estimate()
    session.poll(0.0)
    session.request_estimate(1.0)
    session.watch._worker.answer = WorkerFailure(0, "the light estimator's process has died")
    assert session.poll(1.0) is None
    assert session.estimate is good
    assert "has died" in session.notice.shown(1.0)
    assert not session.watch.is_estimating


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


def test_switches_toggle(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    for command, switch in (
        (Command.TOGGLE_LIGHT, "shows_light"),
        (Command.TOGGLE_STEPS, "shows_steps"),
        (Command.COVER_MARKER, "covers_marker"),
        (Command.TOGGLE_HUD, "shows_hud"),
    ):
        holder = session if switch == "covers_marker" else session.view
        before = getattr(holder, switch)
        for expected in (not before, before):
            session.handle(Request(command), 0.0)
            assert getattr(holder, switch) is expected


def test_the_help_is_shown_and_hidden_by_its_key(make):
    session = make()
    for expected in (True, False):
        session.handle(Request(Command.HELP), 0.0)
        assert session.view.help.is_shown is expected


def test_a_sheet_is_covered_and_a_cube_is_not_unless_somebody_chooses(make, fakes):
    session, sheet = make(), fakes.tracked()
    body = Proxy("box", [(0.0, 0.0, 0.03, 0.03, 0.03)])
    cube = dataclasses.replace(sheet, marker=dataclasses.replace(sheet.marker, body=body))
    for tracked, is_covered in ((sheet, True), (cube, False)):
        session.take(tracked, 0.0)
        assert session.covers_marker is is_covered
    for chosen in (True, False):
        session.handle(Request(Command.COVER_MARKER), 0.0)
        for tracked in (sheet, cube):
            session.take(tracked, 0.0)
            assert session.covers_marker is chosen


def test_without_a_marker_in_view_nothing_is_covered_or_shown_unseen(make, fakes):
    session, in_view = make(), fakes.tracked()
    for tracked in (None, dataclasses.replace(in_view, marker=None)):
        if tracked is not None:
            session.take(tracked, 0.0)
        session.handle(Request(Command.COVER_MARKER), 0.0)
        assert session.view.wants_cover is None
        assert "no marker in view" in session.notice.shown(0.0)


def test_a_model_takes_a_covered_cubes_place_once_the_ground_over_it_is_drawn(make, fakes):
    session, sheet = make(), fakes.tracked()
    body = Proxy("box", [(0.0, 0.0, 0.03, 0.03, 0.03)])
    session.take(dataclasses.replace(sheet, marker=dataclasses.replace(sheet.marker, body=body)), 0.0)
    beside = session.hand.placement
    assert beside != UNMOVED
    session.handle(Request(Command.COVER_MARKER), 0.0)
    # The cover is made once it is wanted, and may be dropped for another light or another place of the cube.
    for is_drawn, expected in ((False, beside), (True, UNMOVED), (False, beside), (True, UNMOVED)):
        session.view.cover_is_drawn = is_drawn
        session.poll(1.0)
        assert session.hand.placement == expected
    session.handle(Request(Command.COVER_MARKER), 2.0)
    session.poll(2.0)
    assert session.hand.placement == beside


def test_what_led_to_an_answer_is_asked_for_only_to_be_shown(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)

    def estimated(now_s: float) -> Image | None:
        session.request_estimate(now_s)
        session.watch._worker.answer, session.watch._worker.picture = fakes.estimate(), picture
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


def test_what_was_said_to_be_missing_is_not_said_once_it_is_there(make, fakes):
    toggles = {Command.TOGGLE_LIGHT: "the arrow", Command.TOGGLE_STEPS: "nothing has been estimated"}
    for command, said in toggles.items():
        session = make()
        session.take(fakes.tracked(), 0.0)
        session.handle(Request(command), 0.0)
        assert said in session.notice.shown(0.1)
        session.request_estimate(0.2)
        session.watch._worker.answer, session.watch._worker.picture = fakes.estimate(), np.zeros((8, 8, 3), np.uint8)
        session.poll(0.3)
        assert session.notice.shown(0.3) is None
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.handle(Request(Command.TOGGLE_LIGHT), 0.0)
    session.handle(Request(Command.MOVE_LIGHT, (1, 0)), 0.1)  # by hand
    assert session.notice.shown(0.1) is None


def test_the_answer_alone_is_no_longer_spoken_of_beside_its_steps(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    for now_s, picture in ((0.0, None), (1.0, np.zeros((8, 8, 3), np.uint8))):
        session.request_estimate(now_s)
        session.watch._worker.answer, session.watch._worker.picture = fakes.estimate(), picture
        session.poll(now_s)
        if picture is None:
            session.handle(Request(Command.TOGGLE_STEPS), now_s)
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
        session.watch._worker.answer = answers(now_s) if session.watch.is_estimating else None
        session.poll(now_s)
        session.take(fakes.tracked(index, has_marker(now_s)), now_s)


def test_automatically_it_estimates_until_that_gains_nothing_and_then_only_what_has_changed(make, fakes):
    session = make(automatic=True)
    session.watch.key_views = fakes.KeyViews(fakes.tracked(1000))
    run_steadily(session, fakes, lambda _s: fakes.estimate(), 20.0)
    worker = session.watch._worker
    gaps_s = np.diff([frozen.frame.time_s for frozen in worker.requested])
    assert worker.known[: FUTILE + 1] == [None] * (FUTILE + 1)
    assert gaps_s[:FUTILE] == pytest.approx(EVERY_S, abs=0.1)
    assert all(known is not None for known in worker.known[FUTILE + 1 :])
    assert gaps_s[FUTILE:] == pytest.approx(CHECKED_EVERY_S, abs=0.1)


def test_a_known_light_is_followed_and_shown_elsewhere_only_once_it_has_moved(make, fakes):
    session = make(automatic=True)
    session.watch.key_views = fakes.KeyViews(fakes.tracked(1000))
    run_steadily(session, fakes, lambda _s: fakes.estimate(sigma_rad=0.01), 10.0)
    worker, held = session.watch._worker, session.estimate
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
        session.watch._worker.outdated, session.watch._worker.answer = (0,), lamp
        session.poll(now_s)
    assert session.estimate is lamp
    assert session.watch.key_views.views == ()
    assert not session.watch.sharpening.is_settled


def test_automatically_nothing_is_asked_without_a_steady_marker(make, fakes):
    session = make(automatic=True)
    run_steadily(session, fakes, lambda _s: fakes.estimate(), 3.0, lambda now_s: round(now_s * 30) % 3 > 0)
    assert session.watch._worker.requested == []
    assert session.notice.text is None


def test_an_outlier_changes_neither_light_nor_masks_and_a_changed_light_does(make, fakes):
    session = make(automatic=True)
    run_steadily(session, fakes, lambda _s: fakes.estimate(), 3.0)
    before = session.estimate, session.answer.frozen
    for answers in range(3):
        session.take(fakes.tracked(1000 + answers), 9.0 + 2 * answers)
        assert session.watch.is_estimating
        session.watch._worker.answer = fakes.estimate(with_light=False)
        assert (session.poll(9.0) is None) is (answers < 2)
        assert ((session.estimate, session.answer.frozen) == before) is (answers < 2)
    assert session.estimate.light is None


def test_what_a_person_asks_for_is_shown_whatever_was_held(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    for now_s, towards in ((0.0, (1.0, 0.0, 1.0)), (1.0, (0.0, -1.0, 1.0))):
        session.request_estimate(now_s)
        session.watch._worker.answer = fakes.estimate(towards=towards)
        assert session.poll(now_s).estimate is session.estimate
        assert session.estimate.light.to_light_marker == pytest.approx(np.array(towards) / np.sqrt(2))
    session.request_estimate(2.0)
    session.watch._worker.answer = fakes.estimate(with_light=False)
    session.poll(2.0)
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
    assert session.watch._worker.requested == [frozen]
    assert [view.frame.index for view in session.watch._worker.others] == [100, 101, 103]


def test_while_the_camera_moves_the_answer_is_sharpened_until_that_gains_nothing(make, fakes):
    session = make()
    session.take(fakes.tracked(0), 0.0)
    session.request_estimate(0.0)
    session.watch._worker.answer = fakes.estimate(0, sigma_rad=0.07)
    session.poll(0.0)
    sigmas = [0.06, 0.04]  # and no better than the next
    for at in range(60):
        now_s = 1.0 + at
        session.watch.key_views = fakes.KeyViews(*orbit(fakes, 2 + at // 2))
        session.take(fakes.tracked(at), now_s)
        if session.watch.is_estimating:
            assert not session.watch.is_awaited
            frozen = session.watch._worker.requested[-1]
            assert frozen is session.watch.key_views.views[-1]
            others = [view.frame.index for view in session.watch._worker.others]
            session.watch._worker.answer = fakes.estimate(
                frozen.frame.index, sigma_rad=sigmas.pop(0) if sigmas else 0.02, others=others, span_rad=0.1
            )
            session.poll(now_s)
    assert session.estimate.light.sigma_rad == 0.02
    assert session.watch.sharpening.is_settled
    # The first one, three that gained, three that did not, and where the views spanned half as much again.
    assert 1 + 3 + FUTILE <= len(session.watch._worker.requested) <= 1 + 3 + FUTILE + 5
    assert "views over 6°" in light_line(session)


def test_nobody_moves_nothing_is_sharpened(make, fakes):
    session = make()
    session.watch.key_views = fakes.KeyViews(fakes.tracked(0))
    for index in range(60):
        session.take(fakes.tracked(index), index / 10)
        if index == 0:
            session.request_estimate(0.0)
            session.watch._worker.answer = fakes.estimate(0)
        session.poll(index / 10)
    assert len(session.watch._worker.requested) == 1


def test_a_light_by_hand_is_not_sharpened(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    estimated(session, fakes, 0.0)
    by_hand(session, 1.0)
    session.watch.key_views = fakes.KeyViews(*orbit(fakes, 6))
    session.take(fakes.tracked(1), 5.0)
    assert not session.watch.is_estimating


def test_a_vague_answer_from_one_view_says_what_makes_it_sharper_to_who_can_move_the_camera(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    estimated(session, fakes, 0.0)
    assert "move" not in light_line(session)  # a clip moves by itself
    session.watch.camera_may_move = True
    assert light_line(session) == "light: azimuth 0°, elevation 45° ± 2.9°, move the camera a little"
    session.request_estimate(1.0)
    session.watch._worker.answer = fakes.estimate(sigma_rad=0.01)
    session.poll(1.0)
    assert "move" not in light_line(session)


def test_a_key_switches_it_on_and_holds_the_light_when_it_is_switched_off(make, fakes):
    session = make()
    session.handle(Request(Command.AUTOMATIC), 0.0)
    run_steadily(session, fakes, lambda _s: fakes.estimate(), 3.0)
    session.handle(Request(Command.AUTOMATIC), 3.0)
    held, asked = session.estimate, len(session.watch._worker.requested)
    assert held is not None
    for index in range(100):
        session.take(fakes.tracked(index), 4.0 + index)
    assert (session.estimate, len(session.watch._worker.requested)) == (held, asked)


def test_until_a_marker_was_seen_it_says_how_to_get_one(make, fakes):
    session = make()
    session.take(fakes.tracked(has_marker=False), 0.0)
    assert len(status_lines(session, None, "fast")) == 2, "what follows from a marker is nothing to read yet"
    assert any("name it with --marker" in line for line in guidance(session)), "a file shows what it shows"
    session.arrangement.followed = "image:logo.png"
    assert guidance(session)[0].startswith("the marker image:logo.png is not found")
    session.arrangement.followed = "cube"
    assert guidance(session)[0].startswith("the paper cube is not found")
    session.has_named_marker = False
    assert guidance(session)[0].startswith("no marker is found here"), "nobody has heard of the one by default"
    assert not any("cube" in line for line in guidance(session))
    session.watch.camera_may_move = True
    assert any("marker --show" in line for line in guidance(session))
    session.take(fakes.tracked(), 0.0)
    session.take(fakes.tracked(has_marker=False), 0.0)
    assert guidance(session) == ()


def test_after_no_light_it_says_what_to_change(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.request_estimate(0.0)
    session.watch._worker.answer = fakes.estimate(with_light=False)
    session.poll(0.0)
    line, by_hand = guidance(session)
    assert line.startswith("what helps")
    assert "by hand" in by_hand
    session.request_estimate(0.0)
    assert guidance(session) == ()


def test_the_light_line_names_every_state(make, fakes):
    session = make(truth=direction_from_angles(0.0, np.radians(45)))
    session.take(fakes.tracked(), 0.0)
    lines = [light_line(session)]
    session.request_estimate(0.0)
    lines.append(light_line(session))
    session.watch._worker.answer = fakes.estimate()
    session.poll(0.0)
    lines.append(light_line(session))
    session.request_estimate(0.0)
    lines.append(light_line(session))
    session.watch._worker.answer = fakes.estimate(with_light=False)
    session.poll(0.0)
    lines.append(light_line(session))
    assert "Space" in lines[0]
    assert lines[1] == "light: estimating…"
    assert lines[2] == "light: azimuth 0°, elevation 45° ± 2.9° (0.0° from the truth)"
    assert lines[3] == lines[2] + ", estimating…"
    assert lines[4] == "no clear light: no shadow found beside the object"


def test_an_estimate_that_takes_long_says_for_how_long(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.request_estimate(10.0)
    worker = session.watch._worker
    worker.waited_s = 0.9
    assert light_line(session) == "light: estimating…"
    worker.waited_s = 2.6
    assert light_line(session) == "light: estimating, 2 s"
    worker.answer = fakes.estimate()
    session.poll(12.6)
    # One that nobody waits for is silent.
    session.watch.ask_in_background(fakes.tracked(1), 20.0)
    answer = light_line(session)
    assert "estimating" not in answer
    session.request_estimate(30.0)
    assert light_line(session) == f"{answer}, estimating, 2 s"


def test_while_it_waits_for_a_steady_marker_it_does_not_ask_for_a_key(make):
    assert "Space" not in light_line(make(on_first_steady=True))


def test_the_marker_line_distinguishes_found_from_lost(fakes):
    lines = {marker_line(None), marker_line(fakes.tracked()), marker_line(fakes.tracked(has_marker=False))}
    assert len(lines) == 3
    assert "marker: in view" in lines


def test_of_a_marker_only_what_is_wrong_is_said(fakes):
    seen = fakes.tracked()
    bent = dataclasses.replace(seen, marker=dataclasses.replace(seen.marker, reprojection_rms_px=2.4))
    line = marker_line(bent)
    assert line == "marker: in view, but bent: lay it flat, or measure the lens by `ashe-live calibrate`"
    by_file = dataclasses.replace(bent.camera, source="file")
    assert marker_line(dataclasses.replace(bent, camera=by_file)) == "marker: in view, but bent: lay it flat"


def test_a_camera_that_nobody_gave_is_announced_with_its_uncertainty(fakes):
    given = fakes.tracked()
    size = given.frame.size
    assert camera_line(None) is None
    assert camera_line(given) is None
    assumed = dataclasses.replace(given, camera=Camera.from_hfov(size, 60, "assumed"))
    assert "assumed" in camera_line(assumed)
    focal_px = Camera.from_hfov(size, 61.3).K[0, 0]
    estimated = dataclasses.replace(given, camera=Camera.from_focal(size, focal_px, "estimated", 0.01 * focal_px))
    shorter = Camera.from_focal(size, 0.99 * focal_px)
    assert camera_line(estimated) == f"camera: 61.3° ± {shorter.hfov_deg - 61.3:.1f}° wide, estimated from the marker"
    vague = dataclasses.replace(given, camera=Camera.from_focal(size, focal_px, "estimated", 0.08 * focal_px))
    assert "few views" in camera_line(vague)


def test_no_status_line_is_empty(make):
    session = make()
    assert all(status_lines(session, None, "fast"))
    assert status_lines(session, 59.6, "fast")[0] == "60 fps   model: cube   fast   H: keys"
    assert source_lines(session, None, 0.0) == []
    session.say("saved", 0.0)
    assert source_lines(session, "end of the clip", 0.0) == ["end of the clip", "saved"]


def by_hand(session, now_s: float) -> None:
    session.handle(Request(Command.MOVE_LIGHT, (1, 0)), now_s)
    session.poll(now_s)


def estimated(session, fakes, asked_s: float, with_light: bool = True) -> None:
    session.request_estimate(asked_s)
    session.watch._worker.answer = fakes.estimate(with_light=with_light)
    session.poll(asked_s + 0.1)


def test_a_light_by_hand_is_shown_at_once_and_said_to_be_so(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    by_hand(session, 1.0)
    assert session.shown is session.lit_by is session.hand.light
    assert session.estimate is None
    assert light_line(session).startswith("light by hand: azimuth")
    assert "±" not in light_line(session)
    assert bare_scene(session).illumination is session.hand.light


def test_what_was_said_of_a_light_by_hand_goes_with_it(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.handle(Request(Command.LIGHT_DISTANCE, -5), 1.0)
    assert "lamp" in session.notice.shown(1.0)
    session.handle(Request(Command.RESET), 1.5)
    assert session.notice.shown(1.5) == "the light is no longer by hand: Ctrl+Z takes that back"
    session.handle(Request(Command.UNDO), 2.0)
    assert session.hand.light is not None


def test_undoing_goes_back_through_all_lights_that_were_shown_an_estimate_among_them(make, fakes):
    """Two lights by hand, then an estimate: what came before it is the second of them."""
    session = make()
    session.take(fakes.tracked(), 0.0)
    estimated(session, fakes, 0.0)
    shown = [session.lit_by]
    for now_s in (1.0, 10.0):
        by_hand(session, now_s)
        shown.append(session.lit_by)
    estimated(session, fakes, 20.0)
    assert session.hand.light is None
    for before in reversed(shown[1:]):
        session.handle(Request(Command.UNDO), 30.0)
        assert session.lit_by is before
    session.handle(Request(Command.UNDO), 30.0)
    assert session.hand.light is None


def test_a_new_estimate_ends_the_light_by_hand_and_one_asked_for_before_does_not(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.request_estimate(1.0)
    by_hand(session, 2.0)
    session.watch._worker.answer = fakes.estimate()
    session.poll(3.0)
    assert session.estimate is not None
    assert session.lit_by is session.hand.light is not None
    estimated(session, fakes, 4.0)
    assert session.hand.light is None
    assert session.lit_by.lights is session.estimate.lights


def test_an_estimate_asked_for_again_while_it_is_made_ends_the_light_by_hand(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.request_estimate(1.0)
    by_hand(session, 2.0)
    session.handle(Request(Command.ESTIMATE), 3.0)
    assert session.notice.shown(3.0) == "still estimating"
    session.watch._worker.answer = fakes.estimate()
    session.poll(4.0)
    assert session.hand.light is None
    assert session.lit_by.lights is session.estimate.lights


def test_a_light_by_hand_that_is_brought_back_by_undoing_counts_from_then(make, fakes):
    session = make(automatic=True)
    session.take(fakes.tracked(), 0.0)
    by_hand(session, 1.0)
    session.handle(Request(Command.RESET), 2.0)
    session.handle(Request(Command.AUTOMATIC), 3.0)
    assert session.request_estimate(4.0)
    session.handle(Request(Command.UNDO), 5.0)
    brought_back = session.hand.light
    assert brought_back is not None
    assert not session.automatic
    session.watch._worker.answer = fakes.estimate()
    session.poll(6.0)
    assert session.lit_by is brought_back


def test_what_a_person_asks_for_while_nobodys_estimate_is_made_counts_from_when_they_asked(make, fakes):
    session = make()
    worker = session.watch._worker
    session.take(fakes.tracked(0), 0.0)
    session.request_estimate(0.0)
    worker.answer = fakes.estimate(0, sigma_rad=0.07)
    session.poll(0.5)
    session.watch.key_views = fakes.KeyViews(*orbit(fakes, 4))
    session.take(fakes.tracked(1), 1.0)
    assert session.watch.is_estimating
    assert not session.watch.is_awaited
    by_hand(session, 2.0)
    session.take(fakes.tracked(2), 3.0)
    assert session.request_estimate(3.0)
    assert session.watch.is_awaited
    assert not session.request_estimate(3.1), "one person's request waits at a time"
    assert worker.requested[-1].frame.index == 2, "the one that nobody waits for is given up, and not waited for"
    worker.answer = fakes.estimate(2)
    assert session.poll(5.0).estimate is session.estimate
    assert session.hand.light is None, "Space came after the hand, and so replaces its light"


def test_an_estimate_without_a_light_leaves_the_one_by_hand(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    by_hand(session, 1.0)
    estimated(session, fakes, 2.0, with_light=False)
    assert session.lit_by is session.hand.light is not None
    assert "stays as set by hand" in session.notice.shown(2.1)


def test_a_light_by_hand_ends_the_automatic_and_the_awaited_estimate(make, fakes):
    session = make(on_first_steady=True, automatic=True)
    session.take(fakes.tracked(), 0.0)
    by_hand(session, 0.0)
    assert not session.automatic
    for index in range(1, 30):
        session.take(fakes.tracked(index), index / 10)
    assert not session.watch.is_estimating
    assert session.hand.light is not None


@pytest.mark.parametrize("with_light", [True, False])
def test_after_a_light_by_hand_the_light_is_watched_again(make, fakes, with_light):
    session = make(automatic=True)
    session.take(fakes.tracked(), 0.0)
    by_hand(session, 0.0)
    session.handle(Request(Command.AUTOMATIC), 1.0)
    assert session.watch.is_awaited
    session.watch._worker.answer = fakes.estimate(with_light=with_light)
    session.poll(2.0)
    assert session.automatic is with_light
    assert (session.hand.light is None) is with_light
    asked = len(session.watch._worker.requested)
    for index in range(1, 60):
        session.take(fakes.tracked(index), 2.0 + index / 10)
    assert (len(session.watch._worker.requested) > asked) is with_light


def test_without_a_marker_a_light_by_hand_stays_and_is_not_said_to_be_watched(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    by_hand(session, 0.0)
    session.take(dataclasses.replace(fakes.tracked(1), marker=None), 1.0)
    session.handle(Request(Command.AUTOMATIC), 1.0)
    assert not session.automatic
    assert "no marker in view" in session.notice.shown(1.0)


def test_an_estimator_that_fails_is_asked_less_and_less_urgently(make, fakes):
    session = make(automatic=True)
    urgent = []
    for index in range(300):
        now_s = index / 10
        session.take(fakes.tracked(index), now_s)
        if session.watch.is_estimating:
            urgent.append(session.watch._worker.is_awaited)
            session.watch._worker.answer = WorkerFailure(index, "it died")
            session.poll(now_s)
    assert urgent[0]
    assert not any(urgent[FUTILE:])
    assert len(urgent) < FUTILE + 30.0 / CHECKED_EVERY_S + 1


def test_reset_gives_light_and_model_back_to_the_estimate(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    estimated(session, fakes, 0.0)
    before = session.poll(5.0), bare_scene(session)
    by_hand(session, 6.0)
    for command in (Command.SCALE_MODEL, Command.TURN_MODEL):
        session.handle(Request(command, 3), 6.0)
    session.handle(Request(Command.MOVE_MODEL, (2, 2)), 6.0)
    assert bare_scene(session).placement != before[1].placement
    session.handle(Request(Command.RESET), 7.0)
    session.poll(7.0)
    session.poll(9.0)
    assert bare_scene(session) == before[1]
    assert session.lit_by.lights is session.estimate.lights


def test_where_the_model_stands_does_not_touch_the_light(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    estimated(session, fakes, 0.0)
    session.handle(Request(Command.MOVE_MODEL, (1, 0)), 1.0)
    session.handle(Request(Command.SCALE_MODEL, 1), 1.0)
    assert session.hand.light is None
    assert light_line(session).startswith("light: azimuth")


def test_another_source_forgets_all_of_the_one_before(make, fakes):
    session = make(at_frame=4, automatic=True, truth=(0.0, 0.0, 1.0))
    session.take(fakes.tracked(), 0.0)
    estimated(session, fakes, 0.0)
    session.handle(Request(Command.SCALE_MODEL, 2), 1.0)
    session.request_estimate(1.0)
    session.begin_anew(is_photo=True)
    session.watch._worker.answer = None
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
    assert session.watch._worker.requested[-1].frame.index == 9


def test_a_models_file_is_shown_by_its_name(make, tmp_path):
    session = make()
    session.table.shelf.add(str(tmp_path / "chair.obj"))
    assert session.table.model_name == "chair.obj"


def test_the_last_frame_of_a_short_clip_is_estimated(make, fakes):
    session = make(on_first_steady=True)
    session.take(fakes.tracked(0), 0.0)
    assert session.settle_for_last(0.0)
    assert not session.settle_for_last(0.0)
    assert [frozen.frame.index for frozen in session.watch._worker.requested] == [0]


@pytest.mark.parametrize("when", [{}, {"on_first_steady": True, "at_frame": 9}])
def test_the_last_frame_is_not_estimated_where_nobody_asked_for_it(make, fakes, when):
    session = make(**when)
    session.take(fakes.tracked(0), 0.0)
    assert not session.settle_for_last(0.0)
    unseen = make(on_first_steady=True)
    unseen.take(fakes.tracked(0, has_marker=False), 0.0)
    assert not unseen.settle_for_last(0.0)


def test_only_an_estimate_that_a_person_waits_for_is_urgent(make, fakes):
    session = make(automatic=True)
    urgent = []
    now_s = 0.0
    for index in range(12):
        now_s += CHECKED_EVERY_S
        session.take(fakes.tracked(index), now_s)
        if session.watch.is_estimating:
            urgent.append(session.watch._worker.is_awaited)
            session.watch._worker.answer = fakes.estimate(index)
            session.poll(now_s)
    assert urgent[0]  # there is no light yet
    assert len(urgent) > 2
    assert not any(urgent[1:])
    session.request_estimate(now_s)
    assert session.watch._worker.is_awaited


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
    assert session.handle(Request(Command.TURN_UP), 0.0)
    assert session.table.shelf.turned == 1
    assert session.notice.shown(0.0) == "cube: z is up"


def test_of_several_changes_the_one_to_another_side_is_undone_in_its_turn(make):
    session = make()
    for number, command in enumerate((Command.TURN_MODEL, Command.TURN_UP, Command.TURN_UP, Command.UNDO)):
        session.handle(Request(command, 1), 10.0 * number)
    assert session.notice.shown(30.0) == "undone: cube: z is up"
    assert session.hand.placement.turn_rad != 0
    for command, said in ((Command.UNDO, "undone: cube: y is up"), (Command.UNDO, "undone: model as before")):
        session.handle(Request(command), 40.0)
        assert session.notice.shown(40.0) == said
    assert session.hand.placement.turn_rad == 0


def test_another_model_is_not_stood_on_another_side_by_undoing(make):
    session = make()
    session.handle(Request(Command.TURN_UP), 0.0)
    session.handle(Request(Command.CHOOSE_MODEL, 1), 1.0)
    session.poll(1.0)
    session.handle(Request(Command.UNDO), 2.0)
    assert session.table.shelf.turned == 1
    assert "nothing was done" in session.notice.shown(2.0)


def test_what_was_done_to_the_light_is_undone_also_after_another_model_was_chosen(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.poll(0.0)
    by_hand(session, 0.0)
    first = session.hand.light
    session.handle(Request(Command.SCALE_MODEL, 3), 10.0)
    session.handle(Request(Command.MOVE_LIGHT, (0, 1)), 20.0)
    session.handle(Request(Command.NEXT_MODEL), 30.0)
    session.poll(30.0)
    session.handle(Request(Command.TURN_MODEL, 1), 40.0)
    for light, said in ((session.hand.light, "model"), (first, "light"), (None, "light")):
        session.handle(Request(Command.UNDO), 50.0)
        assert session.hand.light is light
        assert session.hand.placement == UNMOVED
        assert session.notice.shown(50.0) == f"undone: {said} as before"
    session.handle(Request(Command.UNDO), 60.0)
    assert "nothing was done" in session.notice.shown(60.0)


def test_a_moving_model_goes_on_until_it_is_stopped(make, fakes):
    session = make()
    session.handle(Request(Command.STOP_MOTION), 0.0)
    assert session.notice.shown(0.0) == "cube stands still: it has no animation that is played"
    session.table.shelf.moves = True
    session.take(fakes.tracked(0), 10.0)
    shown = []
    for now_s in (10.5, 11.0, 11.5, 12.0):
        session.poll(now_s)
        shown.append(bare_scene(session).time_s)
        session.handle(Request(Command.STOP_MOTION), now_s)
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
        session.handle(Request(command), 10.0)
        session.notice.withdraw(session.notice.text)  # a hint hides nothing that was said
        session.poll(10.1)
        assert session.notice.text == said
    # One that moves is left beside one that cannot.
    shelf.shown = placed_on_marker(Model("moving", (dataclasses.replace(still, motion=motion),)), 0.08)
    session.handle(Request(Command.ADD_MODEL), 40.0)
    shelf.moves, shelf.shown = False, fakes.Shelf.shown
    session.handle(Request(Command.STOP_MOTION), 50.0)
    assert session.notice.shown(50.0) == "another model moves: K stops it"


def test_before_and_after(make, fakes):
    session = make()
    session.take(fakes.tracked(0), 0.0)
    shown = []
    for _ in range(5):
        scene = bare_scene(session)
        shown.append((session.view.parts, scene.shows_model, scene.casts_shadow, scene.is_split))
        session.handle(Request(Command.BEFORE_AFTER), 0.0)
    assert [each[1] for each in shown] == [True, True, False, False, True]
    assert [each[2] for each in shown] == [True, False, True, False, True]
    assert [each[3] for each in shown] == [False, False, False, False, True]
    assert session.view.parts == shown[0][0]
    session.handle(Request(Command.BEFORE_AFTER), 0.0)
    session.handle(Request(Command.RESET), 0.0)
    assert bare_scene(session).casts_shadow


def test_what_is_left_out_is_said_for_as_long_as_it_is_so(make, fakes):
    """Not only for the few seconds of a notice: snapshots and recordings are made so too."""
    session = make()
    session.take(fakes.tracked(0), 0.0)
    for is_whole in (False, False, False, False, True, False):
        session.handle(Request(Command.BEFORE_AFTER), 1.0)
        soon, late = (source_lines(session, None, now_s) for now_s in (1.0, 100.0))
        assert soon == [f"{session.view.parts.value}: B goes on"]
        assert late == ([] if is_whole else soon)
    session.handle(Request(Command.RESET), 100.0)
    assert session.view.parts.value not in " ".join(source_lines(session, None, 100.0))


def test_each_model_stays_where_it_was_put(make, fakes):
    session = make()
    session.take(fakes.tracked(0), 0.0)
    session.poll(0.0)
    session.handle(Request(Command.SCALE_MODEL, 3), 0.0)
    large = session.hand.placement
    session.handle(Request(Command.NEXT_MODEL), 0.0)
    session.poll(0.0)
    assert session.hand.placement == UNMOVED
    session.handle(Request(Command.TURN_MODEL, 2), 0.0)
    session.handle(Request(Command.PREVIOUS_MODEL), 0.0)
    session.poll(0.0)
    assert session.hand.placement == large


def test_a_model_that_was_moved_out_of_the_picture_is_reported(make, fakes):
    session = make()
    model = placed_on_marker(Model("box", (box((1, 1, 1)),)), 0.08)
    session.table.shelf.shown = model
    session.take(fakes.tracked(), 0.0)
    for shift_m, said in (((0.0, 0.0), ()), ((0.01, 0.0), ()), ((90.0, 0.0), (OUT_OF_PICTURE,))):
        session.hand.placement = Placement(shift_m=shift_m)
        assert guidance(session) == said
    session.handle(Request(Command.RESET), 0.0)
    assert guidance(session) == ()


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ((0.0, 0.0, 0.02), LAMP_INSIDE),
        ((0.3, 0.0, -0.2), LAMP_BELOW),
        ((0.3, 0.2, 0.4), None),
        ((0.1, 0.0, 0.05), None),
    ],
)
def test_a_lamp_where_no_light_can_come_from_is_reported(make, fakes, place, said):
    session = make()
    model = placed_on_marker(Model("box", (box((1, 1, 1)),)), 0.08)
    session.table.shelf.shown = model
    session.take(fakes.tracked(), 0.0)
    lamp = Light(place, inverse_distance=1 / np.linalg.norm(place))
    session.hand.light = Illumination((lamp,))
    assert guidance(session) == (() if said is None else (said,))
    assert f"lamp, {100 * np.linalg.norm(place):.0f} cm, azimuth" in light_line(session)


def test_a_lamp_among_models_casts_their_shadows_and_is_not_reported(make, fakes):
    session = make()
    session.table.shelf.shown = placed_on_marker(Model("box", (box((0.25, 0.25, 1)),)), 0.08)
    session.take(fakes.tracked(), 0.0)
    session.handle(Request(Command.ADD_MODEL), 0.0)
    session.poll(0.0)
    (_, _, here), (_, _, there) = session.arrangement.models(session.tracked)
    between = (np.array(here.shift_m) + there.shift_m) / 2
    for place, said in (((*between, 0.04), ()), ((*between, 0.6), ()), ((*there.shift_m, 0.02), (LAMP_INSIDE,))):
        session.hand.light = Illumination((Light(place, inverse_distance=1 / np.linalg.norm(place)),))
        assert guidance(session) == said


def test_models_around_a_lamp_that_no_views_of_it_show_are_reported(make, fakes, monkeypatch):
    """Nine, for which depth maps do not suffice beside four lights and a real object; without that they do."""
    session = make()
    model = placed_on_marker(Model("box", (box((0.3, 0.3, 1)),)), 0.06)
    ring = 0.08 * np.array([(np.cos(turn), np.sin(turn)) for turn in 0.7 * np.arange(9)])
    session.table.shelf.shown = model
    session.take(fakes.tracked(), 0.0)
    around = tuple((None, model, Placement(shift_m=tuple(place))) for place in ring)
    monkeypatch.setattr(type(session.arrangement), "models", lambda *_: around)
    lamp, cup = Light((0.0, 0.0, 1.0), inverse_distance=1 / 0.03), Proxy("cup", np.array([(0.3, 0.3, 0.05, 0.02, 0)]))
    suns = tuple(Light((0.1 * number, 0.0, 1.0)) for number in range(3))
    for lit, said in (
        (Illumination((lamp,), real_object=cup), ()),
        (Illumination((lamp, *suns)), ()),
        (Illumination((lamp, *suns), real_object=cup), (LAMP_AMONG_MANY,)),
    ):
        session.hand.light = lit
        assert guidance(session) == said


def lying(turn_deg: float) -> np.ndarray:
    """T_room_marker of a sheet that is turned on its table."""
    cosine, sine = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    return rigid([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]], (0, 0, 0))


def test_the_light_stays_in_the_room_while_the_marker_is_turned(make, fakes):
    session = make()
    session.take(dataclasses.replace(fakes.tracked(0), T_room_marker=lying(0)), 0.0)
    session.request_estimate(0.0)
    session.watch._worker.answer = fakes.estimate(0)
    session.poll(0.0)
    session.poll(10.0)
    room = session.shown.light.to_light_marker
    for index, turn_deg in enumerate((20, 200, 40), 1):
        place = lying(turn_deg)
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
    session.request_estimate(20.0)
    session.watch._worker.answer = fakes.estimate(13)
    session.poll(20.0)
    assert place[:3, :3] @ session.shown.light.to_light_marker == pytest.approx(room)
    session.poll(30.0)
    assert session.shown.light.to_light_marker == pytest.approx(room)


def test_a_light_on_its_way_stays_in_the_room_where_the_marker_is_lost(make, fakes):
    session = make()
    session.take(dataclasses.replace(fakes.tracked(0), T_room_marker=lying(0)), 0.0)
    for now_s, towards in ((0.0, (1.0, 0.0, 1.0)), (10.0, (1.0, 0.2, 1.0))):
        session.request_estimate(now_s)
        session.watch._worker.answer = fakes.estimate(towards=towards)
        session.poll(now_s)
    turned = dataclasses.replace(fakes.tracked(1), T_room_marker=lying(90))
    session.take(turned, 10.1)
    session.take(dataclasses.replace(turned, marker=None), 10.2)
    session.poll(10.2)
    x, y, _ = turned.T_room_marker[:3, :3] @ session.shown.light.to_light_marker
    assert 0 < y / x < 0.2


def test_a_light_by_hand_stays_in_the_room_while_the_marker_is_turned(make, fakes):
    session = make()
    session.take(dataclasses.replace(fakes.tracked(0), T_room_marker=lying(30)), 0.0)
    session.handle(Request(Command.MOVE_LIGHT, (3, 2)), 0.0)
    room = lying(30)[:3, :3] @ session.hand.light.light.to_light_marker
    for index, turn_deg in enumerate((50, 130), 1):
        place = lying(turn_deg)
        session.take(dataclasses.replace(fakes.tracked(index), T_room_marker=place), float(index))
        assert session.shown is session.lit_by is session.hand.light
        assert place[:3, :3] @ session.shown.light.to_light_marker == pytest.approx(room)
    # A key press goes on from there, and undoing it gives the light back to where it was in the room.
    session.handle(Request(Command.MOVE_LIGHT, (0, -5)), 10.0)
    assert place[2, :3] @ session.lit_by.light.to_light_marker < room[2] - 0.05
    place = lying(200)
    session.take(dataclasses.replace(fakes.tracked(3), T_room_marker=place), 11.0)
    session.handle(Request(Command.UNDO), 12.0)
    session.poll(12.0)
    assert place[:3, :3] @ session.shown.light.to_light_marker == pytest.approx(room)


def test_nobody_asks_about_a_sheet_that_is_held_still_above_the_table_where_its_light_was_found(make, fakes):
    session = make(automatic=True, steady_frames=1)
    on_table = dataclasses.replace(fakes.tracked(0), T_room_marker=lying(0))
    lifted = dataclasses.replace(on_table, T_room_marker=rigid(np.eye(3), (0.0, 0.0, 0.2)))

    def requests_made(first: int, place) -> int:
        before = len(session.watch._worker.requested)
        for index in range(first, first + 5):
            session.take(dataclasses.replace(place, frame=fakes.tracked(index).frame), float(index))
            session.watch._worker.answer = fakes.estimate(index)
            session.poll(float(index))
        return len(session.watch._worker.requested) - before

    assert requests_made(0, on_table) > 1
    assert requests_made(5, lifted) == 0
    assert requests_made(10, on_table) > 1


def test_the_estimated_light_is_eased_to_from_where_a_light_by_hand_was_in_the_room(make, fakes):
    session = make()
    session.take(dataclasses.replace(fakes.tracked(0), T_room_marker=lying(0)), 0.0)
    estimated(session, fakes, 0.0)
    turned = dataclasses.replace(fakes.tracked(1), T_room_marker=lying(50))
    session.take(turned, 10.0)
    by_hand(session, 10.0)
    by_hand_there = session.shown.light.to_light_marker
    session.take(dataclasses.replace(turned, frame=fakes.tracked(2).frame), 11.0)
    session.request_estimate(11.0)
    session.watch._worker.answer = fakes.estimate(2, towards=by_hand_there + np.array([0.0, 0.02, 0.0]))
    session.poll(11.0)
    for now_s in (11.0, 11.1, 11.2, 12.0):
        session.poll(now_s)
        assert angle_between(session.shown.light.to_light_marker, by_hand_there) < 0.03


def test_nobody_asks_about_a_picture_in_which_the_marker_is_being_moved(make, fakes):
    session = make(automatic=True, steady_frames=1)
    session.take(dataclasses.replace(fakes.tracked(0), T_room_marker=lying(0)), 0.0)
    assert len(session.watch._worker.requested) == 1
    session.watch._worker.answer = fakes.estimate(0)
    session.poll(0.0)
    for index in range(1, 60):
        session.take(dataclasses.replace(fakes.tracked(index), T_room_marker=lying(index)), float(index))
    assert len(session.watch._worker.requested) == 1
    session.take(dataclasses.replace(fakes.tracked(60), T_room_marker=session.tracked.T_room_marker), 60.0)
    assert len(session.watch._worker.requested) == 2


@pytest.mark.parametrize("other", ["none", "place", "camera"])
def test_a_frame_in_doubt_is_compared_with_those_of_its_place_and_camera_alone(make, fakes, other):
    """Beside a frame by another focal length, or from where the marker lay, poses do not fit each other."""
    session = make()
    watch, worker = session.watch, session.watch._worker
    session.take(dataclasses.replace(fakes.tracked(0), T_room_marker=lying(0)), 0.0)
    estimated(session, fakes, 0.0)
    watch.key_views = fakes.KeyViews(dataclasses.replace(fakes.tracked(1), T_room_marker=lying(0)))
    doubted = dataclasses.replace(fakes.tracked(2), T_room_marker=lying(0))
    assert watch.ask_in_background(doubted, 1.0)
    worker.answer, worker.outdated = fakes.estimate(2), (0,)
    watch.wait(0.0)
    seen = dataclasses.replace(fakes.tracked(3), T_room_marker=lying(40 if other == "place" else 0))
    if other == "camera":
        seen = dataclasses.replace(seen, camera=Camera.from_hfov(seen.camera.size, 70.0))
    assert watch.ask_in_background(seen, 2.0)
    assert (worker.doubted is doubted) is (other == "none")


def seen_at(fakes, time_s: float, index: int = 0):
    tracked = fakes.tracked(index)
    return dataclasses.replace(tracked, frame=Frame(tracked.frame.image_bgr, index, time_s))


def test_the_empty_table_goes_with_requests_until_it_is_old(make, fakes):
    session = make()
    worker = session.watch._worker
    session.handle(Request(Command.EMPTY_TABLE), 0.0)
    assert session.notice.text == "no marker in view"
    empty = seen_at(fakes, 0.0)
    session.take(empty, 0.0)
    session.handle(Request(Command.EMPTY_TABLE), 0.0)
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
        session.take(dataclasses.replace(seen_at(fakes, 0.0), T_room_marker=lying(0)), 0.0)
        if is_shown:
            session.handle(Request(Command.EMPTY_TABLE), 0.0)
        else:  # found by an estimate, of which the user knows nothing
            session.watch.empty_table.found(session.tracked)
        session.take(dataclasses.replace(seen_at(fakes, now_s, 1), T_room_marker=lying(turned_deg)), now_s)
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
    session.watch._worker.answer, session.watch._worker.shows_empty_table = fakes.estimate(with_light=False), True
    session.poll(0.0)
    assert session.watch.empty_table.frame is frozen
    assert WITHOUT_IT not in guidance(session)  # it has been said what is missing
    session.watch.empty_table.frame = None
    assert WITHOUT_IT in guidance(session)


def test_an_answer_over_the_empty_table_says_so(make, fakes):
    session = make()
    session.take(fakes.tracked(), 0.0)
    session.request_estimate(0.0)
    session.watch._worker.answer, session.watch._worker.is_over_empty_table = fakes.estimate(), True
    session.poll(0.0)
    assert "over the empty table" in light_line(session)


def test_a_light_that_is_followed_is_still_over_the_empty_table(make, fakes):
    session = make(automatic=True)
    worker = session.watch._worker
    session.take(fakes.tracked(), 0.0)
    session.request_estimate(0.0)
    worker.answer, worker.is_over_empty_table = fakes.estimate(), True
    session.poll(0.0)
    session.watch._is_awaited, worker.known, worker.follows = False, [session.estimate], True
    worker.busy, worker.others, worker.answer = True, (fakes.tracked(),), fakes.estimate(towards=(1.0, 0.2, 1.0))
    session.poll(1.0)
    assert session.estimate.light.to_light_marker[1] > 0
    assert "over the empty table" in light_line(session)


def test_a_paper_cube_needs_no_empty_table(make, fakes):
    session = make()
    tracked = fakes.tracked()
    cube = Proxy("box", [(0.0, 0.0, 0.03, 0.03, 0.03)])
    session.take(dataclasses.replace(tracked, marker=dataclasses.replace(tracked.marker, body=cube)), 0.0)
    session.handle(Request(Command.EMPTY_TABLE), 0.0)
    assert session.watch.empty_table.frame is None
    assert "cube" in session.notice.text


def test_an_estimator_of_one_frame_makes_no_use_of_the_empty_table(make, fakes):
    session = make()
    session.watch._worker.takes_one_frame = True
    session.take(fakes.tracked(), 0.0)
    session.handle(Request(Command.EMPTY_TABLE), 0.0)
    assert session.watch.empty_table.frame is None
    assert "no use" in session.notice.text
    session.watch.camera_may_move = True
    session.request_estimate(0.0)
    session.watch._worker.answer = fakes.estimate(with_light=False)
    session.poll(0.0)
    assert WITHOUT_IT not in guidance(session)
