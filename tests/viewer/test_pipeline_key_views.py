"""The capture thread offers every frame as a key view, and drops those from before a cut."""

import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from ashe_live.core.types import TrackedFrame
from ashe_live.viewer.sources import capture_loop
from ashe_live.viewer.sources import pipeline as pipeline_module
from ashe_live.viewer.sources.pipeline import Pipeline
from tests.patience import PATIENCE_S


class NotedKeyViews:
    """Notes the indices of the frames that it is offered, and -1 where all are dropped."""

    def __init__(self) -> None:
        self.events: list[int] = []
        self._news = threading.Condition()

    def add(self, tracked: TrackedFrame) -> None:
        self._note(tracked.frame.index)

    def drop(self) -> None:
        self._note(-1)

    def _note(self, event: int) -> None:
        with self._news:
            self.events.append(event)
            self._news.notify_all()

    def await_that(self, condition: Callable[[list[int]], bool]) -> list[int]:
        with self._news:
            assert self._news.wait_for(lambda: condition(self.events), PATIENCE_S)
            return list(self.events)


@pytest.fixture
def run(fakes, monkeypatch) -> Iterator[Callable[..., Pipeline]]:
    """Starts a pipeline whose key views are noted, and closes it in the end."""
    monkeypatch.setattr(pipeline_module, "KeyViews", NotedKeyViews)
    with ExitStack() as stack:

        def run(source, loop: bool = False) -> Pipeline:
            pipeline = Pipeline(source, fakes.Tracker(), loop, lambda _spec, _hfov_deg: fakes.Tracker())
            stack.callback(pipeline.close)
            pipeline.start()
            return pipeline

        yield run


def test_every_tracked_frame_is_offered_once_and_in_order(run, fakes):
    events = run(fakes.Source(8, is_live=True)).key_views.await_that(lambda events: 7 in events)
    assert events == list(range(8))


def test_a_loop_drops_them_each_time_round(run, fakes):
    """A busy machine may skip frames of a round, but never mixes two."""
    events = run(fakes.Source(3), loop=True).key_views.await_that(lambda events: events.count(-1) >= 2)
    first = events.index(-1)
    second = first + 1 + events[first + 1 :].index(-1)
    for of_round in (events[:first], events[first + 1 : second]):
        assert of_round == sorted(set(of_round))
    assert events[:first]


def test_a_seek_and_a_restart_drop_them_and_the_next_frame_in_a_row_does_not(run, fakes):
    pipeline = run(fakes.Clip(1000))
    pipeline.pause(True)
    pipeline.seek(4.0)
    before = pipeline.key_views.await_that(lambda events: events[-1:] == [800])
    assert before[-2] == -1
    for index in (801, 802, 803):
        pipeline.step(1)
        events = pipeline.key_views.await_that(lambda events, index=index: events[-1] == index)
    assert events[len(before) :] == [801, 802, 803]
    pipeline.restart()
    events = pipeline.key_views.await_that(lambda events: events[-1] == 0)
    assert events[-2] == -1


def test_a_camera_that_was_lost_drops_them(run, fakes, monkeypatch):
    monkeypatch.setattr(capture_loop, "RECONNECT_EVERY_S", 0.01)
    source = fakes.Source(10_000, is_live=True)
    source.hook = fakes.lost_once(at=3)
    source.returns = [True]
    events = run(source).key_views.await_that(lambda events: len(events) > 6)
    assert events[2:5] == [2, -1, 3]


def test_another_marker_drops_them(run, fakes):
    source = fakes.Source(100_000, is_live=True)
    pipeline = run(source)
    pipeline.key_views.await_that(lambda events: len(events) > 3)
    pipeline.follow("aruco:4x4_50:7")
    events = pipeline.key_views.await_that(lambda events: -1 in events)
    assert events.count(-1) == 1
