"""Playback without a window: which frames, which estimates, who gets the pictures."""

import math
from itertools import pairwise

import pytest

from ashe_live.errors import UserError
from ashe_live.light.live.worker_messages import WorkerFailure
from ashe_live.tracking.poses.steadiness import Steadiness
from ashe_live.viewer.display import bare_scene
from ashe_live.viewer.estimates.first_estimate import FirstEstimate
from ashe_live.viewer.headless import HeadlessRun, play_headless
from ashe_live.viewer.output.report import Report
from ashe_live.viewer.session import Session


class Play:
    """One playback with fakes behind it."""

    def __init__(self, fakes, source, answer=None, renderer=None, before_frame=None, **playback) -> None:
        self.source, self.tracker, self.worker = source, fakes.Tracker(), fakes.Worker()
        if before_frame is not None:
            source.hook = lambda index: before_frame(self, index)
        self.renderer = renderer or fakes.Renderer()
        self.worker.answer = answer
        self.session = Session(fakes.Shelf(), self.worker, FirstEstimate(Steadiness(3), on_first_steady=True))
        self.report = Report("fake", "3.3", "fast")
        self.taken = []
        takers = (lambda picture, time_s: self.taken.append((picture, time_s)),)
        play_headless(
            self.source,
            self.tracker,
            self.session,
            self.renderer,
            HeadlessRun(bare_scene, takers=takers, **playback),
            self.report,
        )

    @property
    def indices(self) -> list[int]:
        return [frame["index"] for frame in self.report.frames]


def test_every_frame_is_shown_once(fakes):
    play = Play(fakes, fakes.Source(7), fakes.estimate(2))
    assert play.indices == list(range(7))
    assert [scene.tracked.frame.index for scene in play.renderer.scenes] == list(range(7))


def test_a_clip_is_lit_from_its_first_frame_on(fakes):
    play = Play(fakes, fakes.Source(6), fakes.estimate(2))
    assert all(scene.illumination.lights for scene in play.renderer.scenes)
    assert [estimate["frame"] for estimate in play.report.estimates] == [2]


def test_a_light_that_is_found_anew_is_reached_without_a_jump(fakes):
    """At 20 frames a second, so that it eases over six of them."""

    def asks_again(play: Play, index: int) -> None:
        if index == 8:
            play.worker.answer = fakes.estimate(7, towards=(0.0, 1.0, 1.0))
            assert play.session.request_estimate(7 / 20)

    play = Play(fakes, fakes.Source(20, fps=20.0), fakes.estimate(2), before_frame=asks_again)
    lights = [scene.illumination.lights[0].to_light_marker for scene in play.renderer.scenes]
    turns = [math.degrees(math.acos(min(1.0, float(a @ b)))) for a, b in pairwise(lights)]
    assert math.degrees(math.acos(float(lights[0] @ lights[-1]))) == pytest.approx(60.0, abs=1e-3)
    assert max(turns) < 20.0
    assert turns[:7] + turns[-5:] == [0.0] * 12
    assert lights[-1] is play.session.estimate.lights[0].to_light_marker
    assert [estimate["frame"] for estimate in play.report.estimates] == [2, 7]


def test_no_frame_beyond_the_limit_is_estimated(fakes):
    play = Play(fakes, fakes.Source(6), fakes.estimate(1), frame_limit=2)
    assert [estimate["frame"] for estimate in play.report.estimates] == [1]
    assert play.indices == [0, 1]


@pytest.mark.parametrize("frames", [2, 6])  # the last frame is estimated where none was steady
def test_an_estimate_that_fails_is_said_and_the_clip_is_played_on(fakes, frames):
    play = Play(fakes, fakes.Source(frames), WorkerFailure(0, "no answer in 120 s"))
    assert play.indices == list(range(frames))
    assert play.report.estimates == []
    assert play.session.notice.text == "the estimate failed: no answer in 120 s"


def test_a_clip_in_which_no_frame_was_steady_is_lit_by_its_last(fakes):
    play = Play(fakes, fakes.Source(2), fakes.estimate(1))
    assert [estimate["frame"] for estimate in play.report.estimates] == [1]
    assert all(scene.illumination.lights for scene in play.renderer.scenes)


def test_the_limit_counts_frames(fakes):
    assert Play(fakes, fakes.Source(7), fakes.estimate(2), frame_limit=4).indices == [0, 1, 2, 3]
    assert Play(fakes, fakes.Source(3), fakes.estimate(2), frame_limit=9).indices == [0, 1, 2]


def test_a_loop_goes_on_to_the_limit_in_even_time(fakes):
    source = fakes.Source(4, fps=25.0)
    play = Play(fakes, source, fakes.estimate(2), frame_limit=10, loop=True)
    assert play.indices == [0, 1, 2, 3, 0, 1, 2, 3, 0, 1]
    assert play.tracker.resets == source.rewinds == 3  # the first time after the estimate
    assert [time_s for _, time_s in play.taken] == pytest.approx([frame / 25 for frame in range(10)])


def test_takers_get_each_picture_as_drawn(fakes):
    play = Play(fakes, fakes.Source(5), fakes.estimate(2))
    assert [int(picture[0, 0, 0]) for picture, _ in play.taken] == [1, 2, 3, 4, 5]


@pytest.mark.parametrize("damaged", [1, 3])  # before and after the frame that is estimated
def test_a_source_that_fails_in_the_middle_raises_once_the_frames_before_are_shown(fakes, damaged):
    source, shown = fakes.Source(5), fakes.Renderer()

    def fail(index: int) -> None:
        if index == damaged:
            raise UserError("gone", "look for it")

    source.hook = fail
    with pytest.raises(UserError, match="gone"):
        Play(fakes, source, fakes.estimate(2), shown)
    assert [scene.tracked.frame.index for scene in shown.scenes] == list(range(damaged))
