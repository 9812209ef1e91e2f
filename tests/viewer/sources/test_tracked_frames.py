"""Frames of a marker that is no longer asked for do not come out, whichever thread was quicker."""

import pytest

from ashe_live.process.mailbox import Closed
from ashe_live.viewer.sources.tracked_frames import AS_AT_FIRST, Following, TrackedFrames

OTHER = Following(marker="aruco:4x4_50:7")


def test_a_frame_that_waits_is_dropped_when_another_marker_is_asked_for(fakes) -> None:
    frames = TrackedFrames()
    frames.put(fakes.tracked(0), AS_AT_FIRST)
    frames.ask_for(OTHER)
    assert frames.take(0) is None


def test_a_frame_that_was_in_progress_then_is_not_taken_in(fakes) -> None:
    frames = TrackedFrames()
    frames.ask_for(OTHER)
    frames.put(fakes.tracked(0), AS_AT_FIRST)
    assert frames.take(0) is None
    frames.put(fakes.tracked(1), OTHER)
    assert frames.take(0).frame.index == 1


def test_no_frame_slips_in_between_the_question_and_the_answer(fakes, monkeypatch) -> None:
    """Whether it is still wanted, and what is done with it then, is one step for the other thread."""
    frames, done = TrackedFrames(), []
    for name in ("put", "drop"):
        monkeypatch.setattr(frames._latest, name, lambda *_, name=name: done.append((name, frames._asking.locked())))
    frames.put(fakes.tracked(0), AS_AT_FIRST)
    frames.ask_for(OTHER)
    assert done == [("put", True), ("drop", True)]


def test_to_ask_for_the_same_again_drops_nothing(fakes) -> None:
    frames = TrackedFrames()
    frames.put(fakes.tracked(0), AS_AT_FIRST)
    frames.ask_for(AS_AT_FIRST)
    assert frames.take(0).frame.index == 0


def test_the_last_frame_comes_before_the_end(fakes) -> None:
    frames = TrackedFrames()
    frames.put(fakes.tracked(0), AS_AT_FIRST)
    frames.close()
    assert frames.take(0).frame.index == 0
    with pytest.raises(Closed):
        frames.take(0)
