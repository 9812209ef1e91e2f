"""When the frames of a clip are due, by a clock of the test's own."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from ashe_live.viewer.sources.pace import FALLEN_BEHIND_S, FAST_HZ, LONGEST_GAP_S, Pace

FPS = 32.0  # binary fractions throughout, so that moments are compared exactly
PERIOD_S = 1 / FPS


class Player:
    """Waits as it is told, and writes down the moments at which frames are shown. A frame takes `work_s`."""

    def __init__(self, speed: float = 1.0, now_s: float = 100.0, work_s: float = 0.0) -> None:
        self.pace, self.now_s, self.work_s = Pace(), now_s, work_s
        self.pace.speed = speed
        self.shown_s: list[float] = []
        self.lags_s: list[float] = []

    def play(self, times_s: Sequence[float]) -> None:
        for time_s in times_s:
            due = self.pace.next(time_s, PERIOD_S, self.now_s)
            self.now_s += max(0.0, due.wait_s)
            if due.is_shown:
                self.shown_s.append(self.now_s)
                self.lags_s.append(max(0.0, -due.wait_s))
                self.now_s += self.work_s


def frames(count: int) -> list[float]:
    return [number * PERIOD_S for number in range(count)]


@pytest.mark.parametrize("speed", [0.25, 1.0, 2.0])
def test_a_frame_is_shown_when_its_time_has_come_also_round_after_round(speed: float) -> None:
    """The first frame of a round comes a period after the last of the round before."""
    player = Player(speed)
    for _ in range(3):
        player.play(frames(5))
        player.pace.go_round(PERIOD_S)
    assert player.shown_s == [100 + number * PERIOD_S / speed for number in range(15)]


def test_from_anew_the_next_frame_is_shown_at_once_wherever_it_is() -> None:
    for speed in (1.0, 8.0):
        player = Player(speed)
        player.play([0.0])
        player.pace.begin_anew()
        player.pace.go_round(PERIOD_S)  # as where a clip is sent to its end
        player.play([50.0])
        assert player.shown_s == [100.0, 100.0]


@pytest.mark.parametrize("speed", [0.5, 1.0])
def test_in_a_pause_of_the_clip_only_what_is_left_of_it_is_waited_for(speed: float) -> None:
    player = Player(speed)
    player.pace.begin_anew(from_s=48.0)
    player.play([2.0, 50.0, 51.0])
    assert player.shown_s == [100.0, 100 + 2 / speed, 100 + 3 / speed]
    player.pace.begin_anew()
    player.play([2.0, 3.0])
    assert np.diff(player.shown_s[-2:]) == [1 / speed]


def test_a_machine_that_is_a_little_late_leaves_frames_out_and_keeps_up() -> None:
    player = Player(work_s=1.25 * PERIOD_S)
    player.play(frames(320))
    # Of five periods four frames are shown, none later than by the frame that it keeps from being shown.
    assert len(player.shown_s) == pytest.approx(0.8 * 320, abs=1)
    assert max(player.lags_s) <= PERIOD_S


def test_a_machine_that_hardly_decodes_in_time_still_shows_some_frames() -> None:
    """Of each frame decoding takes nearly a period, and of one that is shown the rest two: half a second to make up."""
    pace, now_s, shown_s = Pace(), 0.0, []
    for time_s in frames(640):
        now_s += 0.95 * PERIOD_S
        due = pace.next(time_s, PERIOD_S, now_s)
        now_s += max(0.0, due.wait_s)
        if due.is_shown:
            shown_s.append(now_s)
            now_s += 2 * PERIOD_S
    assert max(np.diff(shown_s)) <= LONGEST_GAP_S + PERIOD_S


def test_what_would_be_shown_is_told_beforehand_and_schedules_nothing() -> None:
    """Whether late, fallen behind, too soon at a high speed or on time."""
    for speed in (1.0, 4.0):
        pace, now_s, shown = Pace(), 0.0, set()
        pace.speed = speed
        for number in range(200):
            time_s = number * PERIOD_S
            told = [pace.shows(time_s, PERIOD_S, now_s) for _ in range(2)]
            due = pace.next(time_s, PERIOD_S, now_s)
            assert told == 2 * [due.is_shown]
            shown.add(due.is_shown)
            now_s += max(0.0, due.wait_s) + (number % 17 == 0) * 0.1 + (number % 50 == 0) * 0.4
        assert shown == {True, False}


def test_what_has_fallen_far_behind_goes_on_from_there_and_does_not_hurry() -> None:
    player = Player()
    player.play(frames(2))
    player.now_s += 2 * FALLEN_BEHIND_S
    held_s = player.now_s
    player.play(frames(5)[2:])
    assert player.shown_s[2:] == [held_s, held_s + PERIOD_S, held_s + 2 * PERIOD_S]


def test_at_its_own_pace_every_frame_is_shown_however_many_a_second() -> None:
    """Displays of 120 and 240 Hz show a clip of as many."""
    pace, now_s, period_s = Pace(), 0.0, 1 / 256
    for number in range(64):
        due = pace.next(number * period_s, period_s, now_s)
        assert due == (period_s if number else 0.0, True)
        now_s += due.wait_s


@pytest.mark.parametrize("speed", [2.0, 3.0, 4.0, 7.0, 8.0])
def test_no_more_frames_are_shown_than_a_display_has_and_they_come_evenly(speed: float) -> None:
    player = Player(speed)
    player.play(frames(160))
    apart = np.diff(player.shown_s)
    step = math.ceil(FPS * speed / FAST_HZ - 0.5)  # by half a frame it may come too soon
    np.testing.assert_allclose(apart, step * PERIOD_S / speed)
    assert player.shown_s[0] == 100
    assert player.now_s == pytest.approx(100 + 159 * PERIOD_S / speed), "those that are left out are waited for too"
